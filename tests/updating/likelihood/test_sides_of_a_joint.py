"""A point where two nodes of the model are, the two sides of a joint: which of them was hit is left open."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from imported_cases import beam_matrices, beam_table, spec_of
from scipy import linalg, sparse

from updating import Case, Measured, Predictor, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.problem.candidate import Candidate

ELEMENTS, SPRING = 10, 1e7
"""Elements of each bar, and the stiffness of the bolt between the two [N/m]."""

JOINT, OTHER = 3, 6
"""Nodes of the first and of the second bar at which they meet: no two modes are alike."""

SIGMA = 1e-3


def crossed() -> tuple[Imported, np.ndarray, np.ndarray]:
    """Return two free bars that cross, bolted together, and their stiffness and mass (n, n)."""
    stiffness, mass = beam_matrices(ELEMENTS)
    first = beam_table(ELEMENTS, clamped=False)
    size, nodes = stiffness.shape[0], ELEMENTS + 1
    bolted = linalg.block_diag(stiffness.toarray(), 1.7 * stiffness.toarray())
    pair = np.array([2 * JOINT, size + 2 * OTHER])
    bolted[np.ix_(pair, pair)] += SPRING * np.array([[1.0, -1.0], [-1.0, 1.0]])
    for end in (0, 1):  # what holds the bars from turning about each other
        ground = np.arange(size) + end * size
        bolted[ground, ground] += np.where(np.arange(size) % 2, 50.0, 4e3)
    along, meets = first.places[:, 0], first.places[2 * JOINT, 0]
    across = np.stack([np.full(size, meets), along - along[2 * OTHER], np.zeros(size)], axis=1)
    table = NodeTable(
        np.concatenate([first.node, first.node + nodes]),
        np.concatenate([first.places, across]),
        np.concatenate([first.direction, np.where(first.direction == 5, 4, 3)]),
        np.arange(2 * size),
    )
    masses = sparse.block_diag([mass, mass])
    return Imported(Sparse(bolted), Sparse(masses), table), bolted, masses.toarray()


def struck(side: int, sensor: int) -> tuple[Spec, Measured]:
    """Return the model and a test of six points on either bar, one of them at the joint, on one of its sides."""
    imported, stiffness, mass = crossed()
    values, vectors = linalg.eigh(stiffness, mass)
    chosen = np.arange(2, 10)
    rows = np.array([0, 4, 10, 2 * (OTHER + ELEMENTS + 1) if side else 2 * JOINT, 14, 20])
    rows = np.concatenate([rows, np.array([0, 6, 16, 20]) + 2 * (ELEMENTS + 1)])
    shapes, count = vectors[rows][:, chosen], len(rows)
    constants = shapes * shapes[[sensor]]
    test = Measured(
        frequency=np.sqrt(values[chosen]) / (2 * np.pi), frequency_sigma=np.full(8, 1e-3),
        damping=np.full(8, np.nan), damping_sigma=np.full(8, np.nan),
        points=imported.nodes.places[rows], nodes=tuple(range(1, count + 1)),
        seen=np.full(count, sensor), hit=np.arange(count), constants=constants,
        constants_sigma=SIGMA * np.tile(np.sqrt(np.mean(constants**2, axis=0)), (count, 1)),
        absolute=True, directions=np.tile([0.0, 0.0, 1.0], (count, 1)),
    )  # fmt: skip
    return spec_of(imported), test


@pytest.mark.parametrize("sensor", [0, 3])
@pytest.mark.parametrize("side", [0, 1])
def test_either_side_of_a_joint_explains_the_shapes(side: int, sensor: int) -> None:
    spec, test = struck(side, sensor)
    problem, _ = pose(Case("crossed", spec, test, tolerances=Tolerances({"E": 0.01})))
    error = (problem.nominal.constants - test.constants) / test.constants_sigma
    assert np.abs(error).max() > 10  # the mean of the two sides is not what was measured
    point = explain(problem, Candidate()).best
    left = point.left_over / np.sqrt(point.comparison.noise(point.marginal.scale))
    assert np.abs(left).max() < 1.0


def test_a_point_beside_the_joint_is_where_it_is() -> None:
    spec, test = struck(0, 0)
    away = replace(test, points=np.delete(test.points, 3, axis=0)[[0, 1, 2, 2, 3, 4, 5, 6, 7, 8]])
    assert Predictor(spec, test).doubted == ("wx", "wy", "wz", "side0")
    assert Predictor(spec, away).doubted == ("wx", "wy", "wz")
