"""The page of the shapes: the test as it was placed, each mode as it moves, the model beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from acquisition import ModalData
from acquisition.arrays import ComplexArray, FloatArray
from acquisition.errors import ModalkitError
from identification import mpc
from modalkit.views.faces import closed_faces
from modalkit.views.grid_lines import grid_lines
from modalkit.views.mesh import edges_of, mesh_of
from modalkit.views.pairs import pairs_of
from modalkit.workflow.case import Session
from updating.correlation.correlate import Correlation
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction

FINE = (81, (41, 27))
"""Points at which the model is drawn, along a beam and over a plate."""

STANDING = "as stated"
"""Name of the model that the study states, in the list of models."""

NODES = 1500
"""Nodes of a user's own mesh that move, beyond which the model is drawn at the test's points alone: each takes 20 bytes
for each mode in a report [-]."""


@dataclass(frozen=True, eq=False)
class Beside:
    """A model beside a test.

    Parameters
    ----------
    session : Session
        The study worked out.
    predictor : Predictor
        Its model.
    correlation : Correlation
        Pairs and MAC.
    """

    session: Session
    predictor: Predictor
    correlation: Correlation


@dataclass(frozen=True, eq=False)
class Changed:
    """A model after something was changed in it: by an update, or by the cause that a diagnosis found.

    Parameters
    ----------
    name : str
        What it is called in the list of models: ``updated``, ``with sensor_mass``.
    predictor : Predictor
        The model, on the geometry of the study's own.
    """

    name: str
    predictor: Predictor


def shapes_page(modal: ModalData, beside: Beside | None, changed: Sequence[Changed] = ()) -> dict[str, Any]:
    """Return geometry and shapes; of each model, its shape at the test's points and on its own surface.

    Parameters
    ----------
    modal : ModalData
        The test's modes.
    beside : Beside, optional
        The model as the study states it.
    changed : sequence of Changed
        The same model after an update or with a cause in it; drawn only where ``beside`` is.
    """
    if modal.shapes is None or not len(modal.dofs):
        return {"modes": [], "why": "these modes have no shapes; identify them from FRFs at several points"}
    measured = list(dict.fromkeys(dof.node for dof in modal.dofs))
    nodes = measured + _still(modal, measured)
    places, placed = _places(modal, nodes)
    vectors = _vectors(modal, nodes)
    row = {node: i for i, node in enumerate(nodes)}
    joined = [(row[int(a)], row[int(b)]) for a, b in modal.geometry.lines if int(a) in row and int(b) in row]
    drawn_by = "file" if joined else "grid" if placed else "order"
    if drawn_by == "grid":
        joined = grid_lines(places)
    page: dict[str, Any] = {
        "nodes": nodes,
        "lines_from": drawn_by,
        "still": len(nodes) - len(measured),
        "places": places,
        "placed": placed,
        "why": ""
        if placed
        else "neither file nor study gives coordinates: points are drawn in a row, by number; give places in [test]",
        "lines": joined if placed else [[i, i + 1] for i in range(len(nodes) - 1)],
        "faces": closed_faces(places, [pair for pair in joined if max(pair) < len(measured)])
        if placed
        else [],
        "arrows": [{"node": row[dof.node], "to": _direction(modal, k)} for k, dof in enumerate(modal.dofs)],
        "modes": [_mode(modal, vectors[:, :, r], r) for r in range(len(modal))],
        "model": None,
        "changed": [],
    }
    if beside is not None and placed:
        drawn = [
            _model(page["modes"], vectors, nodes, beside.session, one)
            for one in (Changed(STANDING, beside.predictor), *changed)
        ]
        page["model"], page["changed"] = drawn[0], [_on_surface_of(drawn[0], one) for one in drawn[1:]]
    return page


def _on_surface_of(first: dict[str, Any], model: dict[str, Any]) -> dict[str, Any]:
    """Leave out a surface that is the first model's, whose places and lines are written once."""
    own, known = model["surface"], first["surface"]
    same = own is not None and known is not None and np.array_equal(own["places"], known["places"])
    return model | {"surface": None} if same else model


