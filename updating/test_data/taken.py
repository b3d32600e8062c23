"""Modal data and identified models, taken to the axes of a model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition import ModalData
from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.errors import StudyError
from acquisition.form import FORMS
from identification import ModalModel
from identification.scaling.shapes import turned
from updating.models import Spec
from updating.test_data.axes import Axes
from updating.test_data.chain_phase import turn
from updating.test_data.measured import UNKNOWN_LEVEL, Measured
from updating.test_data.placement import Key, Placed, matched, place

GUESSED_SHAPE_SIGMA = 0.02
"""Error of a shape of which none is stated, over its r.m.s. [-]: two transducers' calibrations. The diagnosis takes it
times an unknown scale, an update estimates it. Doubled: shapes of few points count a quarter as much."""


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
    shapes = _shapes(modes, placed)
    absolute = modes.scaled and len(placed.rows) > 0
    return Measured(
        frequency=modes.frequency,
        frequency_sigma=np.where(np.isfinite(modes.frequency_sigma), modes.frequency_sigma, 0.0),
        damping=_column(modes.damping, len(modes)),
        damping_sigma=_column(modes.damping_sigma, len(modes)),
        points=points,
        nodes=tuple(node for node, _ in placed.keys),
        seen=placed.index,
        hit=np.full(len(placed.rows), -1),
        constants=shapes,
        constants_sigma=_shape_sigma(modes, placed, shapes, shape_sigma),
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
        guessed=modes.shape_sigma is None and shape_sigma is None,
        **options,  # type: ignore[arg-type]
    )


def _shapes(modes: ModalData, placed: Placed) -> FloatArray:
    """Return the shapes where the model can follow, along the points' directions, (n_rows, n_modes)."""
    if modes.shapes is None:
        return np.zeros((0, len(modes)))
    return np.asarray(_straight(modes.shapes)[placed.rows] * placed.signs[:, None])


def _shape_sigma(modes: ModalData, placed: Placed, shapes: FloatArray, stated: float | None) -> FloatArray:
    """Return standard deviations of shapes (n_rows, n_modes): as stated, of the modes, or guessed, in that order."""
    if modes.shape_sigma is not None and stated is None:
        return np.asarray(modes.shape_sigma[placed.rows])
    part = GUESSED_SHAPE_SIGMA if stated is None else stated
    rms = np.sqrt(np.sum(shapes**2, axis=0) / max(len(shapes), 1))
    return np.asarray(part * rms * np.ones_like(shapes))


def _straight(shapes: ComplexArray) -> FloatArray:
    """Return shapes turned to be as real as they can be, in the sense that their real parts had, (n_dofs, n_modes)."""
    real = turned(shapes)[0].real
    return np.asarray(real * np.where(np.sum(real * shapes.real, axis=0) < 0, -1.0, 1.0))


def _with_level(calibration: float) -> tuple[str, ...]:
    """State that the level of mass-normalised shapes is compared, and how to have it left alone."""
    if calibration > UNKNOWN_LEVEL:
        return ()
    return (
        "the shapes are stated to be mass-normalised: their level is compared, too, with the "
        f"uncertainty calibration = {calibration:g}. If the modal masses were not measured (many programs write 1), "
        "set calibration = 1",
    )


def _without_sigma(modes: ModalData, repeatability: float) -> tuple[str, ...]:
    """Warn where the uncertainty of frequencies was not stated; refuse frequencies without any uncertainty."""
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
        f"{missing} of {len(modes)} frequencies have no sigma: the stated repeatability, {100 * repeatability:g} %, is "
        "taken as their uncertainty; add a column sigma [Hz] if it is larger",
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
    ends = _both_ends(model, axes, spec, str(options.get("title", "test")), match_tolerance)
    rows, signs = ends.rows, ends.signs[:, None]
    constants = turn(model.constants[rows] * signs, model.constant_sigma[rows], *ends.transducers)
    shared = model.constant_shared[rows]
    trend, recorded = model.trend, model.frfs.record or model.frfs
    return Measured(
        frequency=model.modal.frequency,
        frequency_sigma=model.modal.frequency_sigma,
        damping=_column(model.modal.damping, len(model.modal)),
        damping_sigma=_column(model.modal.damping_sigma, len(model.modal)),
        points=ends.points,
        nodes=tuple(node for node, _ in ends.keys),
        seen=ends.seen,
        hit=ends.hit,
        constants=constants.real,
        constants_sigma=constants.widened(model.constant_sigma[rows]),
        absolute=True,
        repeated=model.frfs.variance is not None,
        warnings=ends.warnings,
        rows=rows,
        signs=ends.signs,
        directions=_directions(ends.keys, spec),
        written=_written(model, ends),
        noise=constants.widened(model.constant_noise[rows], _across(constants.real * signs, shared)),
        shared=shared * signs[..., None],
        hit_errors=None if model.hit_errors is None else model.hit_errors.rows(rows),
        quadrature=np.mean(constants.imaginary**2, axis=0),
        phase=constants.phase,
        phase_sigma=constants.phase_sigma,
        channel_group=constants.channel_group,
        trend=None if trend is None else trend.value,
        trend_sigma=None if trend is None else trend.sigma,
        common_trend_sigma=0.0 if trend is None else trend.common_sigma,
        fading=model.fading,
        recorded_power=FORMS.index(recorded.form),
        **options,  # type: ignore[arg-type]
    )


