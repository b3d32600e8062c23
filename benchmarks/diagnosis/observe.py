"""From a body and a rig to what a test would report of it: noise, mounting, level, and errors of the measurement."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from diagnosis.body import Body
from diagnosis.damped import damped
from diagnosis.mesh import Floats
from diagnosis.solve import Solved, solve
from diagnosis.specimen import Rig, Specimen, shares
from updating import Measured
from updating.test_data.chain_phase import turn

NONE: Mapping[int, tuple[float, ...]] = MappingProxyType({})
SAME_MARK = 0.8
"""How much of the error of a point's place stays from test to test [-]."""
FAINT = 0.3
"""Constants noisier than this share of their r.m.s. belong to modes that no one would identify [-]."""


@dataclass(frozen=True, eq=False)
class Faults:
    """What is wrong with the measurement itself.

    Parameters
    ----------
    decay : float
        Of an exponential window left in [1/s].
    gain : float
        On every FRF [-].
    delay : float
        Of the responses [s].
    reversed : tuple of int
        Points hit from the other side; -1 is the sensor.
    exchanged : tuple of (int, int)
        Points whose labels are exchanged.
    moved : mapping
        By how much points were missed [m].
    slope : float
        Relative change of frequency per newton of a joint that softens, for a mode that strains it like a
        plain cantilever's [1/N].
    """

    decay: float = 0.0
    gain: float = 1.0
    delay: float = 0.0
    reversed: tuple[int, ...] = ()
    exchanged: tuple[tuple[int, int], ...] = ()
    moved: Mapping[int, tuple[float, ...]] = field(default_factory=lambda: NONE)
    slope: float = 0.0


@dataclass(frozen=True, eq=False)
class Truth:
    """Modes of a body at the points of a rig, without noise.

    Parameters
    ----------
    frequency, damping : (n_modes,) arrays
        [Hz, -].
    constants : (n_points, n_modes) complex array
        Modal constants between every point and the sensor [1/kg].
    slope : (n_modes,) array
        Relative change of the frequencies per newton [1/N].
    """

    frequency: Floats
    damping: Floats
    constants: np.ndarray
    slope: Floats


@dataclass(frozen=True, eq=False)
class Marks:
    """Errors that both tests of a specimen share: where the points were marked, and the calibration.

    Parameters
    ----------
    places : (n_points, dim) array
        [m].
    sensor : (dim,) array
        [m].
    level : float
        Factor of the calibration [-].
    """

    places: Floats
    sensor: Floats
    level: float


def draw_marks(rng: np.random.Generator, rig: Rig) -> Marks:
    """Draw where the points were marked, and the calibration."""
    size = SAME_MARK * rig.position_sigma
    return Marks(
        size * rng.standard_normal(rig.points.shape),
        np.asarray(size * rng.standard_normal(rig.points.shape[1])),
        float(np.exp(rig.calibration * rng.standard_normal())),
    )


def truth_of(
    specimen: Specimen,
    solved: Solved,
    faults: Faults,
    scatter: Floats,
    errors: tuple[Floats, Floats],
) -> Truth:
    """Return the modes of a solved body at the points hit.

    Parameters
    ----------
    specimen : Specimen
        The rig and the model, in whose axes points are stated.
    solved : Solved
        The body's modes.
    faults : Faults
        What is wrong with the measurement.
    scatter : (m,) array
        Factor on the plain damping of each mode [-].
    errors : (n_points, dim) and (dim,) arrays
        By how much points and sensor are missed [m].
    """
    rig, body = specimen.rig, solved.body
    root = np.sqrt(scatter[: len(solved.omega)])
    plain = specimen.spec.damping
    mass, stiffness = solved.proportional
    viscous = ((plain.alpha or 0.0) * mass + (plain.beta or 0.0) * stiffness) * np.outer(root, root)
    viscous = viscous + body.alpha * mass + body.beta * stiffness
    modes = damped(solved.omega, viscous, solved.losses, solved.drag, rig.modes)
    places = rig.points + errors[0]
    for point, away in faults.moved.items():
        places[point] = places[point] + np.array(away)
    shapes = solved.shapes(_on_body(specimen, body, places)) @ modes.shapes
    sensor = (
        solved.shapes(_on_body(specimen, body, (rig.points[rig.sensor] + errors[1])[None])) @ modes.shapes
    )
    constants = faults.gain * shapes * sensor * np.exp(-1j * modes.poles.imag * faults.delay)
    for a, b in faults.exchanged:
        constants[[a, b]] = constants[[b, a]]
    for point in faults.reversed:
        constants[slice(None) if point < 0 else point] *= -1
    poles = modes.poles - faults.decay
    size = np.abs(poles)
    share = _joint_share(solved)[: rig.modes] if faults.slope else np.zeros(rig.modes)
    return Truth(size / (2 * np.pi), -poles.real / size, constants, faults.slope * share)


