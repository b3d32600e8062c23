"""What a study knows of its test, as the forecast of the blind rig takes it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from modalkit.planning.bench import Bench
from modalkit.planning.known import KnownTest, by_default
from modalkit.planning.own import own_bench
from modalkit.planning.rig import RigBench
from modalkit.simulator.setup import Setup, Tolerances
from modalkit.study.read import Study
from modalkit.workflow.case import open_study
from modalkit.workflow.identification import Processed
from updating import Case, Measured, Spec

GAS = 10.0
"""A surrounding of less density moves nothing that can be seen [kg/m3]."""

SHAPE_FLOOR = 1e-3
"""No constant is taken to be known better than this, relative to its mode's largest: points are not that good [-]."""

_NOISE, _BITS, _PEAK, _SCATTER, _HITS = 1e-3, 24, 100.0, 0.3, 5
_RATIOS = (0.005, 0.002)
_POINTS = 8


@dataclass(frozen=True, eq=False)
class _Layout:
    points: FloatArray
    sensor: int
    drive: bool
    statement: tuple[str, ...]
    left_out: tuple[str, ...] = ()


def bench_of(study: Study) -> Bench:
    """Return a study's structure and test as the forecast takes them.

    A beam is the rig's own body; a plate, matrices and a deck are the study's model, seen as the diagnosis sees it.

    Parameters
    ----------
    study : Study
        With data or without.

    Raises
    ------
    StudyError
        If nothing says where it is hit, or its band holds too few modes.
    """
    return RigBench(known_test_of(study)) if study.spec().kind == "beam" else own_bench(study)


def known_test_of(study: Study) -> KnownTest:
    """Return the test of a study's beam as the forecast takes it.

    Parameters
    ----------
    study : Study
        With data or without; what no data tell is taken by default, and said so.
    """
    spec = study.spec()
    case, processed = None, None
    if study.test.files or study.test.modes:
        session = open_study(study, with_baseline=False)
        case, processed = session.case, session.processed
    test = None if case is None else case.measured
    layout = _planned(study, spec) if test is None else _layout(spec, test)
    setup, words = _setup(study, spec, layout, test, processed)
    frequency, damping, shape, known = _sigmas(setup, test)
    left_out = [*layout.left_out, *_left_out(study, spec, case)]
    without = ("fluid_added_mass", "fluid_damping") if _in_gas(study) else ()
    shapes = test is None or test.has_shapes
    has_damping = test is None or bool(np.isfinite(test.damping).any())
    return KnownTest(
        setup,
        frequency,
        damping,
        shape,
        damping_known=has_damping and (spec.damping.known or setup.baseline),
        shapes=shapes,
        absolute=test is None or test.absolute,
        without=without,
        statement=(*layout.statement, *words, *known),
        left_out=tuple(left_out),
    )


def _in_gas(study: Study) -> bool:
    known_test = study.surroundings().fluid_density
    return known_test is not None and known_test < GAS


def _planned(study: Study, spec: Spec) -> _Layout:
    """Return where a test that is only planned will be hit and seen.

    Raises
    ------
    StudyError
        If a point is off the beam.
    """
    table = study.test
    if other := [one for one in (*table.points, table.sensor) if not isinstance(one, float | None)]:
        raise StudyError(f"{study.path}: [test] points: {other[0]} is no place along a beam; write x in [m]")
    points = np.array(table.points, dtype=float) if table.points else _even(spec)
    free_end = 0.0 if tuple(spec.clamped) == ("x1",) else spec.length
    sensor_at = float(points[np.argmin(np.abs(points - free_end))])
    if isinstance(table.sensor, float):
        sensor_at = table.sensor
    off = [x for x in (*points, sensor_at) if not 0 <= x <= spec.length]
    if off:
        raise StudyError(
            f"{study.path}: [test] points: {off[0]:g} m is off the beam, which reaches from 0 to {spec.length:g} m"
        )
    every = np.unique([*points, sensor_at])
    drive = bool(np.isclose(points, sensor_at).any())
    whence = "as planned" if table.points else "by default, since no data and no [test] points say where"
    statement = f"{len(points)} points hit, the sensor at {1e3 * sensor_at:.0f} mm ({whence})"
    return _Layout(every, int(np.argmin(np.abs(every - sensor_at))), drive, (statement,))


def _even(spec: Spec) -> FloatArray:
    """Return evenly spaced points off the clamped ends [m]."""
    low, high = (f"x{i}" in spec.clamped for i in (0, 1))
    return np.asarray(spec.length * (np.arange(_POINTS) + low) / (_POINTS - 1 + low + high))


