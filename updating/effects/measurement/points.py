"""Points of a test as effects name them: by node number."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from acquisition.errors import StudyError
from updating.effects.box import as_places
from updating.models.state import Role
from updating.test_data.measured import Measured


def points_of(measured: Measured, role: str) -> list[int]:
    """Return the points that are ``"hit"``, or ``"seen"``."""
    return sorted({int(p) for p in (measured.hit if role == "hit" else measured.seen) if p >= 0})


def indices(measured: Measured, nodes: tuple[int, ...]) -> list[int]:
    """Return the points of some nodes.

    Raises
    ------
    StudyError
        If the test has no such node.
    """
    if missing := [node for node in nodes if int(node) not in measured.nodes]:
        there = ", ".join(map(str, measured.nodes[:12]))
        raise StudyError(f"the test has no point {missing[0]}; it has {there or 'no points'}")
    return [measured.nodes.index(int(node)) for node in nodes]


def places(measured: Measured, nodes: tuple[int, ...]) -> tuple[tuple[float, float, float], ...]:
    """Return where some nodes lie [m]."""
    return as_places(measured.points[indices(measured, nodes)])


def channel_of(measured: Measured, point: int) -> str:
    """Return a point as the test writes it, node and direction."""
    return measured.written[point] if measured.written else str(measured.nodes[point])


def channel_point(measured: Measured, channel: str) -> tuple[Literal["seen", "hit"], int]:
    """Return the role and the point of a sensor that stayed while the hammer roved, or of a force that did.

    Parameters
    ----------
    measured : Measured
        The test.
    channel : str
        Node and direction, ``5+Z``, or the node alone where one sensor sits there.

    Raises
    ------
    StudyError
        If no such sensor stayed.
    """
    role: Literal["seen", "hit"] = "seen" if measured.roving == "hit" else "hit"
    fixed = points_of(measured, role)
    asked = channel.strip().upper()
    names = {p: channel_of(measured, p).upper() for p in fixed}
    found = [p for p in fixed if names[p] == asked] or [p for p in fixed if str(measured.nodes[p]) == asked]
    if len(found) != 1:
        what = "sensor" if role == "seen" else "force"
        there = ", ".join(channel_of(measured, p) for p in fixed[:12]) or "none"
        raise StudyError(f"channel = {channel!r} is no {what} that stayed; the test has {there}")
    return role, found[0]


def concerned(measured: Measured, values: Mapping[str, Any]) -> list[Role]:
    """Return the role and index of what an effect means: the sensor in ``channel``, or the roving ``points``."""
    if "channel" in values:
        return [channel_point(measured, values["channel"])]
    return [(measured.roving, p) for p in indices(measured, values["points"])]


def concerned_places(measured: Measured, values: Mapping[str, Any]) -> tuple[tuple[float, float, float], ...]:
    """Return where what an effect means lies [m]."""
    return places(measured, tuple(measured.nodes[p] for _, p in concerned(measured, values)))
