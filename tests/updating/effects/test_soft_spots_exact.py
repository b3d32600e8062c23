"""Soft places of beams, plates and matrices beside finer models and other effects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from effect_cases import CHANGES, CORNERS, LOOK, imported
from exact_cases import SIZE, predicted
from imported_cases import beam_matrices, clamp
from scipy import linalg, optimize
from updating_cases import PLATE, ExactBeam, blank

from updating import LIBRARY, Predictor
from updating.effects.box import SOFT, shares
from updating.models import FieldStructure, Region
from updating.models.fields import Sparse
from updating.models.softening import Softening
from updating.models.state import State


@pytest.mark.parametrize(
    ("extent", "loss"), [(0.03, 0.3), (0.03, 0.7), (0.03, -1.5), (0.1, 0.6), (0.1, -0.5), (0.1, -9.0)]
)
def test_a_box_has_the_frequencies_of_one_with_sharp_edges(extent: float, loss: float) -> None:
    """By transfer matrices: the sketch at its best extent and loss, whose edges are soft, within its fidelity."""
    effect, predictor = LIBRARY["local_stiffness"], LOOK["beam"]
    ends = 0.15 - extent / 2, 0.15 + extent / 2
    exact = ExactBeam(*SIZE, soft=(*ends, loss), shear=False, rotary=False).frequencies(5)
    plain = ExactBeam(*SIZE, shear=False, rotary=False).frequencies(5)
    start = effect.quantiles(predictor, {"x": 0.15, "extent": extent, "loss": loss})

    def off(turned: np.ndarray) -> np.ndarray:
        values = effect.values(predictor, [start[0], *turned])
        return (predicted("local_stiffness", "beam", **values) - exact) / np.abs(exact - plain).max()

    half = (0.5, 1.0) if loss > 0 else (0.0, 0.5)
    found = optimize.least_squares(
        off, np.clip(start[1:], 0.02, 0.98), bounds=([0.0, half[0]], [1.0, half[1]]), diff_step=1e-3
    )
    assert np.abs(found.fun).max() < effect.fidelity
    compliance = effect.derived(predictor, effect.values(predictor, [start[0], *found.x]))["compliance"][0]
    assert compliance == pytest.approx(extent * loss / (1 - loss), rel=0.05)


@pytest.mark.parametrize(
    ("extent", "loss"), [(0.01, 0.9), (0.03, 0.7), (0.03, -1.5), (0.1, 0.6), (0.1, -0.5), (0.1, -9.0)]
)
@pytest.mark.parametrize("elements", [20, 40])
def test_a_stretch_shorter_than_an_element_is_as_soft_as_it_is(
    elements: int, extent: float, loss: float
) -> None:
    """By transfer matrices, as it stands: the mesh of the beam does not matter."""
    predictor = Predictor(replace(LOOK["beam"].spec, elements=(elements,)), LOOK["beam"].measured)
    place = 0.17
    ends = place - extent / 2, place + extent / 2
    exact = ExactBeam(*SIZE, soft=(*ends, loss), shear=False, rotary=False).frequencies(5)
    plain = ExactBeam(*SIZE, shear=False, rotary=False).frequencies(5)
    state = LIBRARY["local_stiffness"].state(predictor, {"x": place, "extent": extent, "loss": loss})
    found = predictor.predict(state, count=5).frequency / predictor.predict(count=5).frequency
    assert found - 1 == pytest.approx(exact / plain - 1, abs=0.02 * np.abs(exact / plain - 1).max())


SPOTS = (
    (0.13, 0.5, 0.13, 0.244, 0.7),
    (0.53, 0.15, 0.10, 0.19, 0.8),
    (0.27, 0.9, 0.08, 0.15, 0.85),
    (0.4, 0.5, 0.03, 0.06, 0.95),
    (0.0, 0.4, 0.1, 0.19, 0.85),
    (0.66, 1.0, 0.15, 0.28, 0.8),
    (0.5, 0.5, 0.4, 0.4, 0.6),
    (0.66, 0.3, 0.03, 0.4, 0.95),
    (0.2, 0.8, 0.4, 0.1, -1.0),
    (0.5, 0.5, 0.33, 0.33, -4.0),
    (0.3, 0.4, 0.1, 0.2, -9.0),
)
"""Places, extents (in lengths and widths) and losses; none has more compliance than the prior admits."""


def spotted(predictor: Predictor, spot: tuple[float, ...]) -> dict[str, float]:
    length, width = predictor.spec.length, predictor.spec.width
    sizes = {"extent": spot[2] * length, "extent_y": spot[3] * width}
    return {"x": spot[0] * length, "y": spot[1] * width, **sizes, "loss": spot[4]}


def off_by(predictor: Predictor, spot: dict[str, float], beside: dict[str, dict[str, float]]) -> float:
    """Worst error of twelve modes on the basis beside full matrices that resolve it, in shares of the spot's shift."""
    structure = predictor.reduced.structure
    assert isinstance(structure, FieldStructure)
    structure = structure.finer
    k, m, released, state = structure.matrix("stiffness"), structure.matrix("mass"), frozenset[str](), State()
    for name, values in beside.items():
        change = CHANGES[name](structure, values)
        k, m = Sparse(k + change.get("stiffness", 0 * k)), Sparse(m + change.get("mass", 0 * m))
        released |= change.get("released", frozenset())
        state = state.plus(LIBRARY[name].state(predictor, values))
    first = structure.rigid_modes
    soft = CHANGES["local_stiffness"](structure, spot)["stiffness"]
    full = [
        np.sqrt(structure.eigen(first + 12, stiffness=Sparse(s), mass=m, released=released)[0][first:])
        for s in (k, k + soft)
    ]
    states = (state, state.plus(LIBRARY["local_stiffness"].state(predictor, spot)))
    found = [predictor.predict(s, count=12).frequency * 2 * np.pi for s in states]
    shift = np.abs(np.log(full[1] / full[0]))
    return float(np.abs(np.log(found[1] / found[0]) - np.log(full[1] / full[0])).max() / shift.max())