def _layout(spec: Spec, test: Measured) -> _Layout:
    """Return where it was hit and seen: one sensor and a roving hammer, or the other way round."""
    if not len(test.points):
        even = _even(spec)
        statement = f"the data have no points; where the advice needs them: {_POINTS}, evenly spaced"
        return _Layout(even, len(even) - 1, True, (statement,))
    x, seen, hit = test.points[:, 0], test.seen, test.hit
    left_out: list[str] = []
    if (hit < 0).any():
        return _Layout(x, len(x) - 1, True, (f"{len(x)} points of the shapes",))
    roving = len(np.unique(seen)) > len(np.unique(hit))
    fixed, moving = (hit, seen) if roving else (seen, hit)
    sensor = int(np.bincount(fixed).argmax())
    if roving:
        left_out.append("the sensor roved: it is taken to sit at the hammer's point, its mass with it")
    if len(np.unique(fixed)) > 1:
        left_out.append(f"{len(np.unique(fixed))} fixed points: the one with most FRFs is taken")
    mine = np.unique(moving[fixed == sensor])
    chosen = np.union1d(mine, [sensor])
    order = chosen[np.argsort(x[chosen])]
    drive = bool((mine == sensor).any())
    own = int(np.flatnonzero(order == sensor)[0])
    among = ", drive point among them" if drive else ""
    statement = f"{len(mine)} points hit, the sensor at {1e3 * x[sensor]:.0f} mm{among}"
    return _Layout(x[order], own, drive, (statement,), tuple(left_out))


def _setup(
    study: Study, spec: Spec, layout: _Layout, test: Measured | None, processed: Processed | None
) -> tuple[Setup, tuple[str, ...]]:
    table, tolerances = study.test, study.tolerances
    modes, band, about = _band(study, spec, test)
    alpha, beta, damping = _rayleigh(spec, test, about)
    known = [m for m in spec.masses if abs(m.at[0] - layout.points[layout.sensor]) < 0.02 * spec.length]
    hits = _hits(processed)
    around = study.surroundings()
    setup = Setup(
        kind="beam",
        title=study.name,
        length=spec.length,
        width=spec.width,
        thickness=spec.thickness,
        E=spec.material.E,
        density=spec.material.density,
        poisson=spec.material.poisson,
        clamped=tuple(spec.clamped),
        theory="timoshenko" if spec.theory == "rayleigh" else spec.theory,
        elements=tuple(spec.elements),
        tolerances=Tolerances(
            **{
                name: getattr(tolerances, name)
                for name in ("E", "density", "thickness", "length", "width", "damping")
            }
        ),
        alpha=alpha,
        beta=beta,
        points=tuple((round(float(x), 6),) for x in layout.points),
        sensor=layout.sensor,
        drive=layout.drive,
        sensor_sign=1,
        sensor_mass=sum(m.mass for m in known),
        modes=modes,
        band=band,
        hits=hits or table.hits or _HITS,
        peak=_PEAK,
        level_scatter=_SCATTER,
        bad_hits=0.0,
        noise=_NOISE,
        noise_slope=0.0,
        bits=_BITS,
        calibration=table.calibration,
        repeatability=table.repeatability,
        position_sigma=table.position_sigma,
        window=table.exponential_window,
        baseline=study.baseline is not None,
        environment=None if _in_gas(study) else around.fluid_density,
        free_surface=around.free_surface,
        bottom=around.bottom,
    )
    return setup, (
        f"{modes} modes in {band[0]:g} to {band[1]:g} Hz",
        damping,
        *([f"{hits} hits a point"] if hits else []),
        *(["with the baseline, what changed since is asked about"] if setup.baseline else []),
        *_tank(study),
    )


def _tank(study: Study) -> list[str]:
    """Return what of a liquid's borders is stated, and what is left open; nothing of a gas."""
    around = study.surroundings()
    if _in_gas(study):
        return []
    borders = {"free surface": around.free_surface, "bottom": around.bottom}
    stated = [f"{name} at {1e3 * place:.0f} mm" for name, place in borders.items() if place is not None]
    unstated = " and ".join(name for name, place in borders.items() if place is None)
    return [*stated, *([f"{unstated} of a fluid not stated: near or far off"] if unstated else [])]