def _still(modal: ModalData, measured: Sequence[int]) -> list[int]:
    """Return the points of the test's lines at which nothing was measured, drawn at rest; none without coordinates."""
    if not all(node in modal.geometry for node in measured):
        return []
    ends = dict.fromkeys(int(node) for node in modal.geometry.lines.ravel())
    return [node for node in ends if node not in set(measured) and node in modal.geometry]


def _places(modal: ModalData, nodes: list[int]) -> tuple[FloatArray, bool]:
    """Return where the points are, and whether the file states it; else they stand in a row."""
    if all(node in modal.geometry for node in nodes):
        return modal.geometry.at(nodes), True
    return np.stack([np.arange(float(len(nodes))), *2 * [np.zeros(len(nodes))]], axis=1), False


def _direction(modal: ModalData, k: int) -> FloatArray:
    return np.abs(modal.dofs[k].unit_vector) if modal.geometry.axes is None else _turned(modal, k)


def _turned(modal: ModalData, k: int) -> FloatArray:
    dof = modal.dofs[k]
    return modal.geometry.direction(dof) * dof.sign


def _vectors(modal: ModalData, nodes: list[int]) -> ComplexArray:
    """Return the motion of every point, (n_points, 3, n_modes), each mode turned to be as real as it can be."""
    assert modal.shapes is not None
    row = {node: i for i, node in enumerate(nodes)}
    vectors = np.zeros((len(nodes), 3, len(modal)), complex)
    for k, dof in enumerate(modal.dofs):
        vectors[row[dof.node]] += _direction(modal, k)[:, None] * modal.shapes[k][None, :]
    angle = 0.5 * np.angle(np.sum(vectors**2, axis=(0, 1)))
    return np.asarray(vectors * np.exp(-1j * angle))


def _mode(modal: ModalData, vectors: ComplexArray, r: int) -> dict[str, Any]:
    assert modal.damping is not None
    assert modal.shapes is not None
    return {
        "mode": r + 1,
        "frequency_hz": modal.frequency[r],
        "damping_ratio": modal.damping[r],
        "mpc": mpc(modal.shapes[:, [r]])[0],
        "re": vectors.real,
        "im": vectors.imag,
    }


def _model(
    modes: list[dict[str, Any]], vectors: ComplexArray, nodes: list[int], session: Session, model: Changed
) -> dict[str, Any]:
    """Return a model's shapes of the paired modes, scaled to the test's by least squares."""
    measured, predictor = session.case.measured, model.predictor
    prediction = predictor.predict()
    at_points = _at_points(session, predictor, prediction, nodes)
    surface = _surface(session, predictor, prediction.vectors.shape[0])
    found: list[dict[str, Any] | None] = [None] * len(modes)
    for pair in pairs_of(measured, prediction):
        frequency = prediction.frequency[pair.model]
        u, shape = vectors[:, :, pair.test], at_points[:, :, pair.model]
        factor = float(np.sum(shape * u.real) / max(float(np.sum(shape**2)), 1e-300))
        difference = np.linalg.norm(u - factor * shape, axis=1)
        found[pair.test] = {
            "mode": pair.model + 1,
            "frequency_hz": frequency,
            "error_percent": 100 * (frequency / modes[pair.test]["frequency_hz"] - 1),
            "mac": pair.mac,
            "at_points": factor * shape,
            "difference": difference / max(float(np.abs(u).max()), 1e-300),
            "surface": None
            if surface is None
            else factor * _moved(surface["rows"], prediction.vectors[:, pair.model]),
        }
    drawn = None if surface is None else {k: v for k, v in surface.items() if k != "rows"}
    return {"name": model.name, "modes": found, "surface": drawn}


