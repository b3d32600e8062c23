"""Ribbed plates and brackets as blocks between lines along three axes: what is solid, to which part it belongs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise, product

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from modalkit.simulator.bodies.solid.deck import Bricks

Box = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
"""From where to where along x, y and z [m]."""

NEAR = 1e-9
"""So near to each other two places are one [m]."""


@dataclass(frozen=True)
class Shape:
    """What a body is made of.

    Parameters
    ----------
    parts : tuple of (str, Box, int)
        Name, extent, and which of several bodies it belongs to; parts of one body that touch are welded.
    feet : tuple of (str, Box)
        Flat patches that are held.
    bolts : tuple of (str, Box)
        Flat patches at whose corners two bodies are joined by springs.
    """

    parts: tuple[tuple[str, Box, int], ...]
    feet: tuple[tuple[str, Box], ...]
    bolts: tuple[tuple[str, Box], ...] = ()

    @cached_property
    def breaks(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Where the mesh has lines along each axis [m]."""
        boxes = [*(box for _, box, _ in self.parts), *(box for _, box in (*self.feet, *self.bolts))]
        x, y, z = (_unlike([end for box in boxes for end in box[axis]]) for axis in range(3))
        return x, y, z

    def mesh(self, elements: int) -> Mesh:
        """Return the shape in bricks, so many along its length, and one through what is thin."""
        size = float(np.ptp(self.breaks[0])) / elements
        x, y, z = (_divided(line, size) for line in self.breaks)
        return Mesh(self, x, y, z)


@dataclass(frozen=True, eq=False)
class Mesh:
    """A shape in bricks between lines.

    Parameters
    ----------
    shape : Shape
        What it is made of.
    x, y, z : (n + 1,) arrays
        Lines [m].
    """

    shape: Shape
    x: FloatArray
    y: FloatArray
    z: FloatArray

    @cached_property
    def bricks(self) -> Mapping[str, Bricks]:
        """The bricks of every part."""
        return {name: Bricks(self.x, self.y, self.z, ~self._inside(box)) for name, box, _ in self.shape.parts}

    def _inside(self, box: Box) -> BoolArray:
        chosen = []
        for line, (low, high) in zip((self.x, self.y, self.z), box, strict=True):
            middle = 0.5 * (line[1:] + line[:-1])
            chosen.append((middle > low) & (middle < high))
        return np.multiply.outer(np.multiply.outer(chosen[0], chosen[1]), chosen[2])

    @property
    def count(self) -> int:
        """Numbers that the nodes of one body may have [-]."""
        return int(np.prod([2 * len(line) - 1 for line in (self.x, self.y, self.z)])) + 1

    @cached_property
    def nodes(self) -> tuple[IntArray, FloatArray]:
        """Numbers of the nodes, those of a second body behind the first's, and their places (n, 3) [m]."""
        numbers, places = zip(
            *(
                (own[0] + body * self.count, own[1])
                for (name, _, body) in self.shape.parts
                for own in [self.bricks[name].nodes]
            ),
            strict=True,
        )
        unlike, first = np.unique(np.concatenate(numbers), return_index=True)
        return unlike, np.vstack(places)[first]

    def on(self, box: Box, body: int | None = None, *, corners: bool = False) -> IntArray:
        """Return the indices of the nodes on a patch, of its corners alone if wanted."""
        numbers, places = self.nodes
        low, high = np.array(box).T
        near = (
            np.minimum(np.abs(places - low), np.abs(places - high)) < NEAR
            if corners
            else (places > low - NEAR) & (places < high + NEAR)
        )
        mine = np.ones(len(numbers), bool) if body is None else numbers // self.count == body
        return np.flatnonzero(near.all(axis=1) & mine)


def _unlike(ends: Sequence[float]) -> FloatArray:
    found = np.unique(np.round(ends, 9))
    return np.asarray(found)


def _divided(breaks: FloatArray, size: float) -> FloatArray:
    """Return lines no further apart than a size, at all breaks [m]."""
    pieces = [
        np.linspace(a, b, 1 + int(np.ceil((b - a) / size - 1e-6))) for a, b in pairwise(breaks.tolist())
    ]
    return np.unique(np.round(np.concatenate(pieces), 12))


