"""Decks of bricks: a body is what one leaves of a grid of blocks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise, product

Lines = tuple[Sequence[float], Sequence[float], Sequence[float]]
Corner = tuple[int, int, int]

CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
MIDDLES = (
    (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
    (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1),
)  # fmt: skip
"""Nodes of a brick on a grid of half steps, in CalculiX's order."""


def brick_deck(
    lines: Lines,
    part: Callable[[float, float, float], str | None],
    sets: Mapping[str, Callable[[float, float, float], bool]],
    kind: str = "C3D20R",
) -> list[str]:
    """Return the cards of nodes, elements and node sets.

    Parameters
    ----------
    lines : three sequences of float
        Where the blocks end along x, y and z.
    part : callable
        Takes the middle of a block to the element set it is in, None for a hole.
    sets : mapping of str to callable
        Node sets: which places are in each.
    kind : str
        C3D20R or C3D20 (20 nodes), C3D8I or C3D8 (8 nodes).
    """
    steps = CORNERS + (MIDDLES if "20" in kind else ())
    halves = [[a[0], *(c for lo, hi in pairwise(a) for c in ((lo + hi) / 2, hi))] for a in lines]
    number: dict[Corner, int] = {}
    elements: dict[str, list[list[int]]] = {}
    for i, j, k in product(*(range(len(a) - 1) for a in lines)):
        low = (2 * i, 2 * j, 2 * k)
        name = part(*(halves[a][low[a] + 1] for a in range(3)))
        if name is not None:
            nodes = [(low[0] + di, low[1] + dj, low[2] + dk) for di, dj, dk in steps]
            elements.setdefault(name, []).append([number.setdefault(n, len(number) + 1) for n in nodes])
    places = {n: tuple(halves[a][step[a]] for a in range(3)) for step, n in number.items()}
    deck = ["*NODE, NSET=ALL", *(f"{n}, {x:.9g}, {y:.9g}, {z:.9g}" for n, (x, y, z) in places.items())]
    first = 1
    for name, rows in elements.items():
        deck.append(f"*ELEMENT, TYPE={kind}, ELSET={name}")
        for row in rows:
            words = [str(n) for n in (first, *row)]
            first += 1
            deck += [", ".join(words[:11]) + ("," if len(words) > 11 else "")]
            deck += [", ".join(words[11:])] if len(words) > 11 else []
    for name, inside in sets.items():
        deck += [f"*NSET, NSET={name}", *(f"{n}," for n, at in places.items() if inside(*at))]
    return deck