def _band(study: Study, spec: Spec, test: Measured | None) -> tuple[int, tuple[float, float], FloatArray]:
    """Return how many modes there are, the band, and about where modes lie [rad/s]."""
    from modalkit.simulator.bodies.beam.beam import Beam

    beam = Beam(
        0.0, spec.length, spec.width, spec.thickness, spec.material.E, spec.material.density,
        clamped=tuple(spec.clamped), elements=6,
    )  # fmt: skip
    omega, _ = beam.real_modes(12 + beam.rigid_modes)
    hertz = omega[beam.rigid_modes :] / (2 * np.pi)
    known_test = study.test.band
    if test is not None:
        modes = len(test.frequency)
    elif known_test is not None:
        modes = max(int(np.sum(hertz < known_test[1])), 2)
    else:
        modes = 5
    modes = min(modes, 11)
    band = known_test or (float(f"{0.25 * hertz[0]:.2g}"), float(f"{1.2 * hertz[modes - 1]:.3g}"))
    return modes, (float(band[0]), float(band[1])), np.asarray(2 * np.pi * hertz[:modes])


def _rayleigh(spec: Spec, test: Measured | None, omega: FloatArray) -> tuple[float, float, str]:
    """Return alpha [1/s] and beta [s] of the rig, and where they come from."""
    known_test = spec.damping
    if known_test.alpha is not None or known_test.beta is not None:
        return known_test.alpha or 0.0, known_test.beta or 0.0, "damping as the model expects it"
    if known_test.ratios is not None:
        ratios, words = (
            np.array(known_test.ratios[: len(omega)]),
            "damping near the ratios that the model expects",
        )
    elif known_test.loss_factor is not None:
        ratios, words = (
            np.full(len(omega), known_test.loss_factor / 2),
            "damping near the model's loss factor",
        )
    elif test is not None and np.isfinite(test.damping).all():
        ratios, words = (
            test.damping,
            "the model expects no damping: that measured is taken, and tells nothing",
        )
    else:
        ratios = np.linspace(*_RATIOS, len(omega))
        words = "the model expects no damping: 0.5 to 0.2 % is taken, and tells nothing"
    ratios, omega = ratios[: len(omega)], omega[: len(ratios)]
    columns = 0.5 * np.column_stack([1 / omega, omega]) / ratios[:, None]
    alpha, beta = _not_negative(columns)
    return alpha, beta, words


def _not_negative(columns: FloatArray) -> tuple[float, float]:
    from scipy.optimize import nnls

    scale = np.linalg.norm(columns, axis=0)
    found, _ = nnls(columns / scale, np.ones(len(columns)))
    alpha, beta = found / scale
    return float(alpha), float(beta)


def _hits(processed: Processed | None) -> int:
    if processed is None or not processed.hits:
        return 0
    used = [verdict for verdict in processed.hits if verdict.used]
    return round(len(used) / max(len({verdict.point for verdict in used}), 1))


def _sigmas(
    setup: Setup, test: Measured | None
) -> tuple[FloatArray, FloatArray, FloatArray, tuple[str, ...]]:
    """Return how well frequencies, damping and constants are known, and where that comes from."""
    frequency, damping, shape = by_default(setup.modes)
    words = [
        f"no data tell how well: frequencies to {100 * frequency[0]:g} %, damping to {100 * damping[0]:g} %, "
        f"constants to {100 * shape[0]:g} % of their mode's largest are taken"
    ]
    if test is None:
        return frequency, damping, shape, tuple(words)
    frequency = np.asarray(test.frequency_sigma / test.frequency)
    words = [f"frequencies known to {100 * np.median(frequency):.2g} %"]
    if np.isfinite(test.damping_sigma / test.damping).all():
        damping = np.asarray(test.damping_sigma / test.damping)
        words.append(f"damping to {100 * np.median(damping):.2g} %")
    if test.has_shapes:
        largest = np.abs(test.constants).max(axis=0)
        shape = np.maximum(np.median(test.own_sigma, axis=0) / largest, SHAPE_FLOOR)
        words.append(f"constants to {100 * np.median(shape):.2g} % of their mode's largest")
    else:
        words.append("no shapes: frequencies alone")
    words = [f"from the identification: {', '.join(words)}"]
    return frequency[: setup.modes], damping[: setup.modes], shape[: setup.modes], tuple(words)


def _left_out(study: Study, spec: Spec, case: Case | None) -> list[str]:
    found = []
    if spec.regions and any(
        getattr(region, name) is not None
        for region in spec.regions
        for name in ("E", "density", "thickness", "area", "inertia", "alpha", "beta", "loss_factor")
    ):
        found.append("regions with properties of their own: the rig's specimen is uniform")
    if spec.theory == "euler-bernoulli":
        found.append("euler-bernoulli theory: the rig has shear and rotary inertia, which such a model lacks")
    around = study.surroundings()
    if around.walls is not None:
        found.append("the walls of the tank: the rig's fluid has none at its sides")
    if case is not None and case.accepted:
        found.append(f"effects put into the model: {', '.join(name for name, _ in case.accepted)}")
    return found
