"""The added mass of a cantilever plate beside its clamp's wall, mode by mode, beside a lattice of doublet panels.

    python benchmarks/bench_fluid_plate.py            paper A's plate: wall, surface, bottom, thickness
    python benchmarks/bench_fluid_plate.py --coarse   lattices of half the size, in seconds

The panels are rectangles of constant jump of the potential, evenly spaced, with collocation in their middles; a panel's
velocity at a distance z from its plane is xy (x^2 + y^2 + 2 z^2) / (4 pi (x^2 + z^2) (y^2 + z^2) r) at its corners, the
derivative of the solid angle. Mirrored panels make the wall; others above and below the free surface and the bottom. Of
three lattices, each twice as fine as the last, the limit is taken (Richardson 1911: errors of first and second order).
The thickness is checked where there is an independent answer: of a strip that heaves in closed form, of one that rolls
by boundary elements round the rectangle.
"""

from __future__ import annotations

import argparse

import numpy as np
from numpy.typing import NDArray

from modalkit.simulator.bodies.plate.panel import wetted
from updating import Material, Measured, Predictor, Spec
from updating.fluid import FluidDomain, added_mass, heave_coefficient, quadrature_grid

LENGTH, WIDTH, THICKNESS, MODES = 0.376, 0.2, 0.003175, 12
FAR = np.inf
Array = NDArray[np.float64]


def plate() -> Predictor:
    """Return paper A's plate, dry."""
    spec = Spec(
        "plate",
        length=LENGTH,
        width=WIDTH,
        thickness=THICKNESS,
        elements=(38, 20),
        clamped=("x0",),
        theory="kirchhoff",
        material=Material(210e9, 7850.0, 0.3),
    )
    one, points = np.ones((1, 1)), np.array([[LENGTH, WIDTH]])
    nothing = Measured(
        frequency=np.array([100.0]),
        frequency_sigma=np.array([0.1]),
        damping=np.array([0.01]),
        damping_sigma=np.array([0.001]),
        points=points,
        nodes=(1,),
        seen=np.zeros(1, dtype=int),
        hit=np.zeros(1, dtype=int),
        constants=one,
        constants_sigma=one,
        absolute=True,
    )
    return Predictor(spec, nothing)


def shapes(model: Predictor, x: Array, y: Array) -> Array:
    """Return the lowest modes at a grid, (MODES, nx, ny)."""
    vectors = model.predict(count=MODES).vectors
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    rows = model.reduced.rows(points)["w"][:, : len(vectors)]
    return np.asarray((rows @ vectors).T.reshape(MODES, len(x), len(y)))


def effect(model: Predictor, thickness: float = 0.0, *, wall: bool = True, **around: float) -> Array:
    """Return the added mass of each mode as the effect has it [m^3]."""
    walls = (0.0, FAR, -FAR, FAR) if wall else None
    x, y = quadrature_grid(LENGTH, WIDTH, 24)
    domain = FluidDomain(around.get("surface"), around.get("bottom"), walls)
    found = added_mass(
        shapes(model, x, y), x, y, length=LENGTH, width=WIDTH, thickness=thickness, domain=domain
    )
    return np.diag(found)


def velocity(x: Array, edge_x: Array, y: Array, edge_y: Array, z: float) -> Array:
    """Return the normal velocity at a grid of points of panels of unit jump in a plane z away, (n, n) [1/m]."""
    dx, dy = (x[:, None] - edge_x)[:, None, :, None], (y[:, None] - edge_y)[None, :, None, :]
    square = dx**2 + dy**2 + z**2
    corner = dx * dy * (square + z**2) / ((dx**2 + z**2) * (dy**2 + z**2) * np.sqrt(square))
    panels = np.diff(np.diff(corner, axis=2), axis=3) / (4 * np.pi)
    return np.asarray(panels.reshape(len(x) * len(y), -1))


def lattice(model: Predictor, along: int, across: int, *, surface: float = FAR, bottom: float = FAR) -> Array:
    """Return the added mass of each mode of a thin plate, by panels, a wall at its clamp [m^3]."""
    edge_x, edge_y = np.linspace(0, LENGTH, along + 1), np.linspace(0, WIDTH, across + 1)
    x, y = (edge_x[1:] + edge_x[:-1]) / 2, (edge_y[1:] + edge_y[:-1]) / 2
    planes = {0.0: 1.0}
    if np.isfinite(surface):
        planes[2 * surface] = 1.0
    if np.isfinite(bottom):
        planes[2 * bottom] = -1.0
    influence = np.zeros((along * across,) * 2)
    for z, sign in planes.items():
        influence += sign * (velocity(x, edge_x, y, edge_y, z) + velocity(-x, edge_x, y, edge_y, z))
    moved = shapes(model, x, y).reshape(MODES, -1)
    jump = np.linalg.solve(influence, moved.T)
    return np.abs(np.sum(moved * jump.T, axis=1)) * LENGTH / along * WIDTH / across


