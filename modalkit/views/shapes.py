"""The page of the shapes: the test as it was placed, each mode as it moves, the model beside it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from acquisition import ModalData
from acquisition.arrays import ComplexArray, FloatArray
from acquisition.errors import ModalkitError
from identification import mpc
from modalkit.views.faces import closed_faces
from modalkit.views.mesh import edges_of, mesh_of
from modalkit.workflow.case import Session
from updating.correlation.correlate import Correlation
from updating.prediction.predict import Predictor

FINE = (81, (41, 27))
"""Points at which the model is drawn, along a beam and over a plate."""

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


def shapes_page(modal: ModalData, beside: Beside | None) -> dict[str, Any]:
    """Return geometry and shapes; of a model, its shape at the test's points and on its own surface."""
    if modal.shapes is None or not len(modal.dofs):
        return {"modes": [], "why": "these modes have no shapes; identify them from FRFs at several points"}
    nodes = list(dict.fromkeys(dof.node for dof in modal.dofs))
    places, placed = _places(modal, nodes)
    vectors = _vectors(modal, nodes)
    row = {node: i for i, node in enumerate(nodes)}
    joined = [(row[int(a)], row[int(b)]) for a, b in modal.geometry.lines if int(a) in row and int(b) in row]
    page: dict[str, Any] = {
        "nodes": nodes,
        "places": places,
        "placed": placed,
        "why": "" if placed else "the file gives no coordinates: points stand in a row, by their numbers",
        "lines": joined if placed else [[i, i + 1] for i in range(len(nodes) - 1)],
        "faces": closed_faces(places, joined) if placed else [],
        "arrows": [{"node": row[dof.node], "to": _direction(modal, k)} for k, dof in enumerate(modal.dofs)],
        "modes": [_mode(modal, vectors[:, :, r], r) for r in range(len(modal))],
        "model": None,
    }
    if beside is not None and placed:
        page["model"] = _model(page["modes"], vectors, nodes, beside)
    return page


def _places(modal: ModalData, nodes: list[int]) -> tuple[FloatArray, bool]:
    """Return where the points are, and whether the file says so; else they stand in a row."""
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
    modes: list[dict[str, Any]], vectors: ComplexArray, nodes: list[int], beside: Beside
) -> dict[str, Any]:
    """Return the model's shapes of the paired modes, scaled to the test's by least squares."""
    measured, predictor = beside.session.case.measured, beside.predictor
    prediction = predictor.predict()
    rotation = beside.session.study.axes(beside.session.study.test).rotation
    known = [(k, nodes.index(node)) for k, node in enumerate(measured.nodes) if node in nodes]
    along = np.tile([0.0, 0.0, 1.0], (len(measured.nodes), 1))
    if measured.directions is not None:
        along = np.asarray(measured.directions, dtype=float)
    values = predictor.nominal_rows["w"][:, : prediction.vectors.shape[0]] @ prediction.vectors
    table = beside.correlation.table
    pairs = {
        int(t) - 1: (int(m) - 1, float(c)) for t, m, c in table[["test mode", "model mode", "MAC"]].to_numpy()
    }
    surface = _surface(beside, prediction.vectors.shape[0])
    found: list[dict[str, Any] | None] = []
    for r, mode in enumerate(modes):
        if r not in pairs:
            found.append(None)
            continue
        partner, mac = pairs[r]
        shape = np.zeros((len(nodes), 3))
        for k, i in known:
            shape[i] += values[k, partner] * (along[k] @ rotation)
        u = vectors[:, :, r].real
        factor = float(np.sum(shape * u) / max(float(np.sum(shape**2)), 1e-300))
        difference = np.linalg.norm(vectors[:, :, r] - factor * shape, axis=1)
        found.append(
            {
                "mode": partner + 1,
                "frequency_hz": prediction.frequency[partner],
                "error_percent": 100 * (prediction.frequency[partner] / mode["frequency_hz"] - 1),
                "mac": mac,
                "at_points": factor * shape,
                "difference": difference / max(float(np.abs(vectors[:, :, r]).max()), 1e-300),
                "surface": None
                if surface is None
                else factor * _moved(surface["rows"], prediction.vectors[:, partner]),
            }
        )
    drawn = None if surface is None else {k: v for k, v in surface.items() if k != "rows"}
    return {"modes": found, "surface": drawn}


def _surface(beside: Beside, count: int) -> dict[str, Any] | None:
    """Return the model's own line or surface in the test's coordinates, with the rows of its basis; None without.

    ``count`` is the number of coordinates of the basis that the shapes have.
    """
    study, predictor = beside.session.study, beside.predictor
    spec = predictor.spec
    axes = study.axes(study.test)
    if spec.imported is not None:
        return _own_mesh(beside, count)
    if spec.kind == "beam":
        x = np.linspace(0.0, spec.length, FINE[0])
        flat, shape = x[:, None], [FINE[0]]
    else:
        nx, ny = FINE[1]
        grid = np.meshgrid(np.linspace(0.0, spec.length, nx), np.linspace(0.0, spec.width, ny))
        flat, shape = np.stack(grid, axis=-1).reshape(-1, 2), [ny, nx]
    space = np.zeros((len(flat), 3))
    space[:, : flat.shape[1]] = flat
    return {
        "places": space @ axes.rotation + np.asarray(axes.origin),
        "along": axes.rotation[2],
        "shape": shape,
        "rows": predictor.reduced.rows(flat)["w"][:, :count],
    }


def _moved(rows: FloatArray, vector: FloatArray) -> FloatArray:
    """Return how places move: (n,) across a beam or plate, (n, 3) where rows are (n, 3, n_basis)."""
    return np.asarray(rows @ vector)


def _own_mesh(beside: Beside, count: int) -> dict[str, Any] | None:
    """Return the mesh of matrices or of a deck with the rows of its nodes; None of one that cannot be drawn."""
    predictor = beside.predictor
    mesh = mesh_of(predictor.spec)
    if mesh is None or not (mesh.lines or mesh.faces):
        return None
    used = sorted({i for part in (*mesh.lines, *mesh.faces) for i in part})
    if len(used) > NODES:
        return None
    place = {old: new for new, old in enumerate(used)}
    axes = beside.session.study.axes(beside.session.study.test)
    along = np.tile(axes.rotation.T, (len(used), 1))  # the test's axes, as the model has them
    try:
        rows = predictor.reduced.rows(np.repeat(mesh.places[used], 3, axis=0), along)["w"][:, :count]
    except ModalkitError:  # matrices that do not know all three motions of a node
        return None
    return {
        "places": mesh.places[used] @ axes.rotation + np.asarray(axes.origin),
        "along": None,
        "shape": None,
        "lines": [[place[i] for i in pair] for pair in (*mesh.lines, *edges_of(mesh.faces))],
        "faces": [[place[i] for i in face] for face in mesh.faces],
        "rows": np.asarray(rows).reshape(len(used), 3, -1),
    }
