"""Places in elements: every kind gives back the polynomials it is made of, also where it is bent or skewed."""

from __future__ import annotations

import numpy as np
import pytest

from updating.models.imported.elements import Elements, shape_of

KINDS = [("B", 2), ("B", 3), ("S", 3), ("S", 4), ("S", 6), ("S", 8)]
KINDS += [("C3D", n) for n in (4, 6, 8, 10, 15, 20)]


def placed(
    family: str, count: int, rng: np.random.Generator, *, straight: bool
) -> tuple[Elements, np.ndarray]:
    """Return one element, its natural coordinates turned and stretched, its nodes moved a little if not straight."""
    shape = shape_of(family, count)
    assert shape is not None
    dim = shape.nodes.shape[1]
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0][:dim] * np.array([[0.02], [0.01], [0.005]])[:dim]
    at = np.array([0.3, -0.1, 0.2]) + shape.nodes @ turn
    if not straight:
        at += 4e-4 * rng.standard_normal(at.shape)
    numbers = 10 + np.arange(count)
    return Elements(dict(zip(numbers.tolist(), at, strict=True)), ((family, tuple(numbers.tolist())),)), at


@pytest.mark.parametrize(("family", "count"), KINDS)
@pytest.mark.parametrize("straight", [True, False])
def test_a_place_inside_is_found_and_a_linear_motion_is_exact(
    family: str, count: int, straight: bool, rng: np.random.Generator
) -> None:
    elements, at = placed(family, count, rng, straight=straight)
    shape = shape_of(family, count)
    assert shape is not None
    assert len(shape.powers) == count
    inside = shape.inside(shape.nodes.mean(axis=0) + 0.2 * rng.standard_normal(shape.nodes.shape[1]))
    point = shape.values(inside) @ at
    held = elements.find(point)
    assert held is not None
    assert held.distance < 1e-9
    assert held.weights.sum() == pytest.approx(1.0)
    gradient = rng.standard_normal(3)
    assert held.weights @ (at @ gradient) == pytest.approx(point @ gradient)
    along = np.linalg.lstsq(shape.slopes(inside) @ at, shape.slopes(inside) @ (at @ gradient), rcond=None)[0]
    assert held.slopes @ (at @ gradient) == pytest.approx(along, abs=1e-9)


@pytest.mark.parametrize(("family", "count"), [k for k in KINDS if k[1] in (10, 15, 20)])
def test_solids_with_middle_nodes_give_quadratic_motions(
    family: str, count: int, rng: np.random.Generator
) -> None:
    elements, at = placed(family, count, rng, straight=True)
    curve = rng.standard_normal((3, 3))
    point = at.mean(axis=0) + 1e-3 * rng.standard_normal(3)
    held = elements.find(point)
    assert held is not None
    assert held.weights @ np.einsum("ni,ij,nj->n", at, curve, at) == pytest.approx(point @ curve @ point)


def test_a_place_off_the_element_is_that_far_from_it(rng: np.random.Generator) -> None:
    """Above a shell, and beyond a corner."""
    square = np.array([(0, 0, 0), (0.1, 0, 0), (0.1, 0.1, 0), (0, 0.1, 0)])
    elements = Elements(dict(enumerate(square)), (("S", (0, 1, 2, 3)),))
    above = elements.find(np.array([0.03, 0.06, 0.002]))
    assert above is not None
    assert above.distance == pytest.approx(0.002)
    assert above.weights @ square[:, 0] == pytest.approx(0.03)
    beyond = elements.find(np.array([0.13, 0.14, 0.0]))
    assert beyond is not None
    assert beyond.distance == pytest.approx(0.05)
    assert shape_of("C3D", 7) is None
    assert Elements({}, ()).find(np.zeros(3)) is None
