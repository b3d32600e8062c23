"""Added mass of a cantilever plate beside its clamp's wall, by the limit of lattices; thick strips that roll."""

from __future__ import annotations

import numpy as np
import pytest

from updating.fluid import FluidDomain, added_mass, heave_coefficient, quadrature_grid

LENGTH, WIDTH, INF = 1.88, 1.0, float("inf")
SIZES = ((12, 9), (24, 18), (48, 36))


def modes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """First and second bending, first and second twist, and bending across, as of a cantilever."""
    u, v = np.meshgrid(x / LENGTH, y / WIDTH, indexing="ij")
    bend, again = u**2 * (6 - 4 * u + u**2) / 3, np.sin(0.5 * np.pi * u) * np.sin(1.5 * np.pi * u)
    twist = np.sin(0.5 * np.pi * u) * (2 * v - 1), np.sin(1.5 * np.pi * u) * (2 * v - 1)
    return np.stack([bend, again, *twist, u * (6 * v**2 - 6 * v + 1)])


def velocity(x: np.ndarray, edge_x: np.ndarray, y: np.ndarray, edge_y: np.ndarray, z: float) -> np.ndarray:
    """Normal velocity of rectangles of unit jump in a plane z away."""
    dx, dy = (x[:, None] - edge_x)[:, None, :, None], (y[:, None] - edge_y)[None, :, None, :]
    square = dx**2 + dy**2 + z**2
    corner = dx * dy * (square + z**2) / ((dx**2 + z**2) * (dy**2 + z**2) * np.sqrt(square))
    return (np.diff(np.diff(corner, axis=2), axis=3) / (4 * np.pi)).reshape(len(x) * len(y), -1)


def lattice(along: int, across: int, planes: dict[float, float], *, wall: bool) -> np.ndarray:
    edge_x, edge_y = np.linspace(0, LENGTH, along + 1), np.linspace(0, WIDTH, across + 1)
    x, y = (edge_x[1:] + edge_x[:-1]) / 2, (edge_y[1:] + edge_y[:-1]) / 2
    influence = np.zeros((along * across,) * 2)
    for z, sign in planes.items():
        for mirrored in (x, -x)[: 1 + wall]:
            influence += sign * velocity(mirrored, edge_x, y, edge_y, z)
    moved = modes(x, y).reshape(5, -1)
    return (
        np.abs(np.sum(moved * np.linalg.solve(influence, moved.T).T, axis=1))
        * LENGTH
        / along
        * WIDTH
        / across
    )


def limit(planes: dict[float, float], *, wall: bool) -> np.ndarray:
    """What lattices each twice as fine as the last tend to: errors of first and second order drop out."""
    first, second, third = (lattice(*size, planes, wall=wall) for size in SIZES)
    return (4 * (2 * third - second) - (2 * second - first)) / 3


@pytest.mark.long
@pytest.mark.parametrize("wall", [True, False])
@pytest.mark.parametrize(
    ("around", "planes"),
    [
        ({}, {0.0: 1.0}),
        ({"free_surface": 0.4}, {0.0: 1.0, 0.8: 1.0}),
        ({"bottom": 0.4}, {0.0: 1.0, 0.8: -1.0}),
    ],
)
def test_each_mode_is_that_of_the_limit_of_lattices(
    around: dict[str, float], planes: dict[float, float], wall: bool
) -> None:
    """To 0.5 %, where the finest lattice itself is 3 to 6 % too heavy."""
    x, y = quadrature_grid(LENGTH, WIDTH, 20)
    domain = FluidDomain(**around, walls=(0.0, INF, -INF, INF) if wall else None)
    found = np.diag(added_mass(modes(x, y), x, y, length=LENGTH, width=WIDTH, domain=domain))
    np.testing.assert_allclose(limit(planes, wall=wall), found, rtol=5e-3)


def by_boundary(thickness: float, panels: int) -> float:
    """Added mass of a rectangle of unit breadth whose faces roll, over pi/128, by constant boundary elements."""
    even = np.linspace(0.0, 1.0, panels + 1)
    graded = even**3 / (even**3 + (1 - even) ** 3)
    wide, high = graded - 0.5, thickness * (graded - 0.5)
    top, right = np.full_like(wide, thickness / 2), np.full_like(high, 0.5)
    sides = [np.stack(pair) for pair in ((right, high), (-wide, top), (-right, -high), (wide, -top))]
    start, end = (np.concatenate([s[:, part] for s in sides], axis=1) for part in (np.s_[:-1], np.s_[1:]))
    middle, size = (start + end) / 2, np.hypot(*(end - start))
    tangent = (end - start) / size
    normal = np.stack([tangent[1], -tangent[0]])
    away = middle[:, :, None] - start[:, None, :]
    along, off = np.einsum("dij,dj->ij", away, tangent), np.einsum("dij,dj->ij", away, normal)
    off[np.abs(off) < 1e-14] = 0.0
    rest = size - along
    angle = np.arctan2(along, np.abs(off)) + np.arctan2(rest, np.abs(off))
    logarithm = along * np.log(np.hypot(along, off)) + rest * np.log(np.hypot(rest, off))
    speed = normal[1] * middle[0]
    single = (logarithm - size + np.abs(off) * angle) @ speed
    potential = np.linalg.solve(np.pi * np.eye(len(size)) - np.sign(off) * angle, single)
    return float(-np.sum(potential * speed * size) / (np.pi / 128))


@pytest.mark.parametrize("ratio", [0.0159, 0.05])
def test_a_thick_strip_is_as_heavy_as_its_rectangle_where_it_rolls_and_where_it_heaves(ratio: float) -> None:
    """To a twentieth of what the thickness adds."""
    x, y = quadrature_grid(1.0, 1.0, 24)
    shapes = np.stack([np.ones((24, 24)), np.broadcast_to(y - 0.5, (24, 24))])
    domain = FluidDomain(walls=(0.0, 1.0, -INF, INF))
    found = np.diag(added_mass(shapes, x, y, length=1.0, width=1.0, thickness=ratio, domain=domain))
    coarse, fine = (by_boundary(ratio, panels) for panels in (60, 120))
    exact = np.array([heave_coefficient(ratio), (4 * fine - coarse) / 3])
    relative = found / np.array([np.pi / 4, np.pi / 128])
    np.testing.assert_allclose(relative, exact, atol=0.05 * (exact[1] - 1))
