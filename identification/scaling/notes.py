"""Notes on the scale of mode shapes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from acquisition.quantities import quantity
from acquisition.warned import Consequential
from identification.arrangement import Arrangement

_CERTAIN = 5.0
_DELAYED = np.radians(20.0)


def no_drive_point(frfs: FrfSet) -> str:
    """State that no FRF gives the scale, and how near the nearest came."""
    return (
        f"no drive point: no point was both hit and measured at one node and axis{_nearest(frfs)}, so the mode "
        "shapes are not mass-normalised; measure one drive point to scale them"
    )


def _nearest(frfs: FrfSet) -> str:
    """Name the FRF along one axis whose ends lie nearest to each other."""
    same = [
        i
        for i, (a, b) in enumerate(zip(frfs.responses, frfs.references, strict=True))
        if a.axis == b.axis and a.node in frfs.geometry and b.node in frfs.geometry
    ]
    if not same:
        return ""
    ends = [frfs.geometry.at([side[i].node for i in same]) for side in (frfs.responses, frfs.references)]
    distance = np.linalg.norm(ends[0] - ends[1], axis=1)
    best = int(distance.argmin())
    name = f"{frfs.responses[same[best]]}/{frfs.references[same[best]]}"
    return f" (the nearest are {name}, {quantity(distance[best], 'm')} apart)"


def not_tied(points: Sequence[str]) -> str:
    """State which points are left out of the shapes."""
    listed = ", ".join(points[:5]) + (f" and {len(points) - 5} more" if len(points) > 5 else "")
    return (
        f"no FRF connects {listed} to the other points; their scale and sign relative to the others are unknown, and "
        "they are left out of the mode shapes: measure one point in common"
    )


def about_scale(plan: Arrangement, column: IntArray, certainty: FloatArray) -> tuple[str, ...]:
    """State in which modes the scale is uncertain.

    Parameters
    ----------
    plan : Arrangement
        The FRFs as a matrix.
    column : (n_rows,) int array
        Column with the degree of freedom of each row, -1 where there is none.
    certainty : (n_modes,) array
        Scale over its standard deviation [-].
    """
    weak = np.flatnonzero(certainty < _CERTAIN) + 1
    if not len(weak):
        return ()
    names = ", ".join(str(plan.rows[i]) for i in _measured(plan, column))
    place = f"the drive point {names}" if names else "the references"
    return (f"mode(s) {_listed(weak)} hardly move at {place}: their scale is uncertain",)


def _measured(plan: Arrangement, column: IntArray) -> list[int]:
    """Return the rows whose drive point was measured."""
    return [int(i) for i in np.flatnonzero(column >= 0) if plan.index[i, column[i]] >= 0]


def contradicted(
    plan: Arrangement, constants: tuple[ComplexArray, FloatArray], column: IntArray, alone: BoolArray
) -> IntArray:
    """Return the rows whose drive point is none: its constants are negative in some modes, positive in others.

    Parameters
    ----------
    plan : Arrangement
        The FRFs as a matrix.
    constants : tuple of (n_frf, n_modes) arrays
        Modal constants and their standard deviations [1/kg].
    column : (n_rows,) int array
        Column with the degree of freedom of each row, -1 where there is none.
    alone : (n_modes,) bool array
        Whether a mode overlaps with no other. Damping couples those that do, and of one such mode a constant at a drive
        point may have any phase.
    """
    false = []
    for i in _measured(plan, column):
        value, spread = (c[plan.index[i, column[i]]][alone] for c in constants)
        if np.any(value.real < -_CERTAIN * spread) and np.any(value.real > _CERTAIN * spread):
            false.append(i)
    return np.array(false, dtype=np.int64)


def about_drive_points(
    plan: Arrangement, constants: tuple[ComplexArray, FloatArray], column: IntArray, alone: BoolArray
) -> tuple[str, ...]:
    """State where a drive point contradicts a passive structure; parameters as for :func:`contradicted`."""
    stated = []
    for i in _measured(plan, column):
        frf = plan.index[i, column[i]]
        value, spread = constants[0][frf], np.maximum(constants[1][frf], 1e-300)
        angle = np.abs(np.angle(value))
        negative = alone & (value.real < -_CERTAIN * spread)
        wrong = np.flatnonzero(negative) + 1
        if len(wrong):
            others = np.any(alone & (value.real > _CERTAIN * spread))
            stated.append(_negative(str(plan.rows[i]), wrong, others))
        doubt = spread / np.maximum(np.abs(value), 1e-300)
        late = np.flatnonzero((doubt < 1.0 / _CERTAIN) & (angle - 3.0 * doubt > _DELAYED) & ~negative) + 1
        if len(late):
            stated.append(
                f"the phase of the modal constant of the drive point {plan.rows[i]} is off by up to "
                f"{np.degrees(angle[late - 1].max()):.0f} degrees in mode(s) {_listed(late)}: strongly complex modes, "
                "or a delay between the channels"
            )
    return tuple(stated)


def _negative(point: str, wrong: IntArray, others: np.bool_) -> str:
    """State what a negative drive-point constant means: a passive structure has none."""
    found = f"the drive point {point} has a negative modal constant in mode(s) {_listed(wrong)}"
    if others:
        return Consequential(
            f"{found} and a positive one in others: hit and sensor cannot have been at one place, "
            "so it cannot scale the mode shapes; check the node numbers"
        )
    return Consequential(f"{found}: check the direction signs of hammer and sensor")


def _listed(numbers: IntArray) -> str:
    return ", ".join(str(int(n)) for n in numbers)