def _at_points(
    session: Session, predictor: Predictor, prediction: Prediction, nodes: list[int]
) -> FloatArray:
    """Return how a model moves the test's points in the test's axes, (n_points, 3, n_modes)."""
    measured = session.case.measured
    rotation = session.study.axes(session.study.test).rotation
    along = np.tile([0.0, 0.0, 1.0], (len(measured.nodes), 1))
    if measured.directions is not None:
        along = np.asarray(measured.directions, dtype=float)
    values = predictor.point_rows()[:, : prediction.vectors.shape[0]] @ prediction.vectors
    shapes = np.zeros((len(nodes), 3, values.shape[1]))
    for k, node in enumerate(measured.nodes):
        if node in nodes:
            shapes[nodes.index(node)] += np.outer(along[k] @ rotation, values[k])
    return shapes


def _surface(session: Session, predictor: Predictor, count: int) -> dict[str, Any] | None:
    """Return the model's own line or surface in the test's coordinates, with the rows of its basis; None without.

    ``count`` is the number of coordinates of the basis that the shapes have.
    """
    spec = predictor.spec
    axes = session.study.axes(session.study.test)
    if spec.imported is not None:
        return _own_mesh(session, predictor, count)
    if spec.kind == "beam":
        x = np.linspace(0.0, spec.length, FINE[0])
        flat, shape = x[:, None], [FINE[0]]
    else:
        nx, ny = FINE[1]
        grid = np.meshgrid(np.linspace(0.0, spec.length, nx), np.linspace(0.0, spec.width, ny))
        flat, shape = np.stack(grid, axis=-1).reshape(-1, 2), [ny, nx]
    space = np.zeros((len(flat), 3))
    space[:, : flat.shape[1]] = _stretched(predictor, flat)
    return {
        "places": space @ axes.rotation + np.asarray(axes.origin),
        "along": axes.rotation[2],
        "shape": shape,
        "rows": predictor.reduced.rows(flat)["w"][:, :count],
    }


def _stretched(predictor: Predictor, places: FloatArray) -> FloatArray:
    """Return where places of the nominal model lie once length or width are changed, (n, dim) [m]."""
    stretch, moved = predictor.stretch.by(predictor.base.factors), places.copy()
    axes = len(stretch)
    moved[:, :axes] = moved[:, :axes] * stretch - predictor.stretch.growths * (stretch - 1)
    return moved


def _moved(rows: FloatArray, vector: FloatArray) -> FloatArray:
    """Return how places move: (n,) across a beam or plate, (n, 3) where rows are (n, 3, n_basis)."""
    return np.asarray(rows @ vector)


def _own_mesh(session: Session, predictor: Predictor, count: int) -> dict[str, Any] | None:
    """Return the mesh of matrices or of a deck with the rows of its nodes; None of one that cannot be drawn."""
    mesh = mesh_of(predictor.spec)
    if mesh is None or not (mesh.lines or mesh.faces):
        return None
    used = sorted({i for part in (*mesh.lines, *mesh.faces) for i in part})
    if len(used) > NODES:
        return None
    place = {old: new for new, old in enumerate(used)}
    axes = session.study.axes(session.study.test)
    along = np.tile(axes.rotation.T, (len(used), 1))  # the test's axes, as the model has them
    try:
        rows = predictor.reduced.rows(np.repeat(mesh.places[used], 3, axis=0), along)["w"][:, :count]
    except ModalkitError:  # matrices that lack some of the three motions of a node
        return None
    return {
        "places": mesh.places[used] @ axes.rotation + np.asarray(axes.origin),
        "along": None,
        "shape": None,
        "lines": [[place[i] for i in pair] for pair in (*mesh.lines, *edges_of(mesh.faces))],
        "faces": [[place[i] for i in face] for face in mesh.faces],
        "rows": np.asarray(rows).reshape(len(used), 3, -1),
    }