@pytest.fixture(scope="module")
def cantilever() -> Predictor:
    return Predictor(replace(PLATE, elements=(20, 10)), blank(CORNERS))


@pytest.mark.parametrize("spot", SPOTS)
def test_curvature_gathers_in_a_soft_spot_of_a_plate(cantilever: Predictor, spot: tuple[float, ...]) -> None:
    assert off_by(cantilever, spotted(cantilever, spot), {}) < 0.02


@pytest.mark.long
def test_a_soft_spot_of_a_free_plate() -> None:
    free = Predictor(replace(PLATE, elements=(20, 10), clamped=()), blank(CORNERS))
    assert max(off_by(free, spotted(free, spot), {}) for spot in SPOTS) < 0.03


@pytest.mark.long
@pytest.mark.parametrize(
    ("beside", "most"),
    [
        ({"sensor_mass": {"mass": 0.02}}, 0.02),
        ({"clamp_rotation": {"stiffness": 200.0}}, 0.03),
        ({"clamp_translation": {"stiffness": 1e6}}, 0.06),
        ({"clamp_rotation": {"stiffness": 200.0}, "clamp_translation": {"stiffness": 1e6}}, 0.06),
    ],
    ids=["sensor", "turning", "shifting", "both"],
)
def test_a_soft_spot_beside_another_effect(
    cantilever: Predictor, beside: dict[str, dict[str, float]], most: float
) -> None:
    """About the fidelity where a clamp is released, too, unless the spot lies on the clamp itself."""
    assert most <= 1.2 * LIBRARY["local_stiffness"].fidelity
    away = [spot for spot in SPOTS if spot[0] > 0]
    assert max(off_by(cantilever, spotted(cantilever, spot), beside) for spot in away) < most


