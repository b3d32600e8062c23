"""Stated places of test points, lines between them, and stated directions of sensors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition import Dof, Geometry, InputError, ModalData, StudyError
from acquisition.arrays import IntArray
from modalkit.study.tables import MeasurementTable
from updating import Axes, Spec


def with_places(
    modal: ModalData, table: MeasurementTable, axes: Axes | None = None, spec: Spec | None = None
) -> tuple[ModalData, tuple[str, ...]]:
    """Return modes with the places, lines and directions that a study states of their points, and what to say of it.

    A point whose place is stated neither in the file nor in the study is taken for the node of that number of a model
    with nodes.

    Parameters
    ----------
    modal : ModalData
        The modes.
    table : MeasurementTable
        What the study states about their measurement.
    axes : Axes, optional
        The model's axes in the coordinates of the test.
    spec : Spec, optional
        The model; without one, only what is stated is known.

    Raises
    ------
    StudyError
        If a place is stated of a point that the test does not have, a line of one without a place, or a direction of
        what has none.
    """
    nodes = tuple(dict.fromkeys(dof.node for dof in modal.dofs))
    stated = _stated(table, nodes)
    geometry = modal.geometry
    lost = [n for n in nodes if n not in stated and n not in geometry]
    known = {} if axes is None or spec is None or modal.shapes is None else _of_model(lost, axes, spec)
    if stated or known:
        geometry = _moved(geometry, {**stated, **known})
    if table.lines:
        geometry = replace(geometry, lines=_joined(table, geometry))
    if table.directions:
        geometry = _turned(geometry, table.directions, nodes)
    warnings = (
        f"{len(known)} test point(s) have no coordinates; each is placed at the model's node of the same number. If "
        "that is wrong, give places in [test]",
    )
    return replace(modal, geometry=geometry), warnings if known else ()


def _stated(table: MeasurementTable, nodes: tuple[int, ...]) -> dict[int, tuple[float, ...]]:
    found: dict[int, tuple[float, ...]] = {int(node): place for node, place in table.places.items()}
    if strange := [node for node in found if node not in nodes]:
        measured = ", ".join(map(str, nodes[:8])) or "none"
        raise StudyError(f"[test] places name point {strange[0]}; points of the test are {measured}")
    return found


def _joined(table: MeasurementTable, geometry: Geometry) -> IntArray:
    """Return the lines that are stated, each once, shape (n_lines, 2)."""
    pairs = dict.fromkeys((min(pair), max(pair)) for pair in table.lines)
    for pair in pairs:
        if pair[0] == pair[1]:
            raise StudyError(f"[test] lines join point {pair[0]} with itself; give two points, as [[1, 2]]")
        if lost := [node for node in pair if node not in geometry]:
            raise StudyError(
                f"[test] lines name point {lost[0]}, which has no place; give it in places, or take the line out"
            )
    return np.array(list(pairs), dtype=np.int64)


def _of_model(nodes: list[int], axes: Axes, spec: Spec) -> dict[int, tuple[float, ...]]:
    """Return where nodes of the model are in the coordinates of the test; nothing unless it has them all."""
    if spec.imported is None or not nodes:
        return {}
    places = spec.imported.places
    row = {int(node): i for i, node in enumerate(places.node)}
    if any(node not in row for node in nodes):
        return {}
    at = places.at[[row[node] for node in nodes]] @ axes.rotation + np.asarray(axes.origin)
    return {node: tuple(place) for node, place in zip(nodes, at.tolist(), strict=True)}


def _moved(geometry: Geometry, places: dict[int, tuple[float, ...]]) -> Geometry:
    """Return a geometry with nodes at other places, or added to it."""
    every = dict(zip(geometry.nodes, geometry.coordinates.tolist(), strict=True))
    every |= {node: list(place) for node, place in places.items()}
    axes = geometry.axes
    if axes is not None:
        new = len(every) - len(axes)
        axes = np.concatenate([axes, np.tile(np.eye(3), (new, 1, 1))])
    return Geometry(tuple(every), np.array(list(every.values())), geometry.lines, axes)


def _turned(
    geometry: Geometry, directions: dict[str, tuple[float, float, float]], nodes: tuple[int, ...]
) -> Geometry:
    """Return a geometry in which some degrees of freedom point elsewhere than their letters say."""
    axes = np.tile(np.eye(3), (len(geometry.nodes), 1, 1)) if geometry.axes is None else geometry.axes.copy()
    for name, vector in directions.items():
        try:
            dof = Dof.of(name)
        except InputError as error:
            raise StudyError(f"[test] directions: {error}") from error
        length = float(np.linalg.norm(vector))
        if dof.node not in nodes or dof.node not in geometry:
            raise StudyError(f"[test] directions name {name}, a point that the test does not have")
        if not 0 <= dof.axis < 3 or length == 0:
            raise StudyError(f"[test] directions: {name} = {list(vector)}; give a translation and a vector")
        axes[geometry.nodes.index(dof.node), dof.axis] = dof.sign * np.asarray(vector) / length
    return replace(geometry, axes=axes)
