"""Decks of 8-node shells on a grid that is bent, tapered and pierced as one likes."""

from __future__ import annotations

from collections.abc import Callable, Mapping

Place = tuple[float, float, float]


def shell_deck(
    size: tuple[int, int],
    place: Callable[[float, float], Place],
    region: Callable[[float, float], str | None],
    materials: Mapping[str, tuple[float, float, float]],
    thickness: float,
) -> list[str]:
    """Return the lines of a deck without steps, clamped along the first edge.

    Parameters
    ----------
    size : tuple of int
        Number of elements along both sides of the grid.
    place : callable
        Takes the two coordinates of the grid, each from 0 to 1, to x, y and z [m].
    region : callable
        Takes the middle of an element on the grid to the name of its region, None for a hole.
    materials : mapping
        Modulus [Pa], Poisson's ratio [-] and density [kg/m^3] of every region.
    thickness : float
        Thickness of the shell [m].
    """
    nx, ny = size
    elements: dict[str, list[tuple[int, ...]]] = {name: [] for name in materials}
    used: dict[tuple[int, int], int] = {}
    for i in range(nx):
        for j in range(ny):
            name = region((i + 0.5) / nx, (j + 0.5) / ny)
            if name is not None:
                elements[name].append(
                    tuple(used.setdefault(c, len(used) + 1) for c in _corners(2 * i, 2 * j))
                )
    lines = ["*NODE, NSET=ALL"]
    for (i, j), node in used.items():
        x, y, z = place(i / (2 * nx), j / (2 * ny))
        lines.append(f"{node}, {x:.9g}, {y:.9g}, {z:.9g}")
    number = 0
    for name, rows in elements.items():
        lines.append(f"*ELEMENT, TYPE=S8R, ELSET={name}")
        for row in rows:
            number += 1
            lines.append(", ".join(map(str, (number, *row))))
    for name, (modulus, poisson, density) in materials.items():
        lines += [
            f"*MATERIAL, NAME={name}",
            "*ELASTIC",
            f"{modulus:.6g}, {poisson}",
            "*DENSITY",
            f"{density:.6g}",
        ]
        lines += [f"*SHELL SECTION, ELSET={name}, MATERIAL={name}", f"{thickness}"]
    lines += ["*NSET, NSET=CLAMP", *(f"{node}," for (i, _), node in used.items() if i == 0)]
    return [*lines, "*BOUNDARY", "CLAMP, 1, 6"]


def _corners(a: int, b: int) -> tuple[tuple[int, int], ...]:
    """Return the grid places of an element's corners, then of its sides' middles."""
    return (
        (a, b), (a + 2, b), (a + 2, b + 2), (a, b + 2),
        (a + 1, b), (a + 2, b + 1), (a + 1, b + 2), (a, b + 1),
    )  # fmt: skip
