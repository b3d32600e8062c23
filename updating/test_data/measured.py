"""What a test says, in the coordinates of the model: the data side of every comparison."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from acquisition import Dof, ModalData
from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.display import Displayed, counted
from acquisition.errors import StudyError
from identification import ModalModel
from identification.scaling.shapes import turned
from updating.models import Spec
from updating.test_data.axes import Axes
from updating.test_data.placement import Key, matched, place

if TYPE_CHECKING:
    import pandas as pd

UNKNOWN_LEVEL = 0.2
"""A calibration worse than this is found by least squares before anything is linearised [-]."""

GUESSED_SHAPE_SIGMA = 0.02
"""Error of a shape of which none is stated, over its r.m.s. [-]: two transducers' calibrations. The diagnosis takes it
times an unknown scale, an update estimates it. Doubled: shapes of few points count a quarter as much."""

UNSTATED, NO_PARTNER = -1, -2
"""What stands among the partners for a mode of which nothing is stated, and for one that is stated to have none."""


@dataclass(frozen=True, eq=False)
class Measured(Displayed):
    """Modes of one test as a model can predict them.

    The *constants* are the modal constants phi_response * phi_reference of each FRF: with absolute level for
    a calibrated FRF, up to a factor per mode where only shapes are known. Mass-normalised shapes have a level without
    any FRF: their components phi_response [kg^-1/2], the sign of each mode free, stand in the constants' place.

    Parameters
    ----------
    frequency, frequency_sigma : (n_modes,) arrays
        Natural frequencies and the standard deviations the identification gives them [Hz].
    damping, damping_sigma : (n_modes,) arrays
        Damping ratios and their standard deviations, nan where unknown [-].
    points : (n_points, dim) array
        Test points in model axes [m].
    nodes : tuple of int
        Their node numbers; one that moves in two directions stands twice.
    seen, hit : (n_frf,) int arrays
        Point of the response and of the force of each FRF; ``hit`` is -1 where only a shape is known.
    constants, constants_sigma : (n_frf, n_modes) arrays
        Modal constants and standard deviations, positive along the points' directions [1/kg; where ``hit`` is -1,
        kg^-1/2, or - per mode].
    absolute : bool
        Whether the constants carry absolute level.
    repeated : bool
        Whether the scatter of the constants is known from repeated hits.
    calibration : float
        Relative 1-sigma uncertainty of the level [-].
    repeatability : float
        Relative 1-sigma scatter of the frequencies by re-mounting [-].
    position_sigma : float
        1-sigma uncertainty of the points hit [m].
    title, warnings : str, tuple of str
        For messages.
    rows : (n_frf,) int array, optional
        Row of each constant among the FRFs that were identified; None where there are only modes.
    signs : (n_frf,) array, optional
        Sign by which those FRFs, their transducers' directions made positive, point along the model's axes [-].
    directions : (n_points, 3) array, optional
        Which way each point moves in model axes; left out, along the model's z [-].
    noise : (n_frf, n_modes) array, optional
        The part of ``constants_sigma`` that is each constant's own; None where all of it is [1/kg].
    shared : (n_frf, n_modes, k) array, optional
        The rest: what one standard deviation of each of k independent causes does to all constants [1/kg].
    phase, phase_sigma : (n_chains, n_modes) arrays, optional
        By how much the complex constants of each measurement chain are turned, from -pi/2 to pi/2, and its
        standard deviation; ``constants`` are turned back by it [rad].
    channel_group : (n_frf,) int array, optional
        Which chain each FRF was measured by.
    slope, slope_sigma : (n_modes,) arrays, optional
        Relative change of each frequency per newton of the hits' peak force [1/N].
    level : float, optional
        Mean peak force of the hits [N].
    below : int
        How many modes are known to lie below the lowest of these: left out by a band [-].
    written : tuple of str, optional
        Each point as the test writes its degree of freedom, ``5+Z``; left out, by its node alone.
    trusted : (n_frf,) bool array, optional
        Rows by whose shapes modes are paired, where the others spoil them; left out, all.
    partners : (n_modes,) int array, optional
        Rank of the nominal model's mode that each one is stated to be, from 0; `UNSTATED`, or `NO_PARTNER`.
    partner_constants : (n_frf, n_modes) array, optional
        Constants of those modes, by which they are known again in a model that has changed [as ``constants``].
    guessed : bool
        Whether ``constants_sigma`` is a guess: nobody stated how well the shapes are known.
    trend, trend_sigma : (n_modes,) arrays, optional
        Relative change of each frequency from the first point to the last in measuring order, and the standard
        deviation of what it has for itself, nan where unknown; None where a test does not rove [-].
    common_trend_sigma : float
        Standard deviation of the error that all of them share [-].
    unpaired : Measured, optional
        The modes of the same test that have no partner in the nominal model; None where all have one.
    """

    frequency: FloatArray
    frequency_sigma: FloatArray
    damping: FloatArray
    damping_sigma: FloatArray
    points: FloatArray
    nodes: tuple[int, ...]
    seen: IntArray
    hit: IntArray
    constants: FloatArray
    constants_sigma: FloatArray
    absolute: bool
    repeated: bool = True
    calibration: float = 0.02
    repeatability: float = 0.0005
    position_sigma: float = 0.001
    title: str = ""
    warnings: tuple[str, ...] = ()
    rows: IntArray | None = None
    signs: FloatArray | None = None
    directions: FloatArray | None = None
    noise: FloatArray | None = None
    shared: FloatArray | None = None
    phase: FloatArray | None = None
    phase_sigma: FloatArray | None = None
    channel_group: IntArray | None = None
    slope: FloatArray | None = None
    slope_sigma: FloatArray | None = None
    level: float | None = None
    below: int = 0
    written: tuple[str, ...] = ()
    trusted: BoolArray | None = None
    partners: IntArray | None = None
    partner_constants: FloatArray | None = None
    guessed: bool = False
    unpaired: Measured | None = None
    trend: FloatArray | None = None
    trend_sigma: FloatArray | None = None
    common_trend_sigma: float = 0.0

    @property
    def own_sigma(self) -> FloatArray:
        """Standard deviation of each constant that no other shares, (n_frf, n_modes) [1/kg, or - per mode]."""
        return self.constants_sigma if self.noise is None else self.noise

    @property
    def has_shapes(self) -> bool:
        """Whether there are at least two components a shape can be compared in."""
        return len(self.seen) >= 2

    @property
    def sensors(self) -> tuple[int, ...]:
        """Points that carry a response transducer; empty where only shapes are known."""
        return tuple(sorted(set(self.seen.tolist()))) if self.absolute and not self.bare else ()

    @property
    def bare(self) -> bool:
        """Whether the constants are components of shapes, joined to no point of force."""
        return bool((self.hit < 0).all())

    def same_signs(self, constants: FloatArray) -> FloatArray:
        """Return by what sign each predicted mode, (n_frf, n_modes), is to be taken; a product's is not free [-]."""
        if not self.bare:
            return np.ones(constants.shape[1])
        return np.where(np.sum(self.constants * constants, axis=0) < 0, -1.0, 1.0)

    @property
    def top(self) -> float:
        """Highest measured frequency, of modes with a partner in the model and of those without [Hz]."""
        alone = () if self.unpaired is None else self.unpaired.frequency
        return float(np.max([*self.frequency, *alone], initial=0.0))

    @property
    def level_sigma(self) -> float:
        """Relative standard deviation of the level of the constants; a shape goes with the root of an FRF [-]."""
        return self.calibration / 2 if self.bare else self.calibration

    def modes(self, keep: BoolArray | IntArray) -> Measured:
        """Return the same test with some of its modes."""
        across = (
            "constants",
            "constants_sigma",
            "noise",
            "shared",
            "phase",
            "phase_sigma",
            "partner_constants",
        )
        along = (
            "frequency",
            "frequency_sigma",
            "damping",
            "damping_sigma",
            "slope",
            "slope_sigma",
            "trend",
            "trend_sigma",
            "partners",
        )
        columns = {n: getattr(self, n)[:, keep] for n in across if getattr(self, n) is not None}
        rows = {n: getattr(self, n)[keep] for n in along if getattr(self, n) is not None}
        return replace(self, **rows, **columns)

    def _headline(self) -> str:
        at = f"{counted(len(self.constants), 'channel')} at {counted(len(self.nodes), 'point')}"
        span = f"{self.frequency.min():g} to {self.frequency.max():g} Hz" if len(self.frequency) else ""
        return (
            f"{counted(len(self.frequency), 'mode')} {span}, {at}, {'with' if self.absolute else 'no'} level"
        )

    def _frame(self) -> pd.DataFrame:
        import pandas as pd

        columns = {
            "frequency [Hz]": self.frequency,
            "sigma [Hz]": self.frequency_sigma,
            "damping [%]": 100 * self.damping,
            "sigma [%]": 100 * self.damping_sigma,
        }
        return pd.DataFrame(columns, index=pd.RangeIndex(1, len(self.frequency) + 1, name="mode"))


