"""Taking the known mass of an accelerometer out of FRFs, exactly."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.dof import Dof
from acquisition.errors import EstimationError, InputError
from acquisition.form import FORMS
from acquisition.frfs.frf import FrfSet
from acquisition.frfs.scatter import HitGroup, HitScatter


def remove_sensor_mass(frfs: FrfSet, *, mass: float | Mapping[Dof, float], roving: bool = False) -> FrfSet:
    """Return the FRFs the structure would have without the mass of its accelerometers.

    Parameters
    ----------
    frfs : FrfSet
        FRFs whose responses were measured by these accelerometers. The FRF of each sensor at its own point,
        hit there in the direction it measures, has to be among them; and, for sensors mounted together, the
        FRFs between them. What weighs nothing (a laser) is a response like others, of mass 0.
    mass : float or mapping of Dof to float
        Mass of each accelerometer, or one for all [kg]. The sign of a direction does not matter. A triaxial
        sensor is three entries of the same mass.
    roving : bool
        False if all sensors stayed in place for the whole test (a roving hammer), True if each response was
        measured with no other sensor mounted (a roving accelerometer).

    Returns
    -------
    FrfSet
        In the form given. The covariance from the hits is carried through to first order, that of the
        FRF at the sensor's own point included; a variance without hits is carried as if FRFs erred
        independently.

    Raises
    ------
    EstimationError
        If an FRF that is needed was not measured; the message names it.
    InputError
        If a mass is negative, not finite, or not given for a response.

    Notes
    -----
    A mass m at j adds m s^2 e_j e_j^T to the dynamic stiffness; taking it out by the Sherman-Morrison
    formula gives, with accelerances A of the loaded structure, A_true,jk = A_jk / (1 - m A_jj), and for
    several sensors J at once A_true,Jk = (I - A_JJ M)^-1 A_Jk (Cakar and Sanliturk, Mechanical Systems and
    Signal Processing 19, 2005; Ashory, IMAC 16, 1998). It holds anywhere in the Laplace
    plane, so a decay that is still in the FRFs does no harm. Masses act in the measured directions only: a
    one-axis sensor's mass across its axis, and its rotary inertia, cannot be removed by what it measures.
    """
    signs = np.array([float(a.sign * b.sign) for a, b in zip(frfs.responses, frfs.references, strict=True)])
    sensors = tuple(dict.fromkeys(_plain(dof) for dof in frfs.responses))
    masses = _masses(mass, sensors)
    loaded = [[sensor] for sensor in sensors if masses[sensor] > 0]
    if not loaded:
        return frfs
    sets = loaded if roving else [list(sensors)]
    result = frfs.double().scaled(signs)
    for together in sets:
        result = _removed(result, _Mounted.of(result, together, masses))
    return result.scaled(signs)


@dataclass(frozen=True, eq=False)
class _Mounted:
    """Which FRFs the sensors have that were mounted together.

    masses (n,): of the sensors; between (n, n): row numbers of the FRFs between sensors, any where the column's
    sensor has no mass; rows (n, n_points): row numbers of the FRFs of each sensor to each point that was hit.
    """

    masses: FloatArray
    between: IntArray
    rows: IntArray

    @classmethod
    def of(cls, frfs: FrfSet, sensors: Sequence[Dof], masses: Mapping[Dof, float]) -> _Mounted:
        found: dict[tuple[Dof, Dof], list[int]] = {}
        for row, (a, b) in enumerate(zip(frfs.responses, frfs.references, strict=True)):
            found.setdefault((_plain(a), _plain(b)), []).append(row)
        weights = np.array([masses[s] for s in sensors])
        return cls(weights, _between(frfs, found, sensors, weights), _rows(frfs, found, sensors))


def _between(
    frfs: FrfSet, found: Mapping[tuple[Dof, Dof], list[int]], sensors: Sequence[Dof], masses: FloatArray
) -> IntArray:
    rows = np.zeros((len(sensors), len(sensors)), dtype=np.int64)
    missing = []
    for (i, a), (j, b) in itertools.product(enumerate(sensors), enumerate(sensors)):
        if (a, b) in found:
            rows[i, j] = found[a, b][0]
        elif masses[j] > 0:
            missing.append(f"{a}/{b}")
    if missing:
        raise EstimationError(
            f"{frfs.source}: the mass of the sensors cannot be removed: no FRF {_listed(missing)} "
            "(response/reference); hit there in the direction of the sensor and add it"
        )
    return rows


def _rows(frfs: FrfSet, found: Mapping[tuple[Dof, Dof], list[int]], sensors: Sequence[Dof]) -> IntArray:
    """Return the FRFs of the sensors by point; a point that was hit in several runs has several columns."""
    columns, gaps = [], []
    for point in dict.fromkeys(reference for response, reference in found if response in sensors):
        runs = [found.get((sensor, point), []) for sensor in sensors]
        if len({len(run) for run in runs}) > 1:
            gaps.append(str(point))
        columns += list(zip(*runs, strict=False))
    if gaps:
        raise EstimationError(
            f"{frfs.source}: not every sensor has an FRF for the hits at {_listed(gaps)}; with several sensors "
            "mounted all of them are needed there (roving=True if they were mounted one at a time)"
        )
    return np.array(columns, dtype=np.int64).T


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")


def _removed(frfs: FrfSet, mounted: _Mounted) -> FrfSet:
    power = FORMS.index("accelerance") - FORMS.index(frfs.form)
    dynamic = frfs.laplace**power * mounted.masses[:, None]
    matrix = np.moveaxis(frfs.values[mounted.between] * dynamic, -1, 0)
    inverse = np.asarray(np.linalg.inv(np.eye(len(mounted.masses)) - matrix), dtype=np.complex128)
    inverse = np.moveaxis(inverse, 0, -1)
    values = np.array(frfs.values)
    values[mounted.rows] = np.einsum("ijl,jkl->ikl", inverse, frfs.values[mounted.rows])
    pushed = dynamic[:, None] * values[mounted.rows]
    variance, scatter = frfs.variance, None
    if frfs.scatter is not None:
        scatter = _scatter(frfs.scatter, mounted, inverse, pushed)
        variance = scatter.variance(len(values))
    elif variance is not None:
        variance = _variance(variance, mounted, inverse, pushed)
    return replace(frfs, values=values, variance=variance, scatter=scatter)


def _scatter(
    scatter: HitScatter, mounted: _Mounted, inverse: ComplexArray, pushed: ComplexArray
) -> HitScatter:
    """Carry deviations through: d true_k = B (d A_k + sum_j d A_.j m_j s^2 true_jk), with B the inverse."""
    groups = []
    position = {int(row): (i, k) for (i, k), row in np.ndenumerate(mounted.rows)}
    for group in scatter.groups:
        moved = {int(row): group.deviations[:, c].astype(np.complex128) for c, row in enumerate(group.rows)}
        total: dict[int, ComplexArray] = {row: d for row, d in moved.items() if row not in position}
        change = _change(moved, position, mounted, pushed)
        for k, right in change.items():
            turned = np.einsum("ijl,jhl->ihl", inverse, right)
            total.update({int(row): turned[i] for i, row in enumerate(mounted.rows[:, k])})
        rows = np.array(sorted(total), dtype=np.int64)
        deviations = np.stack([total[int(row)] for row in rows], axis=1)
        groups.append(HitGroup(rows, deviations.astype(group.deviations.dtype)))
    return HitScatter(tuple(groups))


def _change(
    moved: Mapping[int, ComplexArray],
    position: Mapping[int, tuple[int, int]],
    mounted: _Mounted,
    pushed: ComplexArray,
) -> dict[int, ComplexArray]:
    """Return d A_k + d A_JJ m s^2 true_k of one group of hits, by column k, each (n_sensors, n_hits, n_lines)."""
    n, n_points = mounted.rows.shape
    shape = (n, *next(iter(moved.values())).shape)
    change: dict[int, ComplexArray] = {}
    for row, deviation in moved.items():
        if row in position:
            i, k = position[row]
            change.setdefault(k, np.zeros(shape, dtype=np.complex128))[i] += deviation
    for i, j in np.ndindex(n, n):
        deviation_between = moved.get(int(mounted.between[i, j]))
        if deviation_between is not None and mounted.masses[j] > 0:
            for k in range(n_points):
                part = change.setdefault(k, np.zeros(shape, dtype=np.complex128))
                part[i] += deviation_between * pushed[j, k]
    return change


def _variance(
    variance: FloatArray, mounted: _Mounted, inverse: ComplexArray, pushed: ComplexArray
) -> FloatArray:
    """Carry variances through, FRFs taken for independent (first order)."""
    result, gain = np.array(variance), np.abs(inverse) ** 2
    for rows, push in zip(mounted.rows.T, np.moveaxis(pushed, 1, 0), strict=True):
        same = mounted.between == rows[:, None]
        twice = np.abs(1 + np.einsum("ij,jl->il", same, push)) ** 2 * variance[rows]
        others = np.where(same[:, :, None], 0.0, variance[mounted.between])
        right = twice + np.einsum("ijl,jl->il", others, np.abs(push) ** 2)
        result[rows] = np.einsum("ijl,jl->il", gain, right)
    return result


def _masses(mass: float | Mapping[Dof, float], sensors: Sequence[Dof]) -> dict[Dof, float]:
    if isinstance(mass, Mapping):
        known = {_plain(dof): float(value) for dof, value in mass.items()}
        lost = [str(dof) for dof in sensors if dof not in known]
        if lost:
            raise InputError(
                f"no mass is given for the sensor at {', '.join(lost)}; give 0 where there is none"
            )
        masses = {dof: known[dof] for dof in sensors}
    else:
        masses = dict.fromkeys(sensors, float(mass))
    wrong = {dof: value for dof, value in masses.items() if not (np.isfinite(value) and value >= 0)}
    if wrong:
        dof, value = next(iter(wrong.items()))
        raise InputError(f"the mass of the sensor at {dof} is {value} kg; give a mass of 0 or more")
    return masses


def _plain(dof: Dof) -> Dof:
    return Dof(dof.node, abs(dof.direction))