def limit(model: Predictor, sizes: tuple[tuple[int, int], ...], **around: float) -> Array:
    """Return what three lattices, each twice as fine as the last, tend to [m^3]."""
    first, second, third = (lattice(model, *size, **around) for size in sizes)
    one, two = 2 * second - first, 2 * third - second
    return np.asarray((4 * two - one) / 3)


def strip(thickness: float, *, rolls: bool) -> float:
    """Return the effect's added mass of a strip of unit width between walls, over that of the flat strip [-]."""
    x, y = quadrature_grid(1.0, 1.0, 24)
    moved = np.broadcast_to(y - 0.5 if rolls else np.ones_like(y), (1, len(x), len(y)))
    domain = FluidDomain(walls=(0.0, 1.0, -FAR, FAR))
    found = added_mass(np.array(moved), x, y, length=1.0, width=1.0, thickness=thickness, domain=domain)
    return float(found[0, 0] / (np.pi / 128 if rolls else np.pi / 4))


def by_boundary(thickness: float, panels: int, *, rolls: bool) -> float:
    """Return the same by boundary elements round the section, whose ends do not move [-].

    The potential is constant on each, the normal velocity as well; elements are short at the corners.
    """
    even = np.linspace(0.0, 1.0, panels + 1)
    graded = even**3 / (even**3 + (1 - even) ** 3)
    wide, high = graded - 0.5, thickness * (graded - 0.5)
    sides = [
        np.stack([np.full_like(high, 0.5), high]), np.stack([-wide, np.full_like(wide, thickness / 2)]),
        np.stack([np.full_like(high, -0.5), -high]), np.stack([wide, np.full_like(wide, -thickness / 2)]),
    ]  # fmt: skip
    start, end = (np.concatenate([s[:, part] for s in sides], axis=1) for part in (np.s_[:-1], np.s_[1:]))
    middle, size = (start + end) / 2, np.hypot(*(end - start))
    tangent = (end - start) / size
    normal = np.stack([tangent[1], -tangent[0]])
    away = middle[:, :, None] - start[:, None, :]
    along, off = np.einsum("dij,dj->ij", away, tangent), np.einsum("dij,dj->ij", away, normal)
    off[np.abs(off) < 1e-14] = 0.0
    rest = size - along
    angle = np.arctan2(along, np.abs(off)) + np.arctan2(rest, np.abs(off))
    single = (
        along * np.log(np.hypot(along, off)) + rest * np.log(np.hypot(rest, off)) - size + np.abs(off) * angle
    )
    speed = normal[1] * (middle[0] if rolls else 1.0)
    potential = np.linalg.solve(np.pi * np.eye(len(size)) - np.sign(off) * angle, single @ speed)
    return float(-np.sum(potential * speed * size) / (np.pi / 128 if rolls else np.pi / 4))


def show(name: str, values: Array) -> None:
    """Print a row of the table."""
    print(f"{name:44s}" + "".join(f"{100 * value:7.2f}" for value in values))


def main() -> None:
    """Print by mode how far the effect is from the panels, and what each part of the idealisation does."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--coarse", action="store_true", help="lattices of half the size")
    sizes = ((10, 6), (20, 12), (40, 24)) if parser.parse_args().coarse else ((20, 12), (40, 24), (80, 48))
    model = plate()
    thin = effect(model)
    print("added mass, thin plate at a wall, over [%]; columns: modes 1 to 12\n")
    for along, across in sizes:
        show(f"panels, {along} x {across}", lattice(model, along, across) / thin - 1)
    show("panels, limit", limit(model, sizes) / thin - 1)
    for around in ({"surface": 0.1}, {"bottom": 0.1}):
        ((side, far),) = around.items()
        tank = effect(model, **around)
        show(f"panels, limit, {side} {far} m away", limit(model, sizes, **around) / tank - 1)
        show(f"what the {side} does", tank / thin - 1)
    show("what no wall does", effect(model, wall=False) / thin - 1)
    thick = effect(model, THICKNESS)
    show("what the thickness does", thick / thin - 1)
    for thickness, own in ((1e-9, thin), (THICKNESS, thick)):
        rig = wetted((0.0, LENGTH), (0.0, WIDTH), thickness, wall=True, panels=(44, 28))
        vectors = model.predict(count=MODES).vectors
        moved = model.reduced.rows(rig.places)["w"][:, : len(vectors)] @ vectors
        show(
            f"second simulator, {1e3 * thickness:.3g} mm",
            np.einsum("ir,ij,jr->r", moved, rig.matrix, moved) / own - 1,
        )
    print(
        "\na strip of thickness t over the flat one [-]\n"
        "   t/b  heave: effect   exact   roll: effect   boundary elements"
    )
    for ratio in (THICKNESS / WIDTH, 0.05, 0.1):
        coarse, fine = (by_boundary(ratio, panels, rolls=True) for panels in (60, 120))
        rolls = (4 * fine - coarse) / 3  # errors of second order drop out
        print(
            f"{ratio:6.4f}{strip(ratio, rolls=False):15.4f}{heave_coefficient(ratio):8.4f}"
            f"{strip(ratio, rolls=True):15.4f}{rolls:20.4f}"
        )


if __name__ == "__main__":
    main()
