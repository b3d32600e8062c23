"""Plates and strips in water whose inertia and modes come from ``water``: nothing of the rig or the library in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from water.rings import FAR, Water, rectangle
from water.ritz import Plate

from acquisition import Dof, Geometry, HammerPlan, ModalData, hammer_test, write_uff
from acquisition.modes.csv_table import modes_csv
from acquisition.synthetic import modal_system
from cases.trial import Cause, Make, Trial

Array = NDArray[np.float64]
DENSITY, VISCOSITY = 998.0, 1e-3
MODES, BASIS = 8, 26
METALS = ((210e9, 7850.0, 0.3), (70e9, 2700.0, 0.33))
DOUBTS = {"E": 0.01, "density": 0.003, "thickness": 0.005, "length": 0.002, "width": 0.002}
REPEATABILITY, CALIBRATION, SHAPE_NOISE = 0.0005, 0.02, 0.01


@dataclass(frozen=True)
class Scene:
    """What a case is.

    Parameters
    ----------
    aspect : (low, high)
        Length over width [-].
    clamped : bool
        Cantilever, or free.
    wall : bool
        Whether no water passes round the clamp.
    tank : bool
        Whether side walls and a free surface are near, none of which the study states.
    stated : bool
        Whether the study states the density and what bounds the water.
    baseline : bool
        Whether the specimen was tested in air before.
    soft : bool
        Whether the clamp turns; in air as well.
    oil : bool
        Whether the liquid is a viscous oil.
    even : bool
        Whether its inertia is that of a lattice of few even panels, which is some per cent too heavy.
    hits : bool
        Whether the test is of raw hits; if not, of identified modes, in a table.
    kind : {"plate", "beam"}
        What the study models it as.
    """

    aspect: tuple[float, float] = (0.7, 3.0)
    clamped: bool = True
    wall: bool = True
    tank: bool = False
    stated: bool = False
    baseline: bool = False
    soft: bool = False
    oil: bool = False
    even: bool = False
    hits: bool = False
    kind: str = "plate"


@dataclass(frozen=True, eq=False)
class Specimen:
    """A plate as it is and as it is stated, where it is hit, and its damping."""

    nominal: Plate
    true: Plate
    points: Array
    water: Water
    density: float
    viscosity: float
    alpha: float
    beta: float
    damping: Array = field(default_factory=lambda: np.ones(0))


def in_water(scene: Scene) -> Make:
    """Return a case."""

    def make(rng: np.random.Generator, folder: Path) -> Trial:
        one = _drawn(rng, scene)
        wet, dry = _wet(one, scene), _dry(one)
        bands = {"test": _measure(rng, one, wet, folder / "wet", hits=scene.hits)}
        if scene.baseline:
            bands["baseline"] = _measure(rng, one, dry, folder / "dry", hits=scene.hits)
        (folder / "study.toml").write_text(_study(scene, one, bands), encoding="utf-8")
        return Trial(folder / "study.toml", _causes(scene, one))

    return make


def _causes(scene: Scene, one: Specimen) -> tuple[Cause, ...]:
    causes = [Cause(("fluid_added_mass",), {"fluid_density": one.density})]
    if scene.soft and not scene.baseline:
        causes.append(Cause(("clamp_rotation",), {"stiffness": one.true.rotation}))
    if scene.oil:
        causes.append(Cause(("fluid_damping",), {}))
    return tuple(causes)


def _drawn(rng: np.random.Generator, scene: Scene) -> Specimen:
    width = float(rng.uniform(0.03, 0.05) if scene.kind == "beam" else rng.uniform(0.12, 0.3))
    length = round(width * float(rng.uniform(*scene.aspect)), 4)
    width, thickness = round(width, 4), round(width * float(rng.uniform(0.006, 0.014)), 5)
    if scene.kind == "beam":
        thickness = round(width * float(rng.uniform(0.05, 0.12)), 5)
    E, density, poisson = METALS[int(rng.integers(2))]
    orders = (16, 4) if scene.kind == "beam" else (14, 11)
    mass = round(0.003 * density * length * width * thickness, 5)
    nominal = Plate(length, width, thickness, E, density, poisson, scene.clamped, orders=orders)
    nominal = replace(nominal, sensor=(length, width / 2 if scene.kind == "beam" else width, mass))
    off = {name: 1 + doubt * float(rng.standard_normal()) for name, doubt in DOUBTS.items()}
    true = replace(nominal, **{name: getattr(nominal, name) * factor for name, factor in off.items()})
    rigidity = E * thickness**3 / 12 / (1 - poisson**2)
    if scene.soft:
        true = replace(true, rotation=float(np.exp(rng.uniform(np.log(10), np.log(40)))) * rigidity / length)
    water = _around(rng, scene, length, width)
    liquid = (
        (float(rng.uniform(850, 900)), float(rng.uniform(0.05, 0.2))) if scene.oil else (DENSITY, VISCOSITY)
    )
    first, last = nominal.modes(MODES)[0][[0, -1]] * 2 * np.pi
    ratios = np.array([rng.uniform(0.003, 0.008), rng.uniform(0.001, 0.003)])
    solved = np.linalg.solve(0.5 * np.array([[1 / first, first], [1 / last, last]]), ratios)
    scatter = np.exp(0.1 * rng.standard_normal(BASIS))
    alpha, beta = float(solved[0]), float(max(solved[1], 0.0))
    return Specimen(nominal, true, _points(nominal, scene), water, *liquid, alpha, beta, scatter)


def _points(plate: Plate, scene: Scene) -> Array:
    x = plate.length * (np.arange(1, 6) / 5 if plate.clamped else np.arange(6) / 5)
    if scene.kind == "beam":
        x = plate.length * (np.arange(1, 9) / 8 if plate.clamped else np.arange(9) / 8)
        return np.stack([x, np.full(len(x), plate.width / 2)], axis=1)
    y = plate.width * np.arange(4) / 3
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)


def _around(rng: np.random.Generator, scene: Scene, length: float, width: float) -> Water:
    low = 0.0 if scene.wall and scene.clamped else -FAR
    if not scene.tank:
        return Water(walls=(low, FAR, -FAR, FAR))
    side, surface = width * rng.uniform(0.5, 1.5, 3), float(rng.uniform(0.4, 1.5)) * width
    start = low if np.isfinite(low) else -float(side[0])
    walls = tuple(round(float(w), 4) for w in (start, length + side[0], -side[1], width + side[2]))
    return Water(round(surface, 4), walls=walls)  # type: ignore[arg-type]


def _inertia(one: Specimen, scene: Scene, dry: Array) -> Array:
    """Return the added mass between dry modes [kg]: two lattices, whose errors of second order drop out."""
    plate, wall = one.true, one.water.walls[0] == 0.0
    count = 5 if scene.kind == "beam" else 8
    along = int(np.clip(round(count * np.sqrt(plate.length / plate.width) * (1.4 if wall else 1.2)), 8, 28))

    def moved(points: Array) -> Array:
        return plate.basis(points) @ dry

    sizes = ((2 * along, 2 * count),) if scene.even else ((along, count), (2 * along, 2 * count))
    lattices = (rectangle(plate.length, plate.width, *n, wall=wall, even=scene.even) for n in sizes)
    found = [lattice.added_mass(moved, one.water) for lattice in lattices]
    return np.asarray(one.density * (found[0] if scene.even else (4 * found[1] - found[0]) / 3))


Modes = tuple[Array, Array, Array]
"""Frequencies [Hz], damping ratios [-], coefficients of the shapes."""


def _own_damping(one: Specimen, hertz: Array, share: Array | float) -> Array:
    omega = 2 * np.pi * hertz
    return np.asarray(0.5 * (one.alpha * share / omega + one.beta * omega) * one.damping[: len(hertz)])


def _dry(one: Specimen) -> Modes:
    hertz, vectors = one.true.modes(MODES + 2)
    return hertz, _own_damping(one, hertz, 1.0), vectors


def _wet(one: Specimen, scene: Scene) -> Modes:
    """Return the modes in the liquid, whose layer drags as along a strip (Maali et al., J. Appl. Phys. 97, 2005)."""
    plate = one.true
    dry = plate.all_modes(BASIS)
    added = _inertia(one, scene, dry)
    hertz, vectors = plate.wet_modes(MODES + 2, added, dry)
    own = np.einsum(
        "pr,pq,qr->r", vectors, plate.matrices[1], vectors
    )  # the structure's share of the modal mass
    layer = np.sqrt(2 * one.viscosity / one.density / (2 * np.pi * hertz))
    drag = 3.80 * layer / min(plate.length, plate.width) * (1 - own)
    damping = _own_damping(one, hertz, own) + 0.5 * drag
    return hertz / np.sqrt(1 + drag), damping, vectors / np.sqrt(1 + drag)


def _measure(
    rng: np.random.Generator, one: Specimen, modes: Modes, path: Path, *, hits: bool
) -> tuple[float, float]:
    """Test it; write the hits, or a table of modes, and return the band [Hz]."""
    hertz, damping, vectors = modes
    hertz = hertz * (1 + REPEATABILITY * rng.standard_normal(len(hertz)))
    band = 0.4 * float(hertz[0]), float(np.sqrt(hertz[MODES - 1] * hertz[MODES]))
    stretch = [one.true.length / one.nominal.length, one.true.width / one.nominal.width]
    shapes = one.true.basis(one.points * stretch) @ vectors
    nodes = tuple(range(1, len(one.points) + 1))
    geometry = Geometry(nodes, np.column_stack([one.points, np.zeros(len(nodes))]))
    write = _write_hits if hits else _write_modes
    write(rng, (hertz, damping, shapes), geometry, band[1], path)
    return band


def _write_modes(rng: np.random.Generator, modes: Modes, geometry: Geometry, last: float, path: Path) -> None:
    hertz, damping, shapes = (values[..., :MODES] for values in modes)
    sigma = SHAPE_NOISE * np.sqrt(np.mean(shapes**2, axis=0)) * np.ones_like(shapes)
    level = 1 + CALIBRATION * float(rng.standard_normal())
    data = ModalData(
        hertz, 1e-4 * hertz, damping * (1 + 0.03 * rng.standard_normal(MODES)), 0.03 * damping,
        tuple(Dof(node, 3) for node in geometry.nodes),
        (np.sqrt(level) * shapes + sigma * rng.standard_normal(shapes.shape)).astype(complex),
        sigma, scaled=True, geometry=geometry,
    )  # fmt: skip
    path.with_suffix(".csv").write_text(modes_csv(data), encoding="utf-8")


def _write_hits(rng: np.random.Generator, modes: Modes, geometry: Geometry, last: float, path: Path) -> None:
    hertz, damping, shapes = modes
    dofs = tuple(Dof(node, 3) for node in geometry.nodes)
    system = modal_system(
        frequency=hertz, damping=damping, response_shapes=shapes[-1:], point_shapes=shapes,
        responses=dofs[-1:], points=dofs,
    )  # fmt: skip
    rate = float(np.ceil(3.2 * last))
    slowest = float(np.min(2 * np.pi * hertz * damping))
    samples = int(np.clip(2 ** np.ceil(np.log2(6 * rate / slowest)), 4096, 32768))
    plan = HammerPlan(
        rate=rate, samples=samples, hits=4, width=1 / last, pre_trigger=64 / rate, force_noise=0.1,
        response_noise=1e-3, gain=1 + CALIBRATION * float(rng.standard_normal()),
    )  # fmt: skip
    test = hammer_test(system, plan, rng=rng, geometry=geometry)
    write_uff(path.with_suffix(".uff"), tests=[test], geometry=geometry, title="in water", precision="single")


def _study(scene: Scene, one: Specimen, bands: Mapping[str, tuple[float, float]]) -> str:
    plate = one.nominal
    beam = scene.kind == "beam"
    tables: dict[str, dict[str, Any]] = {
        f"[{name}]": {
            **_data(scene, {"test": "wet", "baseline": "dry"}[name]), "band": list(band),
            "calibration": CALIBRATION, "repeatability": REPEATABILITY, "position_sigma": 0.0005,
        }
        for name, band in bands.items()
    }  # fmt: skip
    if beam:
        for table in tables.values():
            table["axes"] = "{ origin = [0.0, %r, 0.0], x = [1.0, 0.0, 0.0], y = [0.0, 1.0, 0.0] }" % (
                plate.width / 2
            )
    elements = 40 if beam else [int(np.clip(round(16 * plate.length / plate.width), 16, 40)), 16]
    tables["[model]"] = {
        "type": scene.kind, "length": plate.length, "width": plate.width, "thickness": plate.thickness,
        "elements": elements, "clamped": ["x0"] if plate.clamped else [],
        "theory": "euler-bernoulli" if beam else "kirchhoff",
    }  # fmt: skip
    tables["[model.material]"] = {"E": plate.E, "density": plate.density, "poisson": plate.poisson}
    tables["[model.damping]"] = {"alpha": one.alpha, "beta": one.beta}
    place = list(plate.sensor[:1] if beam else plate.sensor[:2])
    tables["[[model.mass]]"] = {"at": place, "mass": plate.sensor[2]}
    tables["[tolerances]"] = {**DOUBTS, "damping": 0.3}
    if scene.stated:
        tables["[environment]"] = _environment(one)
    lines = ['title = "In water"']
    for head, entries in tables.items():
        lines += [head, *(f"{key} = {_toml(value)}" for key, value in entries.items())]
    return "\n".join(lines) + "\n"


def _data(scene: Scene, name: str) -> dict[str, Any]:
    return {"files": [f"{name}.uff"]} if scene.hits else {"modes": f"{name}.csv"}


def _environment(one: Specimen) -> dict[str, Any]:
    known: dict[str, Any] = {"fluid_density": one.density, "walls": list(one.water.walls)}
    far = 10 * max(one.nominal.length, one.nominal.width)
    for name, value in (("free_surface", one.water.surface), ("bottom", one.water.bottom)):
        known[name] = value if np.isfinite(value) else far
    return known


def _toml(value: object) -> str:
    if isinstance(value, str):
        return value if value.startswith("{") else f'"{value}"'
    if isinstance(value, Sequence):
        return "[" + ", ".join(_toml(one) for one in value) + "]"
    return repr(float(value)) if isinstance(value, float) else repr(value)