def measured_from_modes(
    modes: ModalData,
    axes: Axes,
    spec: Spec,
    *,
    shape_sigma: float | None = None,
    match_tolerance: float | None = None,
    **options: float | str,
) -> Measured:
    """Take plain modal data to the model's axes.

    Parameters
    ----------
    modes : ModalData
        Frequencies, and where known damping and shapes.
    axes : Axes
        The model's axes in test coordinates.
    spec : Spec
        The model, whose outline the points must meet.
    shape_sigma : float, optional
        Standard deviation of every component over the r.m.s. of its shape, in place of what the modes state [-].
    match_tolerance : float, optional
        How far from the model's nodes a point may lie; left out, as far as they are apart [m].
    **options
        Calibration, repeatability, position_sigma, title of :class:`Measured`.

    Returns
    -------
    Measured
        Mass-normalised shapes keep their level, whose doubt is the calibration; others are compared up to a factor
        per mode. Complex shapes are turned to be as real as they can be.
    """
    placed = place(modes.dofs if modes.shapes is not None else (), modes.geometry, axes, spec)
    points, beside = matched(placed.points, placed.keys, spec, match_tolerance)
    rows = placed.rows
    shapes = (
        np.zeros((0, len(modes)))
        if modes.shapes is None
        else _straight(modes.shapes)[rows] * placed.signs[:, None]
    )
    absolute = modes.scaled and len(rows) > 0
    guessed = modes.shape_sigma is None and shape_sigma is None
    if modes.shape_sigma is not None and shape_sigma is None:
        sigma = modes.shape_sigma[rows]
    else:
        part = GUESSED_SHAPE_SIGMA if shape_sigma is None else shape_sigma
        sigma = part * np.sqrt(np.sum(shapes**2, axis=0) / max(len(shapes), 1)) * np.ones_like(shapes)
    return Measured(
        modes.frequency,
        np.where(np.isfinite(modes.frequency_sigma), modes.frequency_sigma, 0.0),
        _column(modes.damping, len(modes)),
        _column(modes.damping_sigma, len(modes)),
        points,
        tuple(node for node, _ in placed.keys),
        placed.index,
        np.full(len(rows), -1),
        shapes,
        sigma,
        absolute=absolute,
        repeated=False,
        warnings=(
            *placed.warnings,
            *beside,
            *_without_sigma(modes, float(options.get("repeatability", 0.0))),
            *modes.doubts(),
            *(_with_level(float(options.get("calibration", Measured.calibration))) if absolute else ()),
        ),
        directions=_directions(placed.keys, spec),
        guessed=guessed,
        **options,  # type: ignore[arg-type]
    )


