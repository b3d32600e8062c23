"""Thin plates in water by mode: the effect `fluid_added_mass` beside vortex rings and Ritz's method (``water``).

    python benchmarks/bench_water_plates.py           all; 4 minutes
    python benchmarks/bench_water_plates.py --only cantilever free   some of the tables

First the lattice by itself: a disc, a strip and rigid rectangles, beside what is published. Then plates of four aspect
ratios: of each mode how far the effect's added mass, and its frequency in water over that in air, are from the
lattice's. The two share neither the elastic plate, nor the flow, nor a line of code. Of two lattices, the second
twice as fine, errors of second order drop out. Last, what the effect does not hold, by how much it is off.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from water.rings import FAR, Water, disc, limit, rectangle
from water.ritz import Plate

from updating import Environment, Material, Measured, Predictor, Spec
from updating.effects.structure.fluid import FluidAddedMass
from updating.models.state import State

Array = NDArray[np.float64]
WATER, MODES, BASIS, WIDTH = 998.0, 8, 26, 0.2
THIN = 2e-5
"""Thickness over width, so that the plate has none for the water; density and modulus make up for it [-]."""

RECTANGLES = {1.0: 0.579, 1.25: 0.642, 2.0: 0.757, 2.5: 0.801, 4.0: 0.872, 10.0: 0.947}
"""Added mass of rigid rectangles over rho pi/4 b^2 l, by l/b (DNV-RP-C205, 2010, table D-2, after experiments) [-]."""

SHALLOW = 0.25
"""Distance of a near surface or bottom, over the width [-]."""


@dataclass(frozen=True)
class Setting:
    """What surrounds a plate, for the lattice and for the effect."""

    name: str
    water: Water
    around: Environment
    clamped: bool = True

    @property
    def wall(self) -> bool:
        """Whether the edge x = 0 touches a wall."""
        return self.water.walls[0] == 0.0


def setting(name: str, water: Water, *, clamped: bool = True, stated: bool = True) -> Setting:
    """Return a setting; where it is not ``stated``, the effect has no walls but that of the clamp."""
    known = {"free_surface": water.surface, "bottom": water.bottom} if stated else {}
    far = {key: value for key, value in known.items() if np.isfinite(value)}
    walls = water.walls if stated else None
    if walls is not None and not np.isfinite(walls[1]):
        walls = (walls[0], FAR, -FAR, FAR)
    return Setting(name, water, Environment(walls=walls, **far), clamped)


def settings(part: str, length: float) -> tuple[Setting, ...]:
    """Return the settings of a table for a plate of a length [m]."""
    wall, near = (0.0, FAR, -FAR, FAR), SHALLOW * WIDTH
    if part == "cantilever":
        return (
            setting("cantilever, wall at the clamp", Water(walls=wall)),
            setting("cantilever, water all round", Water()),
            setting("wall, surface near", Water(surface=near, walls=wall)),
            setting("wall, bottom near", Water(bottom=near, walls=wall)),
        )
    if part == "free":
        return (
            setting("free", Water(), clamped=False),
            setting("free, surface near", Water(surface=near), clamped=False),
            setting("free, bottom near", Water(bottom=near), clamped=False),
        )
    tanks = {far: (0.0, length + far * WIDTH, -far * WIDTH, (1 + far) * WIDTH) for far in (0.5, 1.0, 3.0)}
    if part == "tank":
        return tuple(setting(f"tank, {far} widths away", Water(walls=tank)) for far, tank in tanks.items())
    return (
        *(setting(f"tank not stated, {f} widths", Water(walls=t), stated=False) for f, t in tanks.items()),
        setting("no wall, effect with one", Water(), stated=False),
        setting("upright, its side in the surface", Water(walls=wall, upright=WIDTH * 1.001), stated=False),
        setting("upright, surface half a width off", Water(walls=wall, upright=1.5 * WIDTH), stated=False),
    )


def specimen(length: float, *, clamped: bool) -> Plate:
    """Return a plate as light and stiff as one of steel with t/b = 0.01, but of no thickness to speak of."""
    heavier = 0.01 / THIN
    orders = (14, 12) if length >= WIDTH else (12, 14)
    return Plate(length, WIDTH, THIN * WIDTH, 210e9 * heavier**3, 7850 * heavier, 0.3, clamped, orders=orders)


def by_rings(plate: Plate, one: Setting) -> tuple[Array, Array]:
    """Return added-mass ratios of the dry modes, and wet over dry frequencies, by the lattice (MODES,) [-]."""
    dry = plate.all_modes(BASIS)
    size = np.sqrt(plate.length / plate.width)
    sizes = (8, 16) if np.isfinite(one.water.walls[1]) else (10, 20)
    counts = [(int(np.ceil(c * size * (1.4 if one.wall else 1.2))), int(np.ceil(c / size))) for c in sizes]

    def moved(points: Array) -> Array:
        return plate.basis(points) @ dry

    coarse, fine = (
        rectangle(plate.length, plate.width, *n, wall=one.wall).added_mass(moved, one.water) for n in counts
    )
    added = WATER * (4 * fine - coarse) / 3
    wet, _ = plate.wet_modes(MODES, added, dry)
    kept = slice(plate.rigid, plate.rigid + MODES)
    return np.diag(added)[kept], wet / plate.modes(MODES)[0]


def by_effect(plate: Plate, one: Setting) -> tuple[Array, Array]:
    """Return the same by the library: its own elements, its own flow."""
    elements = [int(np.clip(round(20 * side / WIDTH), 16, 40)) for side in (plate.length, plate.width)]
    spec = Spec(
        "plate",
        length=plate.length,
        width=plate.width,
        thickness=plate.thickness,
        elements=(elements[0], elements[1]),
        clamped=("x0",) if plate.clamped else (),
        theory="kirchhoff",
        material=Material(plate.E, plate.density, plate.poisson),
    )
    unit, place = np.ones((1, 1)), np.array([[plate.length, plate.width]])
    nothing = Measured(
        frequency=np.array([100.0]),
        frequency_sigma=np.array([0.1]),
        damping=np.array([0.01]),
        damping_sigma=np.array([0.001]),
        points=place,
        nodes=(1,),
        seen=np.zeros(1, dtype=int),
        hit=np.zeros(1, dtype=int),
        constants=unit,
        constants_sigma=unit,
        absolute=True,
    )
    model = Predictor(spec, nothing, one.around)
    state = FluidAddedMass().state(model, {"fluid_density": WATER})
    dry, wet = model.predict(State(), count=MODES), model.predict(state, count=MODES)
    (mass,) = state.mass
    basis = model.reduced.eigen(model.base)[1][:, plate.rigid : plate.rigid + MODES]
    mass = mass[: len(basis), : len(basis)]
    return np.einsum("ir,ij,jr->r", basis, mass, basis), wet.frequency / dry.frequency


def compare(length: float, one: Setting, *, held: bool) -> None:
    """Print the row of one plate in one setting, by mode where the effect does not hold the setting."""
    plate = specimen(length, clamped=one.clamped)
    (mass, ratio), (theirs, wet) = by_effect(plate, one), by_rings(plate, one)
    off = 100 * np.stack([mass / theirs - 1, ratio / wet - 1])
    name = f"{one.name}, l/b = {length / WIDTH:g}"
    if held:
        worst = np.abs(off).max(axis=1)
        print(
            f"{name:46s}" + "".join(f"{v:6.2f}" for v in theirs) + "".join(f"{v:8.2f}" for v in worst),
            flush=True,
        )
        return
    print(f"{name:46s}" + "".join(f"{v:6.2f}" for v in theirs))
    for row, values in zip(("added mass", "frequency"), off, strict=True):
        print(
            f"   effect over lattice, {row + ' [%]':22s}" + "".join(f"{v:6.1f}" for v in values), flush=True
        )


def rigid(make: Callable[[int], Array]) -> Array:
    """Return what lattices of 8, 16 and 32 panels tend to."""
    return limit(*(make(count) for count in (6, 12, 24)))


def published() -> None:
    """Print the lattice beside values in closed form, and published ones."""

    def heave(points: Array) -> Array:
        return np.ones((len(points), 1))

    def of_rectangle(ratio: float) -> Callable[[int], Array]:
        return lambda n: rectangle(ratio, 1.0, int(n * np.ceil(np.sqrt(ratio))), n).added_mass(heave)

    between = Water(walls=(0.0, 1.0, -FAR, FAR))
    rows = [("disc, 8/3 rho a^3", 8 / 3, rigid(lambda n: disc(1.0, n, 3 * n).added_mass(heave)))]
    strip = rigid(lambda n: rectangle(1.0, 1.0, n, n, wall=True).added_mass(heave, between))
    rows.append(("strip between walls, rho pi a^2", np.pi / 4, strip))
    for ratio, value in RECTANGLES.items():
        whole = value * np.pi / 4 * ratio
        rows.append((f"rectangle {ratio:g} : 1, {value} rho pi/4 b^2 l", whole, rigid(of_rectangle(ratio))))
    print("rigid, broadside: lattice over published - 1 [%]")
    for name, value, found in rows:
        print(f"   {name:45s}{100 * (float(found[0, 0]) / value - 1):8.3f}", flush=True)


def main() -> None:
    """Print the tables asked for."""
    parts = ("published", "cantilever", "free", "tank", "not_held")
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=parts, default=parts)
    for part in parser.parse_args().only:
        if part == "published":
            published()
            continue
        held = part != "not_held"
        last = "; then the largest difference of the effect's [%]: added mass, frequency" if held else ""
        print(f"\n{part}: added mass over own, modes 1 to {MODES}{last}")
        for ratio in (1.0, 2.0) if part in ("tank", "not_held") else (0.5, 1.0, 2.0, 4.0):
            for one in settings(part, ratio * WIDTH):
                compare(ratio * WIDTH, one, held=held)


if __name__ == "__main__":
    main()