@dataclass(frozen=True, eq=False)
class _Ends:
    """The FRFs whose both ends the model can follow.

    Parameters
    ----------
    rows : (n,) int array
        Which FRFs.
    keys : tuple of (node, direction)
        What their points are, those of the responses first.
    points : (n_points, dim) array
        Where these are in model axes [m].
    seen, hit : (n,) int arrays
        Point of the response and of the force.
    transducers : two (n,) int arrays
        The same among the points of the responses, and among those of the forces.
    signs : (n,) array
        Sign by which each FRF points along the model's axes [-].
    warnings : tuple of str
        What was left out, and which points were moved.
    """

    rows: IntArray
    keys: tuple[Key, ...]
    points: FloatArray
    seen: IntArray
    hit: IntArray
    transducers: tuple[IntArray, IntArray]
    signs: FloatArray
    warnings: tuple[str, ...]


def _both_ends(model: ModalModel, axes: Axes, spec: Spec, title: str, match_tolerance: float | None) -> _Ends:
    """Put the responses and references of an identified model on the model of the structure.

    Raises
    ------
    StudyError
        If no FRF has both ends where the model can follow, or a point lies off it.
    """
    geometry = model.modal.geometry
    responses = place(model.responses, geometry, axes, spec)
    references = place(model.references, geometry, axes, spec)
    rows = np.intersect1d(responses.rows, references.rows)
    if len(rows) == 0:
        raise StudyError(f"{title}: no FRF is measured and hit along the model's z; check axes in [test]")
    left, right = np.searchsorted(responses.rows, rows), np.searchsorted(references.rows, rows)
    keys = tuple(dict.fromkeys(responses.keys + references.keys))
    where = {key: i for i, key in enumerate(keys)}
    points = np.stack([(responses if k in responses.keys else references).point(k) for k in keys])
    points, beside = matched(points, keys, spec, match_tolerance)
    seen, hit = responses.index[left], references.index[right]
    return _Ends(
        rows=rows,
        keys=keys,
        points=points,
        seen=np.array([where[responses.keys[i]] for i in seen.tolist()]),
        hit=np.array([where[references.keys[i]] for i in hit.tolist()]),
        transducers=(seen, hit),
        signs=responses.signs[left] * references.signs[right],
        warnings=tuple(dict.fromkeys(responses.warnings + references.warnings + beside)),
    )


def _written(model: ModalModel, ends: _Ends) -> tuple[str, ...]:
    """Return every point as the test writes the last of its degrees of freedom, a response before a force."""
    rows = ends.rows.tolist()
    dofs = [*(model.references[i] for i in rows), *(model.responses[i] for i in rows)]
    last = dict(zip([*ends.hit.tolist(), *ends.seen.tolist()], dofs, strict=True))
    return tuple(str(last[point]) for point in range(len(last)))


def _across(constants: FloatArray, shared: FloatArray) -> FloatArray:
    """Return the mean square of shared errors across each mode's shape, (n_modes,) [1/kg^2]."""
    along = np.einsum("jr,jrk->rk", constants, shared) / np.sum(constants**2, axis=0)[:, None]
    return np.asarray(np.mean(np.sum((shared - constants[..., None] * along) ** 2, axis=2), axis=0))


def _directions(keys: tuple[Key, ...], spec: Spec) -> FloatArray | None:
    return np.array([d for _, d in keys]).reshape(-1, 3) if spec.imported is not None else None


def _column(values: FloatArray | None, count: int) -> FloatArray:
    return np.full(count, np.nan) if values is None else values