def _straight(shapes: ComplexArray) -> FloatArray:
    """Return shapes turned to be as real as they can be, in the sense that their real parts had, (n_dofs, n_modes)."""
    real = turned(shapes)[0].real
    return np.asarray(real * np.where(np.sum(real * shapes.real, axis=0) < 0, -1.0, 1.0))


def _with_level(calibration: float) -> tuple[str, ...]:
    """Say that the level of mass-normalised shapes is compared, and how to have it left alone."""
    if calibration > UNKNOWN_LEVEL:
        return ()
    return (
        f"the shapes are stated to be mass-normalised: their level is compared too, with calibration = {calibration:g} "
        "for the doubt in it; if nobody measured the modal masses (many programs write 1), set calibration = 1",
    )


def _without_sigma(modes: ModalData, repeatability: float) -> tuple[str, ...]:
    """Warn where nobody said how well frequencies are known; refuse such that nothing makes uncertain."""
    exact = np.flatnonzero(~(np.nan_to_num(modes.frequency_sigma) > 0))
    if repeatability == 0 and len(exact):
        raise StudyError(
            f"mode {exact[0] + 1} at {modes.frequency[exact[0]]:g} Hz has no uncertainty: its sigma is 0 or missing, "
            "and repeatability is 0; give one of them"
        )
    missing = int(np.sum(~np.isfinite(modes.frequency_sigma)))
    if not missing:
        return ()
    return (
        f"{missing} of {len(modes)} frequencies came without a sigma: they are taken to be as good as the stated "
        f"repeatability, {100 * repeatability:g} %; add a column sigma [Hz] if they are worse",
    )


