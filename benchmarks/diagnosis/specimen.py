"""A random specimen: the modeller's nominal model, what it really is, and how it is tested."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from diagnosis.body import Body
from diagnosis.mesh import Floats
from updating import Environment, Material, Spec, Tolerances
from updating.models.parts import PointMass
from updating.models.spec import Damping

MATERIALS = (
    (70e9, 2700.0, 0.33),
    (210e9, 7850.0, 0.3),
    (110e9, 4430.0, 0.34),
    (100e9, 8500.0, 0.35),
    (45e9, 1800.0, 0.3),
)
BEAM_MESH, PLATE_MESH = (32,), (24, 16)


@dataclass(frozen=True, eq=False)
class Rig:
    """How a specimen is tested.

    Parameters
    ----------
    points : (n, dim) array
        Where the points are said to be [m].
    sensor : int
        The one that carries the sensor.
    modes : int
        How many modes are in the band.
    absolute, baseline : bool
        Whether levels are calibrated, and whether there is a test before the effect.
    noise : float
        Noise of a modal constant, relative to the mode's r.m.s. [-].
    frequency_noise, damping_noise : float
        Relative standard deviations [-].
    calibration, repeatability, position_sigma : float
        As in the study file [-, -, m].
    remounted_damping : float
        Scatter of damping from one mounting to the next [-].
    level, span : float
        Mean peak force [N], and ratio of the hardest to the softest hit [-].
    """

    points: Floats
    sensor: int
    modes: int
    absolute: bool
    baseline: bool
    noise: float
    frequency_noise: float
    damping_noise: float
    calibration: float
    repeatability: float
    position_sigma: float
    remounted_damping: float
    level: float
    span: float


@dataclass(frozen=True, eq=False)
class Specimen:
    """The nominal model, the body as it is without any effect, and the rig.

    Parameters
    ----------
    spec, tolerances, environment : Spec, Tolerances, Environment
        What the modeller says.
    body : Body
        What is really there.
    scatter : (m,) array
        Factor on the damping of each mode [-].
    rig : Rig
        The test.
    """

    spec: Spec
    tolerances: Tolerances
    environment: Environment
    body: Body
    scatter: Floats
    rig: Rig


def draw_specimen(
    rng: np.random.Generator,
    kind: str,
    *,
    thick: bool,
    absolute: bool,
    baseline: bool,
    clamped: bool | None = None,
) -> Specimen:
    """Draw a specimen.

    Parameters
    ----------
    rng : Generator
        Source of chance.
    kind : str
        beam or plate.
    thick : bool
        Whether Euler-Bernoulli theory falls short on purpose.
    absolute, baseline : bool
        Of the rig.
    clamped : bool, optional
        Whether it must be clamped or free; left out, either.
    """
    E, density, poisson = MATERIALS[rng.integers(len(MATERIALS))]
    length = rng.uniform(0.25, 0.7)
    width = length * (rng.uniform(0.05, 0.1) if kind == "beam" else rng.uniform(0.45, 0.9))
    thickness = length * np.exp(rng.uniform(*np.log(_slenderness(kind, thick))))
    thickness = min(thickness, width) if kind == "beam" else thickness
    edges = _edges(rng, kind, clamped)
    modes = int(rng.integers(4, 7)) if kind == "beam" else int(rng.integers(6, 13))
    points, sensor = _points(rng, kind, length, width, edges)
    theory = "kirchhoff" if kind == "plate" else "euler-bernoulli" if thick else "timoshenko"
    masses: tuple[PointMass, ...] = ()
    weight = density * length * width * thickness
    if rng.random() < 0.5 or not absolute:
        known = float(rng.uniform(0.002, 0.01) * weight) if rng.random() < 0.5 else 0.0
        masses = (PointMass(tuple(points[sensor]), known),)
    first, last = _first_and_last(kind, E, density, length, width, thickness, edges, modes)
    tolerances = {"E": 0.01, "density": 0.003, "thickness": 0.005, "length": 0.002, "width": 0.002}
    tolerances = {n: v * rng.uniform(0.5, 1.5) for n, v in tolerances.items()}
    doubt = float(rng.uniform(0.15, 0.3))
    alpha, beta = _rayleigh(rng, first, last)
    spec = Spec(
        kind,  # type: ignore[arg-type]
        length=length,
        width=width,
        thickness=thickness,
        elements=BEAM_MESH if kind == "beam" else PLATE_MESH,
        clamped=edges,
        theory=theory,  # type: ignore[arg-type]
        material=Material(E, density, poisson),
        masses=masses,
        damping=Damping(alpha, beta),
    )
    body = _draw_body(rng, spec, tolerances)
    scatter = np.exp(doubt * (rng.standard_normal() + rng.standard_normal(60)))
    around = Environment(fluid_density=998.0) if rng.random() < 0.5 else Environment()
    rig = _draw_rig(rng, points, sensor, modes, absolute=absolute, baseline=baseline)
    return Specimen(spec, Tolerances(tolerances, doubt), around, body, scatter, rig)


def _draw_body(rng: np.random.Generator, spec: Spec, tolerances: dict[str, float]) -> Body:
    """Return what is really there: each property off by its tolerance, and the sensors that have a mass."""
    off = {n: float(np.exp(v * rng.standard_normal())) for n, v in tolerances.items()}
    body = Body(
        spec.kind, spec.length * off["length"], spec.width * off["width"], spec.thickness * off["thickness"],
        spec.material.E * off["E"], spec.material.density * off["density"], spec.material.poisson, spec.clamped,
    )  # fmt: skip
    sensors = tuple((*shares(spec, np.array(m.at), body), m.mass, 0.0) for m in spec.masses if m.mass)
    return body.but(masses=sensors)


def _draw_rig(
    rng: np.random.Generator, points: Floats, sensor: int, modes: int, *, absolute: bool, baseline: bool
) -> Rig:
    return Rig(
        points, sensor, modes, absolute, baseline,
        noise=float(np.exp(rng.uniform(*np.log([0.005, 0.02])))),
        frequency_noise=float(np.exp(rng.uniform(*np.log([5e-5, 5e-4])))),
        damping_noise=float(rng.uniform(0.02, 0.06)),
        calibration=float(rng.choice([0.01, 0.02, 0.03])),
        repeatability=float(rng.choice([0.0003, 0.0005, 0.001])),
        position_sigma=float(rng.choice([0.0005, 0.001, 0.002])),
        remounted_damping=float(rng.uniform(0.03, 0.1)),
        level=float(rng.uniform(20.0, 200.0)),
        span=float(rng.choice([1.3, 2.5, 5.0])),
    )  # fmt: skip


def with_rig(specimen: Specimen, **changes: object) -> Specimen:
    """Return the same specimen tested otherwise."""
    return replace(specimen, rig=replace(specimen.rig, **changes))  # type: ignore[arg-type]


def shares(spec: Spec, at: Floats, body: Body) -> tuple[float, float]:
    """Return where a place of the model is on the body, as shares of its length and width.

    The length grows at a clamped edge: places keep their distance from the free end, or the middle.
    """
    ends = {edge for edge in spec.clamped if edge[0] == "x"}
    share = 1.0 if ends == {"x0"} else 0.0 if ends == {"x1"} else 0.5
    x = (at[0] + share * (body.length - spec.length)) / body.length
    y = at[1] / spec.width if len(at) > 1 else 0.5
    return float(np.clip(x, 0, 1)), float(np.clip(y, 0, 1))


def _slenderness(kind: str, thick: bool) -> list[float]:
    if kind == "plate":
        return [1 / 400, 1 / 120]
    return [1 / 18, 1 / 9] if thick else [1 / 150, 1 / 20]


def _edges(rng: np.random.Generator, kind: str, clamped: bool | None) -> tuple[str, ...]:
    if clamped is False:
        return ()
    free: list[tuple[str, ...]] = [()] * 3 if clamped is None else []
    common: list[tuple[str, ...]] = [("x0",)] * 5 + [("x0", "x1")]
    more: list[tuple[str, ...]] = [("x0", "y0"), ("x0", "x1", "y0", "y1")] if kind == "plate" else []
    choices = common + more + free
    return choices[rng.integers(len(choices))]


def _points(
    rng: np.random.Generator, kind: str, length: float, width: float, edges: tuple[str, ...]
) -> tuple[Floats, int]:
    """Draw points away from clamped edges, and the one of the sensor."""

    def along(count: int, low: bool, high: bool) -> Floats:
        ends = np.linspace(0.15 if low else 0.01, 0.85 if high else 0.99, count)
        return np.asarray(np.clip(ends + rng.uniform(-0.15, 0.15, count) / count, 0.005, 0.995))

    if kind == "beam":
        x = length * along(int(rng.integers(5, 10)), "x0" in edges, "x1" in edges)
        sensor = len(x) - 1 if "x1" not in edges and rng.random() < 0.5 else int(rng.integers(1, len(x)))
        return x[:, None], sensor
    nx, ny = ((3, 3), (4, 3), (4, 4), (5, 4), (5, 5))[rng.integers(5)]
    x = length * along(nx, "x0" in edges, "x1" in edges)
    y = width * along(ny, "y0" in edges, "y1" in edges)
    points = np.stack([m.ravel() for m in np.meshgrid(x, y, indexing="ij")], axis=1)
    points = points + rng.uniform(-0.02, 0.02, points.shape) * [length, width]
    points = np.clip(points, 0.002, np.array([length, width]) - 0.002)
    corner = "x1" not in edges and "y1" not in edges and rng.random() < 0.6
    return points, len(points) - 1 if corner else int(rng.integers(len(points)))


def _first_and_last(
    kind: str, E: float, density: float, length: float, width: float, thickness: float,
    edges: tuple[str, ...], modes: int,
) -> tuple[float, float]:  # fmt: skip
    """Return a rough range of the angular frequencies, to place damping ratios in."""
    speed = thickness * np.sqrt(E / density / 12)
    lowest = {0: 4.73, 1: 1.875}.get(len(edges), 4.73)
    first = speed * (lowest / length) ** 2
    if kind == "beam":
        return first, speed * (((modes - 0.5) if len(edges) == 1 else modes + 0.5) * np.pi / length) ** 2
    return first, max(4 * np.pi * modes / (length * width) * speed, 3 * first)


def _rayleigh(rng: np.random.Generator, first: float, last: float) -> tuple[float, float]:
    """Draw alpha [1/s] and beta [s] that give plausible ratios to the first and the last mode."""
    ratios = np.array([rng.uniform(0.004, 0.012), rng.uniform(0.001, 0.005)])
    omega = np.array([first, last])
    alpha, beta = np.linalg.solve(0.5 * np.column_stack([1 / omega, omega]), ratios)
    return float(max(alpha, 0.1)), float(max(beta, 1e-9))
