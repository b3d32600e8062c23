"""The small basis against the full model, for every change a state can express."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from updating_cases import BEAM, PLATE, ExactBeam, blank

from updating import Predictor, Region, Spec, build_structure
from updating.effects.structure.clamp import edge_slopes
from updating.models.base import Structure
from updating.models.fields import Sparse
from updating.models.reduced import Reduced
from updating.models.soft_stretch import Profile, soft_stretch
from updating.models.state import NOMINAL, State, combine
from updating.models.whole import Whole

FINE = BEAM.with_elements(60)
POINTS = np.linspace(0.0752, 0.376, 5)
CORNERS = np.array([[x, y] for x in np.linspace(0.09, 0.376, 4) for y in (0.0, 0.1, 0.2)])
THIN = replace(FINE, theory="euler-bernoulli")
LOOK = {
    "timoshenko": Predictor(FINE, blank(POINTS)),
    "euler-bernoulli": Predictor(THIN, blank(POINTS)),
    "free": Predictor(replace(THIN, clamped=()), blank(POINTS)),
    "plate": Predictor(PLATE, blank(CORNERS)),
}
CLOSE = {"timoshenko": 1e-4, "euler-bernoulli": 1e-4, "free": 1e-4, "plate": 1e-3}
evaluation = pytest.mark.parametrize("name", list(LOOK))


def full(
    structure: Structure, state: dict[str, Sparse], released: frozenset[str] = frozenset()
) -> np.ndarray:
    """Frequencies of the full model with changed matrices [Hz]."""
    first = structure.rigid_modes
    values = structure.eigen(first + 6, **state, released=released)[0]  # type: ignore[arg-type]
    return np.asarray(np.sqrt(values[first:]) / (2 * np.pi))


def small(name: str, state: State) -> np.ndarray:
    return LOOK[name].predict(state, count=6).frequency


def reduced(name: str) -> tuple[Reduced, Structure]:
    return LOOK[name].reduced, LOOK[name].reduced.structure


@evaluation
def test_the_nominal_model_is_reduced_without_loss(name: str) -> None:
    basis, structure = reduced(name)
    assert small(name, NOMINAL) == pytest.approx(full(structure, {}), rel=1e-6)
    columns = basis.basis[:, : basis.ranks[frozenset({"translation"})] if structure.fixed else None]
    gram = (
        columns.T @ structure.matrix("mass") @ columns
    )  # those of a part of an edge stand behind, by themselves
    np.testing.assert_allclose(gram, np.eye(len(gram)), atol=1e-7)
    if name in ("timoshenko", "plate"):
        assert basis.basis.shape[1] < 0.75 * structure.fields.n_dofs


@evaluation
@settings(max_examples=12)
@given(u=st.integers(0, 4), share=st.floats(0.001, 0.5))
def test_a_mass_at_a_test_point(name: str, u: int, share: float) -> None:
    """Up to half the structure's mass, as the prior of the sensor's mass allows."""
    basis, structure = reduced(name)
    point = LOOK[name].measured.points[[u]]
    spec = structure.spec
    mass = share * spec.length * spec.width * spec.thickness * spec.material.density
    row, rows = structure.fields.at(point)["w"], basis.rows(point)["w"]
    found = small(name, State(mass=(mass * rows.T @ rows,)))
    expected = full(structure, {"mass": Sparse(structure.matrix("mass") + mass * (row.T @ row))})
    assert found[:5] == pytest.approx(expected[:5], rel=CLOSE[name])


@pytest.mark.parametrize("name", ["timoshenko", "euler-bernoulli", "free"])
@settings(max_examples=20)
@given(u=st.floats(0.03, 0.97), extent=st.floats(0.02, 0.15), loss=st.floats(0.05, 0.95))
def test_a_soft_spot_anywhere_on_a_beam(name: str, u: float, extent: float, loss: float) -> None:
    """On sixty elements, of which the basis joins some in a cell."""
    basis, structure = reduced(name)
    points = np.linspace(0.0, structure.spec.length, 4001)
    inside = np.abs(points / structure.spec.length - u) < extent / 2
    profile = Profile(points, np.full(4001, structure.spec.length / 4001), inside * loss / (1 - loss))
    found = small(name, State(stiffness=(soft_stretch(basis, profile, {}),)))
    softer = soft_stretch(Whole.of(basis), profile, {})
    expected = full(structure, {"stiffness": Sparse(structure.matrix("stiffness") + softer)})
    assert found[:5] == pytest.approx(expected[:5], rel=CLOSE[name])


def test_a_soft_region_of_a_plate() -> None:
    basis, structure = reduced("plate")
    for index in (0, 7, 14):
        state = State(regional={(index, "E"): 0.5})
        softening = np.where(structure.region_of == index, 0.5, 0.0)
        expected = full(structure, {"stiffness": structure.matrix("stiffness", 1 - softening)})
        assert small("plate", state)[:5] == pytest.approx(expected[:5], rel=2e-3)
        added = State(stiffness=(-basis.weighted("stiffness", softening),))
        assert small("plate", state) == pytest.approx(small("plate", added), rel=1e-9)


@pytest.mark.parametrize("name", ["timoshenko", "euler-bernoulli", "plate"])
@pytest.mark.parametrize("ratio", [0.3, 1.0, 10.0, 100.0, 2000.0])
def test_a_clamp_that_turns(name: str, ratio: float) -> None:
    """From nearly a hinge to what nothing can see, in units of E I / L."""
    basis, structure = reduced(name)
    spec = structure.spec
    width = spec.width if spec.kind == "beam" else 1.0
    spring = ratio * spec.material.E * width * spec.thickness**3 / 12 / spec.length
    held = spring * edge_slopes(structure)
    released = frozenset({"rotation"})
    found = small(name, State(stiffness=(basis.basis.T @ (held @ basis.basis),), released=released))
    expected = full(structure, {"stiffness": Sparse(structure.matrix("stiffness") + held)}, released)
    assert found[:5] == pytest.approx(expected[:5], rel=CLOSE[name])
    if spec.kind == "beam":
        shear = spec.theory == "timoshenko"
        size = (spec.length, spec.width, spec.thickness)
        exact = ExactBeam(*size, rotation=spring, shear=shear, rotary=shear).frequencies(5)
        assert found[:5] == pytest.approx(exact, rel=1e-4)


@pytest.mark.parametrize("name", ["timoshenko", "euler-bernoulli"])
@pytest.mark.parametrize("ratio", [3.0, 100.0, 1e4])
def test_a_clamp_that_shifts_and_turns(name: str, ratio: float) -> None:
    basis, structure = reduced(name)
    spec = structure.spec
    spring = ratio * spec.material.E * spec.width * spec.thickness**3 / 12 / spec.length**3
    row = basis.rows(np.zeros((1, 1)))["w"]
    turning = basis.basis.T @ (edge_slopes(structure) @ basis.basis)
    both = frozenset({"rotation", "translation"})
    given_way = spring * spec.length**2 / 50
    state = State(stiffness=(spring * row.T @ row, given_way * turning), released=both)
    shear = spec.theory == "timoshenko"
    exact = ExactBeam(
        *(spec.length, spec.width, spec.thickness),
        translation=spring,
        rotation=given_way,
        shear=shear,
        rotary=shear,
    )
    assert small(name, state)[:5] == pytest.approx(exact.frequencies(5), rel=1e-4)


@evaluation
@pytest.mark.parametrize("stretch", [0.94, 1.12])
def test_a_stretched_structure(name: str, stretch: float) -> None:
    """Over the range of the prior of the length."""
    spec = LOOK[name].spec
    structure = build_structure(replace(spec, length=stretch * spec.length, regions=()))
    found = small(name, State(factors={"length": stretch}))
    assert found[:5] == pytest.approx(full(structure, {})[:5], rel=CLOSE[name])


def test_a_factor_of_a_region_multiplies_what_the_region_has() -> None:
    half = (Region("a", (0.0, 0.188), E=200e9), Region("b", (0.188, 0.376)))
    spec: Spec = replace(THIN, regions=half)
    softer = replace(spec, regions=(replace(half[0], E=150e9), half[1]))
    found = Predictor(spec, blank(POINTS)).predict(State(regional={(0, "E"): 0.75}), count=4).frequency
    assert found == pytest.approx(full(build_structure(softer), {})[:4], rel=1e-4)


numbers = st.floats(0.5, 2.0)
matrices = st.lists(numbers.map(lambda v: v * np.eye(2)), max_size=2).map(tuple)
states = st.builds(
    State,
    factors=st.dictionaries(st.sampled_from(["E", "density", "length"]), numbers, max_size=2),
    regional=st.dictionaries(st.sampled_from([(0, "E"), (1, "density")]), numbers, max_size=2),
    stiffness=matrices,
    mass=matrices,
    damping=matrices,
    released=st.sets(st.sampled_from(["rotation", "translation"])).map(frozenset),
    theory=st.sampled_from([None, "rayleigh", "timoshenko"]),
    gain=numbers,
    decay=numbers,
)


def alike(a: State, b: State) -> None:
    assert dict(a.factors) == pytest.approx(dict(b.factors))
    assert dict(a.regional) == pytest.approx(dict(b.regional))
    for name in ("stiffness", "mass", "damping"):
        assert [id(m) for m in getattr(a, name)] == [id(m) for m in getattr(b, name)]
    assert (a.released, a.theory) == (b.released, b.theory)
    assert (a.gain, a.decay) == pytest.approx((b.gain, b.decay))


@given(a=states, b=states, c=states)
def test_departures_add_up_in_any_grouping(a: State, b: State, c: State) -> None:
    alike(a.plus(b).plus(c), a.plus(b.plus(c)))
    alike(combine([a, b, c]), a.plus(b).plus(c))
    alike(a.plus(NOMINAL), a)
    alike(NOMINAL.plus(a), a)


def test_departures_multiply_factors_and_keep_their_own() -> None:
    first = State(factors={"E": 2.0}, gain=3.0, decay=1.0)
    both = first.plus(State(factors={"E": 4.0, "width": 5.0}, gain=2.0, decay=2.0))
    assert (dict(both.factors), both.gain, both.decay) == ({"E": 8.0, "width": 5.0}, 6.0, 3.0)
    assert dict(first.factors) == {"E": 2.0}


def test_matrices_are_symmetric() -> None:
    basis = LOOK["timoshenko"].reduced
    for matrix in basis.matrices(NOMINAL):
        np.testing.assert_allclose(matrix, matrix.T, atol=1e-9 * np.abs(matrix).max())
    assert sparse.issparse(edge_slopes(basis.structure))
