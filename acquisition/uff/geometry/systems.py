"""Coordinate systems of data sets 18 and 2420: where they are and what their directions are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import InputError
from acquisition.uff.functions.units import Units
from acquisition.uff.text.numbers import numbers_of

CARTESIAN, CYLINDRICAL = 0, 1


@dataclass(frozen=True, eq=False)
class System:
    """One coordinate system.

    Parameters
    ----------
    kind : int
        0 Cartesian, 1 cylindrical (radius, angle in degrees, height), 2 spherical.
    points : (3, 3) array
        Rows: origin, a point on +x, a point in the half plane of +x and +z, in the reference system [m].
    reference : int
        The system in which the points are given; 0 is the global one.
    """

    kind: int
    points: FloatArray
    reference: int = 0


@dataclass(frozen=True, eq=False)
class Placed:
    """A coordinate system in global terms: its kind, its origin (3,) [m] and its axes as rows (3, 3) [-]."""

    kind: int
    origin: FloatArray
    axes: FloatArray

    def to_global(self, coordinates: FloatArray) -> FloatArray:
        """Return global coordinates (n, 3) [m] of points given in the system.

        Raises
        ------
        InputError
            If the system is spherical.
        """
        if self.kind == CYLINDRICAL:
            radius, angle, height = coordinates.T
            angle = np.radians(angle)
            coordinates = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)
        elif self.kind != CARTESIAN:
            raise InputError("a spherical coordinate system; give Cartesian or cylindrical coordinates")
        return np.asarray(self.origin + coordinates @ self.axes, dtype=np.float64)

    def directions(self, place: FloatArray) -> FloatArray:
        """Return the axes, as rows (3, 3), along which motion at a place (3,) [m] is meant [-]."""
        if self.kind == CARTESIAN:
            return self.axes
        if self.kind != CYLINDRICAL:
            raise InputError(
                "a spherical coordinate system; give directions in a Cartesian or cylindrical one"
            )
        x, y, _ = self.axes @ (place - self.origin)
        radius = float(np.hypot(x, y))
        c, s = (x / radius, y / radius) if radius > 1e-9 else (1.0, 0.0)
        return np.asarray(np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ self.axes)

    @property
    def is_global(self) -> bool:
        """Whether it is the global Cartesian system."""
        same = np.allclose(self.axes, np.eye(3), atol=1e-6) and np.allclose(self.origin, 0, atol=1e-9)
        return bool(self.kind == CARTESIAN and same)


def place_system(
    systems: Mapping[int, System], label: int, placed: dict[int, Placed | str] | None = None
) -> Placed:
    """Return a system in global terms, through the systems it is given in.

    Parameters
    ----------
    systems : mapping
        By label.
    label : int
        Which; 0 is the global one.
    placed : dict, optional
        Systems placed before, and why others could not be; it is added to.

    Raises
    ------
    InputError
        If a system is missing, given in itself, or its points lie on one line.
    """
    known = {} if placed is None else placed
    known.setdefault(0, Placed(CARTESIAN, np.zeros(3), np.eye(3)))
    way: dict[int, None] = {}
    current = label
    while current not in known:
        if current in way or current not in systems:
            why = "given in itself" if current in way else "not defined"
            known[current] = f"coordinate system {current} is {why}"
            break
        way[current] = None
        current = systems[current].reference
    for one in reversed(way):
        reference = known[systems[one].reference]
        known[one] = reference if isinstance(reference, str) else _placed(systems[one], one, reference)
    found = known[label]
    if isinstance(found, str):
        raise InputError(found)
    return found


def _placed(system: System, label: int, reference: Placed) -> Placed | str:
    """Return a system in global terms, where the one it is given in is, or why it has no place."""
    try:
        points = reference.to_global(system.points)
    except InputError as error:
        return str(error)
    first, second = points[1] - points[0], points[2] - points[0]
    across = np.cross(second, first)
    size = float(np.linalg.norm(first)), float(np.linalg.norm(across))
    if min(size) < 1e-9 * max(float(np.abs(points).max()), 1e-30):
        return f"coordinate system {label}: its points lie on one line"
    x, y = first / size[0], across / size[1]
    return Placed(system.kind, points[0], _snapped(np.array([x, y, np.cross(x, y)])))


def _snapped(axes: FloatArray) -> FloatArray:
    """Return axes that are whole right angles but for the rounding of five printed digits as exactly that."""
    whole = np.round(axes)
    return whole + 0.0 if np.abs(axes - whole).max() < 1e-4 else axes


def read_systems(number: int, body: bytes, units: Units) -> dict[int, System]:
    """Return the systems of a data set 18 or 2420, by label.

    Raises
    ------
    InputError
        If entries are missing or contradict each other.
    """
    lines = [line for line in body.splitlines() if line.strip()] if number == 18 else body.splitlines()
    lines, size = (lines, 4) if number == 18 else (lines[2:], 6)
    while lines and not lines[-1].strip():
        lines = lines[:-1]
    if not lines or len(lines) % size:
        raise InputError(
            f"data set {number} holds {len(lines)} lines, not a multiple of {size}: it is cut off"
        )
    read = _points18 if number == 18 else _points2420
    return dict(read(lines[first : first + size], units) for first in range(0, len(lines), size))


def _labels(line: bytes) -> list[int]:
    values = numbers_of(line)
    if not np.all(np.abs(values) < 1e9):
        raise InputError("labels of a coordinate system that are not whole numbers")
    return [int(v) for v in values]


def _points18(lines: list[bytes], units: Units) -> tuple[int, System]:
    fields = _labels(lines[0])
    points = numbers_of(lines[2] + b"\n" + lines[3])
    if len(fields) < 3 or len(points) != 9 or not np.all(np.abs(points) < 1e15):
        raise InputError("data set 18: a system without label, type, reference or its three points")
    label, kind, reference = fields[:3]
    return label, System(kind, points.reshape(3, 3) / units.length, reference)


def _points2420(lines: list[bytes], units: Units) -> tuple[int, System]:
    fields = _labels(lines[0])
    table = numbers_of(b"\n".join(lines[2:]))
    if len(fields) < 2 or len(table) != 12 or not np.all(np.abs(table) < 1e15):
        raise InputError("data set 2420: a system without label, type or its four rows of three")
    table = table.reshape(4, 3)
    axes, origin = table[:3], table[3] / units.length
    if np.abs(axes @ axes.T - np.eye(3)).max() > 1e-3 or np.linalg.det(axes) < 0:
        raise InputError(f"data set 2420: the axes of system {fields[0]} are not at right angles")
    points = origin + np.array([np.zeros(3), axes[0], axes[2]])
    return fields[0], System(fields[1], points)