def ribbed(length: float, width: float, thickness: float, height: float, breadth: float) -> Shape:
    """Return a plate on four feet under its corners, with two ribs along and one across beneath it.

    Parameters
    ----------
    length, width, thickness : float
        Of the plate, whose upper face is z = 0 [m].
    height, breadth : float
        Of the ribs [m].
    """
    x, y = np.array([0.0, 0.12, 0.55, 0.88, 1.0]) * length, np.array([0.0, 0.15, 0.5, 0.85, 1.0]) * width
    up, down = (-thickness, 0.0), (-thickness - height, -thickness)
    halves = ((0.0, x[2]), (x[2], x[4])), ((0.0, y[2]), (y[2], y[4]))
    plate = [(f"plate_{i}", (a, b, up), 0) for i, (a, b) in enumerate(product(*halves), start=1)]
    left, right = (0.3 * width, 0.3 * width + breadth), (0.7 * width - breadth, 0.7 * width)
    ribs = [
        ("rib_left", ((x[1], x[3]), left, down), 0),
        ("rib_right", ((x[1], x[3]), right, down), 0),
        ("rib_across", ((x[2], x[2] + breadth), (left[1], right[0]), down), 0),
    ]
    level, corners = (-thickness, -thickness), (((0.0, x[1]), (x[3], x[4])), ((0.0, y[1]), (y[3], y[4])))
    feet = [(f"foot_{i}", (a, b, level)) for i, (a, b) in enumerate(product(*corners), start=1)]
    return _plain(plate + ribs, feet)


def bracket(length: float, width: float, thickness: float, height: float, breadth: float) -> Shape:
    """Return a plate bolted by two bolts to an angle with two gussets, which stands on two feet.

    Parameters
    ----------
    length, width, thickness : float
        Of the plate, whose upper face is z = 0 [m].
    height, breadth : float
        Of the angle, which reaches down so far, and thickness of its legs and gussets [m].
    """
    lap, middle = 0.24 * length, 0.6 * length
    flange, foot = -thickness - breadth, -thickness - height
    up, beneath = (-thickness, 0.0), (flange, -thickness)
    plate = [("plate_root", ((0.0, lap), (0.0, width), up), 0)]
    plate += [("plate_middle", ((lap, middle), (0.0, width), up), 0)]
    plate += [("plate_tip", ((middle, length), (0.0, width), up), 0)]
    angle = [
        ("flange", ((0.0, lap), (0.0, width), beneath), 1),
        ("leg", ((0.0, breadth), (0.0, width), (foot, flange)), 1),
        *(
            (name, ((breadth, lap), (share * width, share * width + breadth), (0.6 * foot, flange)), 1)
            for name, share in (("gusset_left", 0.3), ("gusset_right", 0.62))
        ),
    ]
    sides = ((0.0, 0.2 * width), (0.8 * width, width))
    feet = [(f"foot_{i}", ((0.0, breadth), side, (foot, foot))) for i, side in enumerate(sides, start=1)]
    under = ((0.12 * width, 0.24 * width), (0.76 * width, 0.88 * width))
    face = (-thickness, -thickness)
    bolts = [(f"bolt_{i}", ((0.35 * lap, 0.85 * lap), side, face)) for i, side in enumerate(under, start=1)]
    return _plain(plate + angle, feet, bolts)


def _plain(
    parts: Sequence[tuple[str, Sequence[Sequence[float]], int]],
    feet: Sequence[tuple[str, Sequence[Sequence[float]]]],
    bolts: Sequence[tuple[str, Sequence[Sequence[float]]]] = (),
) -> Shape:
    def box(ends: Sequence[Sequence[float]]) -> Box:
        x, y, z = ((float(low), float(high)) for low, high in ends)
        return x, y, z

    return Shape(
        tuple((name, box(ends), body) for name, ends, body in parts),
        tuple((name, box(ends)) for name, ends in feet),
        tuple((name, box(ends)) for name, ends in bolts),
    )


SHAPES = {"ribbed": ribbed, "bracket": bracket}
"""By kind."""