def measured_from_identified(
    model: ModalModel,
    axes: Axes,
    spec: Spec,
    *,
    match_tolerance: float | None = None,
    **options: float | str,
) -> Measured:
    """Take an identified modal model to the model's axes, with absolute level.

    Parameters
    ----------
    model : ModalModel
        Identified from FRFs.
    axes, spec, match_tolerance, **options
        As in :func:`measured_from_modes`.
    """
    geometry = model.modal.geometry
    responses = place(model.responses, geometry, axes, spec)
    references = place(model.references, geometry, axes, spec)
    both = np.intersect1d(responses.rows, references.rows)
    if len(both) == 0:
        raise StudyError(
            f"{options.get('title', 'test')}: no FRF is measured and hit along the model's z; check axes in [test]"
        )
    at_response = {row: i for i, row in enumerate(responses.rows.tolist())}
    at_reference = {row: i for i, row in enumerate(references.rows.tolist())}
    left = np.array([at_response[row] for row in both.tolist()])
    right = np.array([at_reference[row] for row in both.tolist()])
    keys = tuple(dict.fromkeys(responses.keys + references.keys))
    where = {key: i for i, key in enumerate(keys)}
    points = np.stack([(responses if k in responses.keys else references).point(k) for k in keys])
    points, beside = matched(points, keys, spec, match_tolerance)
    seen, hit = responses.index[left], references.index[right]
    signs = responses.signs[left] * references.signs[right]
    constants = turn(model.constants[both] * signs[:, None], model.constant_sigma[both], seen, hit)
    return Measured(
        model.modal.frequency,
        model.modal.frequency_sigma,
        _column(model.modal.damping, len(model.modal)),
        _column(model.modal.damping_sigma, len(model.modal)),
        points,
        tuple(node for node, _ in keys),
        np.array([where[responses.keys[i]] for i in seen.tolist()]),
        np.array([where[references.keys[i]] for i in hit.tolist()]),
        constants.real,
        constants.widened(model.constant_sigma[both]),
        absolute=True,
        repeated=model.frfs.variance is not None,
        warnings=tuple(dict.fromkeys(responses.warnings + references.warnings + beside)),
        rows=both,
        signs=signs,
        directions=_directions(keys, spec),
        written=_written(
            (
                *(where[references.keys[i]] for i in hit.tolist()),
                *(where[responses.keys[i]] for i in seen.tolist()),
            ),
            (*(model.references[i] for i in both.tolist()), *(model.responses[i] for i in both.tolist())),
        ),
        noise=constants.widened(
            model.constant_noise[both],
            _across(constants.real * signs[:, None], model.constant_shared[both]),
        ),
        shared=model.constant_shared[both] * signs[:, None, None],
        phase=constants.phase,
        phase_sigma=constants.phase_sigma,
        channel_group=constants.channel_group,
        trend=None if model.trend is None else model.trend.value,
        trend_sigma=None if model.trend is None else model.trend.sigma,
        common_trend_sigma=0.0 if model.trend is None else model.trend.common_sigma,
        **options,  # type: ignore[arg-type]
    )


def _written(points: tuple[int, ...], dofs: tuple[Dof, ...]) -> tuple[str, ...]:
    """Return every point as the test writes the last of its degrees of freedom."""
    last = dict(zip(points, dofs, strict=True))
    return tuple(str(last[point]) for point in range(len(last)))