def test_a_soft_spot_follows_the_modulus_of_the_plate_it_is_in(cantilever: Predictor) -> None:
    """An accepted factor of E stiffens the place and its surroundings alike: all frequencies scale by its root."""
    spot = spotted(cantilever, SPOTS[2])
    stiffer = cantilever.for_test(cantilever.measured, (lambda _: State(factors={"E": 1.3}),))
    both = [p.predict(LIBRARY["local_stiffness"].state(p, spot), count=8) for p in (cantilever, stiffer)]
    assert both[1].frequency == pytest.approx(np.sqrt(1.3) * both[0].frequency, rel=1e-9)


def test_a_plate_that_is_its_own_basis_lacks_nothing() -> None:
    reduced = Predictor(replace(PLATE, elements=(4, 3)), blank(CORNERS)).reduced
    structure, spot = reduced.fielded, {"x": 0.05, "y": 0.1, "extent": 0.05, "extent_y": 0.05}
    inside = shares(structure, spot, soft=SOFT)
    found = Softening(reduced, structure, reduced.basis).change(inside, 0.7, {})
    plain = -reduced.weighted("stiffness", 0.7 * inside)
    n = reduced.ranks[frozenset()]
    assert n == structure.unknowns
    assert found[:n, :n] == pytest.approx(plain[:n, :n], abs=1e-9 * np.abs(plain[:n, :n]).max())


@pytest.mark.long
def test_a_soft_place_hardly_depends_on_the_mesh_of_a_plate() -> None:
    """Of an eighth of the sides, beside a mesh of 54 x 32 elements."""
    spot = {"x": 0.16, "y": 0.08, "extent": 0.045, "extent_y": 0.025, "loss": 0.8}

    def shifts(elements: tuple[int, int]) -> np.ndarray:
        predictor = Predictor(replace(PLATE, elements=elements), blank(CORNERS))
        state = LIBRARY["local_stiffness"].state(predictor, spot)
        return np.log(predictor.predict(state, count=6).frequency / predictor.predict(count=6).frequency)

    fine = shifts((54, 32))
    for elements in ((12, 10), (20, 14), (27, 16)):
        assert shifts(elements) == pytest.approx(fine, abs=0.06 * np.abs(fine).max())


def test_regions_of_imported_matrices_soften_and_damp() -> None:
    predictor = LOOK["matrices"]
    for name in ("local_stiffness", "damping_patch"):
        effect = LIBRARY[name]
        assert {v.values["region"] for v in effect.variants(predictor)} == {f"part{i}" for i in (1, 2, 3, 4)}
    k, m = (clamp(a) for a in beam_matrices(20))
    for loss in (0.4, -4.0):
        state = LIBRARY["local_stiffness"].state(predictor, {"region": "part2", "loss": loss})
        lost = loss * clamp(beam_matrices(20, 5, 10)[0])
        exact = np.sqrt(linalg.eigh((k - lost).toarray(), m.toarray(), eigvals_only=True)[:4]) / (2 * np.pi)
        assert predictor.predict(state, count=4).frequency == pytest.approx(exact, rel=1e-6)
    layer = {"region": 2, "loss_factor": 0.02, "mass": 0.1, "stiffness": 0.0}
    covered = predictor.predict(LIBRARY["damping_patch"].state(predictor, layer), count=4)
    assert (covered.frequency < predictor.predict(count=4).frequency).all()


def test_matrices_without_parts_say_why_nothing_softens() -> None:
    spec = replace(imported().spec, regions=())
    whole = replace(spec.imported, stiffness_parts=(), mass_parts=())  # type: ignore[type-var]
    predictor = Predictor(
        replace(spec, imported=whole, regions=(Region("all", (0, 1), (0, 1)),)), LOOK["matrices"].measured
    )
    for name in ("local_stiffness", "damping_patch"):
        assert "stiffness_parts" in str(LIBRARY[name].why_not(predictor))
