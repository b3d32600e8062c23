"""What must not matter: the order of the rows, and how structure and sensors lie in their axes; random frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from imported_cases import seen_from, spec_of
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from acquisition.arrays import FloatArray, IntArray
from updating import Predictor, Region, build_structure
from updating.models.accuracy import reduction_error
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.reduction import reduce_structure
from updating.models.state import State
from updating.prediction.prediction import Prediction

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "matrices"
PARTS, ELEMENTS, COUNT = 3, 5, 6
CORNERS = np.array([[0.0, 0.0, 0.0], [0.0, 0.1, 0.4], [0.5, 0.0, 0.45], [0.7, 0.3, 0.2]])

ROUNDING = 1e-8
"""Of frequencies on the reduced basis [-]."""

TWICE = float(np.log(2.0))

seeds = st.integers(0, 2**31)


@pytest.fixture(scope="module")
def bars(example_of: Callable[[Path, str], ModuleType]) -> ModuleType:
    return example_of(EXAMPLES, "bars")


def bent(bars: ModuleType, seed: int, turned: FloatArray | None = None, elements: int = ELEMENTS) -> Imported:
    """Return a bent bar in three parts, held at one end, its sections random; put together in turned axes."""
    rng = np.random.default_rng(seed)
    turned = np.eye(3) if turned is None else turned
    made = bars.Structure()
    corners = CORNERS + 0.05 * rng.uniform(-1, 1, CORNERS.shape)
    ends = [made.node(tuple(turned @ corner)) for corner in corners]
    made.held.add(ends[0])
    for part, (a, b) in enumerate(pairwise(range(PARTS + 1))):
        section = bars.Section(*rng.uniform(0.01, 0.03, 2))
        along = corners[b] - corners[a]
        second = np.cross(along, [1.0, 0.3, 0.2])
        second = turned @ (second / np.linalg.norm(second))
        made.bar(f"part_{part}", (ends[a], ends[b]), section, elements, tuple(second))
    row_of = np.full(6 * len(made.places), -1)
    row_of[made.free] = np.arange(len(made.free))
    node = np.repeat(np.arange(1, len(made.places) + 1), 6)
    places = np.array(made.places)[node - 1]
    table = NodeTable(node, places, np.tile(np.arange(1, 7), len(made.places)), row_of)
    parts = [tuple(made.matrix(kind, parts=[one]) for one in made.parts) for kind in ("stiffness", "mass")]
    return Imported(made.matrix("stiffness"), made.matrix("mass"), table, *parts)


def sensors(imported: Imported, seed: int) -> tuple[IntArray, FloatArray]:
    """Return some of the nodes that move, and skew directions."""
    rng = np.random.default_rng(seed + 1)
    free = np.unique(imported.nodes.node[imported.nodes.row >= 0])
    directions = rng.standard_normal((4, 3))
    return rng.choice(free, 4, replace=False), directions / np.linalg.norm(directions, axis=1)[:, None]


def predicted(imported: Imported, nodes: IntArray, directions: FloatArray, state: State) -> Prediction:
    regions = tuple(Region(f"part_{i}", (0.0, 1.0), (0.0, 1.0)) for i in range(PARTS))
    places = imported.nodes.places[np.searchsorted(imported.nodes.node, nodes)]
    test = seen_from(places, directions)
    return Predictor(spec_of(imported, regions=regions), test).predict(state, count=COUNT)


def changed(seed: int, by: float = 0.3) -> State:
    """Return a state in which stiffness and mass of the parts are others, by up to so much of a logarithm."""
    rng = np.random.default_rng(seed + 2)
    factors = [(i, name) for i in range(PARTS) for name in ("E", "density")]
    return State(regional={factor: float(np.exp(rng.uniform(-by, by))) for factor in factors})


def assert_same(found: Prediction, expected: Prediction) -> None:
    assert found.frequency == pytest.approx(expected.frequency, rel=1e-7)
    size = np.abs(expected.constants).max(axis=0)
    # modes that nearly coincide share their constants; a bent bar of oblong sections has none nearer than a per cent
    apart = np.diff(expected.frequency, prepend=0.0) / expected.frequency > 0.01
    apart &= np.diff(expected.frequency, append=np.inf) / expected.frequency > 0.01
    np.testing.assert_allclose(
        (found.constants / size)[:, apart], (expected.constants / size)[:, apart], atol=1e-4
    )


@settings(max_examples=10)
@given(seed=seeds)
def test_the_order_of_the_rows_does_not_matter(bars: ModuleType, seed: int) -> None:
    imported, state = bent(bars, seed), changed(seed)
    nodes, directions = sensors(imported, seed)
    order = np.random.default_rng(seed).permutation(imported.order)
    row = np.where(imported.nodes.row < 0, -1, np.argsort(order)[imported.nodes.row])

    def shuffled(matrix: Sparse) -> Sparse:
        return Sparse(matrix[order][:, order])

    other = Imported(
        shuffled(imported.stiffness), shuffled(imported.mass), replace(imported.nodes, row=row),
        tuple(map(shuffled, imported.stiffness_parts)), tuple(map(shuffled, imported.mass_parts)),
    )  # fmt: skip
    assert_same(predicted(other, nodes, directions, state), predicted(imported, nodes, directions, state))


@settings(max_examples=10)
@given(seed=seeds)
def test_structure_and_sensors_may_be_turned_together(bars: ModuleType, seed: int) -> None:
    """The turned one is put together anew along other axes: places, matrices and directions, modal constants alike."""
    turned = Rotation.random(random_state=seed % 2**31).as_matrix()
    imported, state = bent(bars, seed), changed(seed)
    nodes, directions = sensors(imported, seed)
    assert_same(
        predicted(bent(bars, seed, turned), nodes, directions @ turned.T, state),
        predicted(imported, nodes, directions, state),
    )


@settings(max_examples=8)
@given(seed=seeds)
def test_the_reduced_basis_is_off_by_its_stated_error(bars: ModuleType, seed: int) -> None:
    """Frequencies with other moduli and densities on the basis and on all degrees of freedom, by LAPACK."""
    imported, state = bent(bars, seed, elements=12), changed(seed, by=TWICE)
    regions = tuple(Region(f"part_{i}", (0.0, 1.0), (0.0, 1.0)) for i in range(PARTS))
    structure = build_structure(spec_of(imported, regions=regions))
    nodes, _ = sensors(imported, seed)
    places = imported.nodes.places[np.searchsorted(imported.nodes.node, nodes)]
    reduced = reduce_structure(structure, places, modes=COUNT)
    assert reduced.basis.shape[1] < imported.order
    stiffness, mass = (matrix.toarray() for matrix in structure.matrices(state))
    n = imported.order  # the largest of 1 / lambda are exact where the smallest lambda are not
    inverse = eigh(mass, stiffness, eigvals_only=True, subset_by_index=(n - COUNT, n - 1))
    off = np.sqrt(reduced.eigen(state)[0][:COUNT] * inverse[::-1]) - 1
    said = reduction_error(reduced, state, COUNT)
    assert off.max() > 10 * ROUNDING
    assert (off > -ROUNDING).all()  # Rayleigh and Ritz: from above
    # to first order in the change: a residual force moves what is half or twice as stiff twice or half as far
    np.testing.assert_array_less(off, 3 * said + ROUNDING)
    np.testing.assert_array_less(said, 3 * off + ROUNDING)