def _across(constants: FloatArray, shared: FloatArray) -> FloatArray:
    """Return the mean square of shared errors across each mode's shape, (n_modes,) [1/kg^2]."""
    along = np.einsum("jr,jrk->rk", constants, shared) / np.sum(constants**2, axis=0)[:, None]
    return np.asarray(np.mean(np.sum((shared - constants[..., None] * along) ** 2, axis=2), axis=0))


@dataclass(frozen=True, eq=False)
class Turned:
    """Complex modal constants as real ones and by how much each chain turned them; see :func:`turn`.

    Parameters
    ----------
    real, imaginary : (n_frf, n_modes) arrays
        Along and across the direction to which most of a mode's constants point [1/kg].
    phase, phase_sigma : (n_chains, n_modes) arrays
        That direction, within a quarter turn of all chains' together so that no sign is lost between them, and its
        standard deviation [rad].
    channel_group : (n_frf,) int array
        Which chain measured each FRF.
    """

    real: FloatArray
    imaginary: FloatArray
    phase: FloatArray
    phase_sigma: FloatArray
    channel_group: IntArray

    def widened(self, sigma: FloatArray, known: FloatArray | float = 0.0) -> FloatArray:
        """Widen standard deviations (n_frf, n_modes) to what the imaginary parts show.

        The constants of real modes are real; what disturbs an FRF turns them as much as it stretches them, so the
        scatter of the imaginary parts of a mode measures the error of its real parts. ``known`` (n_modes,) is the
        part of it that other causes explain [1/kg^2].
        """
        excess = np.mean(self.imaginary**2, axis=0) - np.mean(sigma**2, axis=0) - known
        return np.asarray(np.sqrt(sigma**2 + np.maximum(excess, 0.0)))


def chain_phases(constants: ComplexArray, channel_group: IntArray) -> FloatArray:
    """Return the direction to which most of the constants of a mode point, chain by chain, (n_chains, n_modes) [rad].

    Within a quarter turn of all chains' together, which is within one of the real axis.
    """
    member = (channel_group == np.arange(int(channel_group.max()) + 1)[:, None]).astype(float)
    common = np.angle(np.sum(constants**2, axis=0)) / 2
    return np.asarray(common + np.angle((member @ constants**2) * np.exp(-2j * common)) / 2)


def turn(constants: ComplexArray, sigma: FloatArray, seen: IntArray, hit: IntArray) -> Turned:
    """Turn complex modal constants to the real axis, chain by chain and mode by mode.

    A real mode's constants are real. A chain that delays turns all those of a mode alike, by -omega times the
    delay; what reversed signs there are does not change that direction.

    Parameters
    ----------
    constants : (n_frf, n_modes) complex array
        Modal constants [1/kg].
    sigma : (n_frf, n_modes) array
        Their standard deviations [1/kg].
    seen, hit : (n_frf,) int arrays
        Point of the response and of the force of each FRF; a response transducer that stays is a chain, one that
        roves is one chain in all.
    """
    transducers, channel_group = np.unique(seen, return_inverse=True)
    if len(transducers) > len(np.unique(hit)):
        channel_group = np.zeros(len(seen), dtype=np.int64)
    member = (channel_group == np.arange(int(channel_group.max()) + 1)[:, None]).astype(float)
    phase = chain_phases(constants, channel_group)
    real, imaginary = (part(constants * np.exp(-1j * phase[channel_group])) for part in (np.real, np.imag))
    power = np.maximum(member @ real**2, 1e-300)
    excess = np.maximum(np.mean(imaginary**2, axis=0) - np.mean(sigma**2, axis=0), 0.0)
    phase_sigma = np.sqrt(member @ (real**2 * (sigma**2 + excess))) / power
    return Turned(np.asarray(real), np.asarray(imaginary), phase, phase_sigma, channel_group.astype(np.int64))


def _directions(keys: tuple[Key, ...], spec: Spec) -> FloatArray | None:
    return np.array([d for _, d in keys]).reshape(-1, 3) if spec.imported is not None else None


def _column(values: FloatArray | None, count: int) -> FloatArray:
    return np.full(count, np.nan) if values is None else values
