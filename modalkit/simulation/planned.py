"""The rig of a study without hits: at the points of its shapes, or at points of our own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil, log2

import numpy as np

from acquisition import Dof, Geometry, HammerPlan
from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from modalkit.simulation.setup import (
    FORCE_NOISE,
    HITS,
    PEAK,
    PULSE,
    RESPONSE_NOISE,
    SAMPLING,
    TRIGGER,
    MeasurementSetup,
    Options,
)
from modalkit.study.read import Study
from modalkit.workflow.planned_points import planned_points
from updating import Measured, Predictor, Spec
from updating.simulation import natural_modes, simulated
from updating.test_data.axes import Axes

LOWEST_BAND, MODES = 0.2, 5
"""Where no band is stated: from a part of the first frequency to a little above the fifth."""

DECAYED, LONGEST = 6.0, 65536
"""Records last until the slowest mode has decayed by this exponent, in no more samples [-]."""


def rig_of_model(study: Study, spec: Spec, measured: Measured | None, options: Options) -> MeasurementSetup:
    """Return a rig for a study without hits: at the points of its shapes if any, else at evenly spaced ones.

    The sensor sits where the modeller stated a mass, else at the point where the faintest mode of the band is
    strongest; the band is the study's, else that of the modes measured, else of the model's first five.

    Parameters
    ----------
    study : Study
        The study.
    spec : Spec
        Its model, with the damping of the simulation.
    measured : Measured, optional
        Its modal data.
    options : Options
        What the user states.
    """
    axes, notes = study.axes(study.test), []
    planned = planned_points(study, spec) if measured is None else None
    if planned is not None:
        points, nodes, directions = planned.points, planned.nodes, planned.directions
        notes.append(f"the study has no hits: the hammer goes to the {len(planned.hit)} points that it plans")
    elif measured is not None and len(measured.points):
        points, nodes, directions = measured.points, measured.nodes, measured.directions
        notes.append(f"the study has no hits: the hammer goes to the {len(points)} points of its shapes")
    else:
        points, directions = spaced(spec, options.points), None
        nodes = tuple(range(1, len(points) + 1))
        notes.append(f"the study has no points: the hammer goes to {len(points)}, evenly spaced")
    frequency = np.zeros(0) if measured is None else measured.frequency
    hit = range(len(points)) if planned is None else planned.hit
    blank = _blank(points, nodes, directions, 0)
    modes = natural_modes(simulated(Predictor(spec, blank)))
    band = study.test.band or _band(frequency, modes.frequency)
    inside = (modes.frequency > band[0]) & (modes.frequency < band[1])
    stated = None if planned is None else planned.sensor
    sensor = _sensor(spec, points, modes.shapes[:, inside]) if stated is None else stated
    names, geometry = named(points, nodes, directions, axes)
    notes.append(f"the sensor sits at {names[sensor]}")
    slowest = float(np.min((modes.damping * 2 * np.pi * modes.frequency)[inside], initial=np.inf))
    plan = _usual_plan(band, slowest + study.test.exponential_window, options)
    plan = replace(plan, position_sigma=study.test.position_sigma, decay=study.test.exponential_window)
    return MeasurementSetup(
        measured=_blank(points, nodes, directions, sensor, hit),
        responses=(names[sensor],) * len(hit),
        references=tuple(names[i] for i in hit),
        signs=np.ones(len(hit)),
        geometry=geometry,
        band=band,
        plan=plan,
        notes=tuple(notes),
    )


def _blank(
    points: FloatArray,
    nodes: tuple[int, ...],
    directions: FloatArray | None,
    sensor: int,
    hit: Sequence[int] | None = None,
) -> Measured:
    """Return a test without modes: every point, or some, is hit, one is observed."""
    chosen = np.arange(len(points)) if hit is None else np.array(hit)
    n, none = len(chosen), np.zeros(0)
    return Measured(
        frequency=none, frequency_sigma=none, damping=none, damping_sigma=none, points=points, nodes=nodes,
        seen=np.full(n, sensor), hit=chosen, constants=np.zeros((n, 0)), constants_sigma=np.zeros((n, 0)),
        absolute=True, directions=directions,
    )  # fmt: skip


def spaced(spec: Spec, count: int | None) -> FloatArray:
    """Return evenly spaced points off the clamped edges, (n, dim) [m]: five along a beam, 5 x 4 on a plate.

    Raises
    ------
    StudyError
        If the model has no shape of its own.
    """
    if not spec.outlined:
        raise StudyError(
            "imported matrices do not state where to hit: give [test] files with points, shapes, or "
            "[test] points"
        )
    if count is not None and count < 2:
        raise StudyError(f"--points {count}: give at least 2")
    if spec.kind == "beam":
        return _along(spec.length, count or 5, "x", spec)[:, None]
    across = 4 if count is None else max(2, round((count * spec.width / spec.length) ** 0.5))
    x = _along(spec.length, 5 if count is None else max(2, round(count / across)), "x", spec)
    y = _along(spec.width, across, "y", spec)
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)


def _along(size: float, count: int, axis: str, spec: Spec) -> FloatArray:
    """Return places between two edges, on those that are free."""
    low, high = (f"{axis}{end}" in spec.clamped for end in (0, 1))
    return np.asarray(size * (np.arange(count) + low) / (count - 1 + low + high))


def _band(measured: FloatArray, model: FloatArray) -> tuple[float, float]:
    """Return a band around the modes measured and their like of the model, else around its first, in three digits."""
    count = len(measured) or MODES
    both = np.concatenate([measured, model[:count]])
    return float(f"{LOWEST_BAND * both.min():.2g}"), float(f"{1.1 * both.max():.3g}")


def _sensor(spec: Spec, points: FloatArray, shapes: FloatArray) -> int:
    """Return the point of the sensor."""
    if spec.masses:
        return int(np.argmin(np.linalg.norm(points - np.array(spec.masses[0].at)[: points.shape[1]], axis=1)))
    if not shapes.size:
        return len(points) - 1
    return int(np.argmax((np.abs(shapes) / np.abs(shapes).max(axis=0)).min(axis=1)))


def named(
    points: FloatArray, nodes: tuple[int, ...], directions: FloatArray | None, axes: Axes
) -> tuple[tuple[Dof, ...], Geometry]:
    """Return degrees of freedom that point the model's way, and their nodes in test coordinates."""
    flat = np.zeros((len(points), 3))
    flat[:, : points.shape[1]] = points
    ways = np.tile([0.0, 0.0, 1.0], (len(points), 1)) if directions is None else directions
    ways, places = ways @ axes.rotation, np.asarray(axes.origin) + flat @ axes.rotation
    once = [nodes.index(node) for node in dict.fromkeys(nodes)]
    main = np.argmax(np.abs(ways), axis=1)
    size = ways[np.arange(len(ways)), main]
    if np.abs(size).min() > 1 - 1e-9:
        codes = (main + 1) * np.sign(size).astype(int)
        own = None
    else:  # axes that are turned by other than right angles stand at every node
        codes, own = np.full(len(ways), 3), np.tile(axes.rotation, (len(once), 1, 1))
    names = tuple(Dof(node, int(code)) for node, code in zip(nodes, codes, strict=True))
    return names, Geometry(tuple(nodes[i] for i in once), places[once], axes=own)


def _usual_plan(band: tuple[float, float], slowest: float, options: Options) -> HammerPlan:
    """Return how a test is made where nothing is known: records until the slowest mode has decayed."""
    rate = options.rate or SAMPLING * band[1]
    wanted = rate * DECAYED / max(slowest, DECAYED * rate / LONGEST)
    samples = options.samples or 2 ** ceil(log2(max(wanted, 256)))
    return HammerPlan(
        rate=rate,
        samples=samples,
        hits=options.hits or HITS,
        peak=PEAK,
        width=PULSE / band[1],
        pre_trigger=TRIGGER * samples / rate,
        force_noise=FORCE_NOISE * PEAK,
        response_noise=RESPONSE_NOISE if options.noise is None else options.noise,
    )