def _on_body(specimen: Specimen, body: Body, places: Floats) -> Floats:
    on = np.array([shares(specimen.spec, p, body) for p in places])
    return np.asarray(on * [body.length, body.width])[:, : places.shape[1]]


def _joint_share(solved: Solved) -> Floats:
    """Return how much each mode strains a clamp that turns, relative to the first ones [-]."""
    soft = solve(solved.body.but(rotation=_joint_spring(solved.body)))
    share = 1 - soft.omega / solved.omega[: len(soft.omega)]
    return np.asarray(share / np.median(share[:4]))


def _joint_spring(body: Body) -> float:
    rigidity = body.E * body.thickness**3 / 12 * (body.width if body.kind == "beam" else 1.0)
    return 300 * rigidity / body.length


def measure(
    specimen: Specimen,
    solved: Solved,
    faults: Faults,
    marks: Marks,
    rng: np.random.Generator,
    scatter: Floats,
) -> Measured:
    """Test a body once: it is mounted anew, hit beside its marks, and identified with noise."""
    rig = specimen.rig
    loose = np.sqrt(1 - SAME_MARK**2) * rig.position_sigma
    places, sensor = (e + loose * rng.standard_normal(e.shape) for e in (marks.places, marks.sensor))
    remounted = np.exp(rig.remounted_damping * rng.standard_normal(len(scatter)))
    true = truth_of(specimen, solved, faults, scatter * remounted, (places, sensor))
    constants = true.constants * (marks.level if rig.absolute else 1.0)
    size = np.sqrt(np.mean(np.abs(constants) ** 2, axis=0))
    noise = rig.noise * np.maximum(1.0, 0.3 * np.median(size) / size)
    kept = np.flatnonzero(noise < FAINT)
    n = len(kept)
    frequency, damping = true.frequency[kept], true.damping[kept]
    slope_sigma = rig.frequency_noise / (rig.level * (rig.span - 1) / (rig.span + 1)) * np.ones(n)
    slope = true.slope[kept]
    frequency = frequency * (1 + slope * rig.level)
    sigma = rig.frequency_noise * np.exp(rng.uniform(-0.5, 0.5, n))
    own = (noise * size)[kept] * np.ones((len(constants), 1))
    chance = rng.standard_normal((2, *own.shape))
    data = constants[:, kept] + own * (chance[0] + 1j * chance[1])
    count = len(rig.points)
    seen = np.full(count, rig.sensor)
    hit = np.arange(count)
    turned = turn(data, own, seen, hit)
    frequency = frequency * (1 + np.hypot(sigma, rig.repeatability) * rng.standard_normal(n))
    found = Measured(
        frequency=frequency,
        frequency_sigma=sigma * frequency,
        damping=damping * np.exp(rig.damping_noise * rng.standard_normal(n)),
        damping_sigma=rig.damping_noise * damping,
        points=rig.points,
        nodes=tuple(range(1, count + 1)),
        seen=seen,
        hit=hit,
        constants=turned.real,
        constants_sigma=turned.widened(own),
        absolute=True,
        repeated=True,
        calibration=rig.calibration,
        repeatability=rig.repeatability,
        position_sigma=rig.position_sigma,
        title="simulated",
        phase=turned.phase,
        phase_sigma=turned.phase_sigma,
        channel_group=turned.channel_group,
        slope=slope + slope_sigma * rng.standard_normal(n) if rig.span >= 2 else None,
        slope_sigma=slope_sigma if rig.span >= 2 else None,
        level=rig.level,
    )
    order = np.argsort(found.frequency)
    found = found.modes(order)
    return found if rig.absolute else _shapes_only(found)


def _shapes_only(found: Measured) -> Measured:
    """Return what is left without references and levels: shapes up to a factor per mode."""
    scale = np.sqrt(np.mean(found.constants**2, axis=0))
    return replace(
        found,
        seen=found.hit,
        hit=np.full(len(found.hit), -1),
        constants=found.constants / scale,
        constants_sigma=found.constants_sigma / scale,
        absolute=False,
        repeated=True,
        phase=None,
        phase_sigma=None,
        channel_group=None,
    )
