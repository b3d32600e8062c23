"""Beams and plates against analytic roots, exact transfer matrices, published tables and each other."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import BEAM, PLATE, STEEL, ExactBeam, blank

from acquisition.errors import StudyError
from updating import PointMass, Predictor, Region, Spec, build_structure
from updating.models.state import State

SLENDER = Spec(
    "beam",
    length=1.0,
    width=0.02,
    thickness=0.005,
    elements=(40,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=STEEL,
)
THICK = Spec(
    "beam",
    length=0.5,
    width=0.03,
    thickness=0.05,
    elements=(60,),
    clamped=("x0",),
    theory="timoshenko",
    material=STEEL,
)


def frequencies(spec: Spec, count: int) -> np.ndarray:
    """Elastic frequencies of the full model [Hz]."""
    structure = build_structure(spec)
    values = structure.eigen(structure.rigid_modes + count)[0][structure.rigid_modes :]
    return np.sqrt(values) / (2 * np.pi)


def exact(spec: Spec, count: int) -> np.ndarray:
    theory = {"shear": spec.theory == "timoshenko", "rotary": spec.theory != "euler-bernoulli"}
    beam = ExactBeam(spec.length, spec.width, spec.thickness, clamped=bool(spec.clamped), **theory)
    return beam.frequencies(count)


@pytest.mark.parametrize(
    ("clamped", "roots"),
    [
        (("x0",), [1.87510407, 4.69409113, 7.85475744, 10.99554073]),
        (("x1",), [1.87510407, 4.69409113, 7.85475744, 10.99554073]),
        ((), [4.73004074, 7.85320462, 10.9956079, 14.1371655]),
        (("x0", "x1"), [4.73004074, 7.85320462, 10.9956079, 14.1371655]),
    ],
)
def test_euler_bernoulli_has_the_textbook_roots(clamped: tuple[str, ...], roots: list[float]) -> None:
    spec = replace(SLENDER, clamped=clamped, elements=(80,))
    unit = np.sqrt(STEEL.E * spec.thickness**2 / 12 / STEEL.density) / spec.length**2 / (2 * np.pi)
    assert frequencies(spec, 4) == pytest.approx(np.array(roots) ** 2 * unit, rel=2e-6)


@pytest.mark.parametrize("theory", ["euler-bernoulli", "rayleigh", "timoshenko"])
@pytest.mark.parametrize("clamped", [(), ("x0",)])
def test_every_theory_has_the_roots_of_its_differential_equation(
    theory: str, clamped: tuple[str, ...]
) -> None:
    spec = replace(THICK, theory=theory, clamped=clamped)
    assert frequencies(spec, 5) == pytest.approx(exact(spec, 5), rel=2e-5)


def test_shear_matters_in_a_thick_beam_and_vanishes_in_a_slender_one() -> None:
    for slenderness, least, most in ((10, 0.1, 1.0), (1000, 0.0, 5e-5)):
        spec = replace(SLENDER, thickness=SLENDER.length / slenderness, elements=(80,))
        fall = 1 - frequencies(spec.with_theory("timoshenko"), 4) / frequencies(spec, 4)
        assert least < fall[-1] < most


def test_the_papers_beam_has_the_papers_frequencies() -> None:
    drawing = replace(BEAM, theory="euler-bernoulli", elements=(10,))
    assert frequencies(drawing, 3) == pytest.approx([28.146, 176.393, 494.015], rel=1e-4)
    shorter = replace(BEAM, theory="rayleigh", length=0.375, regions=(), elements=(40,))
    assert frequencies(shorter, 3) == pytest.approx([28.30, 177.31, 496.32], rel=3e-4)


def test_the_papers_plate_has_the_before_column_of_table_3() -> None:
    printed = [19.26, 78.61, 119.99, 257.71, 336.29, 464.91, 500.95, 675.88, 835.91, 936.94, 1107.68]
    found = np.delete(frequencies(PLATE.with_elements(38, 20), 12), 7)
    assert found == pytest.approx(printed, rel=2e-3)


@pytest.mark.parametrize(
    ("clamped", "values"),
    [
        ((), [13.468, 19.596, 24.270, 34.801, 34.801, 61.093]),
        (("x0",), [3.4711, 8.5066, 21.285, 27.199, 30.956, 54.187]),
        (("x0", "x1", "y0", "y1"), [35.985, 73.394, 73.394, 108.22, 131.58, 132.20]),
    ],
)
def test_square_plates_have_the_published_eigenvalues(clamped: tuple[str, ...], values: list[float]) -> None:
    """Leissa (1973), the free edges after Gorman and Liew, who converge a little lower than his Ritz bounds."""
    spec = Spec(
        "plate",
        length=0.3,
        width=0.3,
        thickness=0.002,
        elements=(16, 16),
        clamped=clamped,
        theory="kirchhoff",
        material=STEEL,
    )
    rigidity = STEEL.E * spec.thickness**3 / (12 * (1 - STEEL.poisson**2))
    unit = np.sqrt(rigidity / (STEEL.density * spec.thickness)) / spec.length**2 / (2 * np.pi)
    assert frequencies(spec, 6) == pytest.approx(np.array(values) * unit, rel=1e-3)


@pytest.mark.parametrize(("spec", "count"), [(SLENDER, 2), (THICK, 2), (PLATE, 3)])
def test_a_free_structure_has_its_rigid_body_modes(spec: Spec, count: int) -> None:
    structure = build_structure(replace(spec, clamped=()))
    values = structure.eigen(count + 1)[0]
    assert structure.rigid_modes == count
    assert np.abs(values[:count]).max() < 1e-6 * values[count]
    assert build_structure(spec).rigid_modes == 0


@pytest.mark.parametrize("spec", [BEAM, replace(BEAM, theory="rayleigh"), PLATE])
@pytest.mark.parametrize("kind", ["stiffness", "mass"])
def test_the_regions_matrices_sum_to_the_whole(spec: Spec, kind: str) -> None:
    structure = build_structure(spec)
    masks = [(structure.region_of == i).astype(float) for i in range(len(spec.regions))]
    total = sum(structure.matrix(kind, mask).toarray() for mask in masks)
    whole = structure.matrix(kind).toarray()
    np.testing.assert_allclose(total, whole, atol=1e-12 * np.abs(whole).max())


@pytest.mark.parametrize("spec", [BEAM, PLATE])
def test_a_point_mass_is_counted_once_and_by_no_region(spec: Spec) -> None:
    heavy = replace(spec, masses=(PointMass((0.2, 0.11)[: spec.dim], 0.5),), clamped=())
    structure = build_structure(heavy)
    lift = np.zeros(structure.fields.n_dofs)
    for component in structure.fields.components[:1]:
        lift[component.basis.get_dofs(elements=True).nodal["u"]] = 1.0
    mass = spec.length * spec.width * spec.thickness * STEEL.density
    assert lift @ structure.matrix("mass") @ lift == pytest.approx(mass + 0.5, rel=1e-10)
    assert np.abs(structure.matrix("stiffness") @ lift).max() < 1e-6


def test_regions_with_properties_of_their_own() -> None:
    """Half of a free beam doubled in every way is a beam whose mass and stiffness matrices add up."""
    halves = (Region("a", (0.0, 0.5)), Region("b", (0.5, 1.0), area=2e-4, inertia=4e-10, E=1e11, density=4e3))
    structure = build_structure(replace(SLENDER, regions=halves))
    right = (structure.region_of == 1).astype(float)
    plain = build_structure(SLENDER)
    ratio = (1e11 * 4e-10) / (STEEL.E * 0.02 * 0.005**3 / 12)
    expected = plain.matrix("stiffness", 1 + (ratio - 1) * right).toarray()
    np.testing.assert_allclose(structure.matrix("stiffness").toarray(), expected, rtol=1e-9, atol=1e-6)
    ratio = (4e3 * 2e-4) / (STEEL.density * 0.02 * 0.005)
    expected = plain.matrix("mass", 1 + (ratio - 1) * right).toarray()
    np.testing.assert_allclose(structure.matrix("mass").toarray(), expected, rtol=1e-9, atol=1e-15)


factor = st.floats(0.6, 1.6)
LOOK = Predictor(replace(SLENDER, elements=(20,)), blank(np.linspace(0.2, 1.0, 5), top=100.0))


@settings(max_examples=25)
@given(modulus=factor, density=factor, thickness=factor, width=factor, length=factor)
def test_eigenvalues_of_a_uniform_beam_grow_by_their_powers(
    modulus: float, density: float, thickness: float, width: float, length: float
) -> None:
    names = {"E": modulus, "density": density, "thickness": thickness, "width": width, "length": length}
    ratio = LOOK.predict(State(factors=names), count=5).frequency / LOOK.predict(count=5).frequency
    expected = modulus * thickness**2 / density / length**4
    assert ratio**2 == pytest.approx(np.full(5, expected), rel=1e-7)


@pytest.mark.parametrize("spec", [THICK.with_elements(20), replace(BEAM, theory="rayleigh"), PLATE])
@pytest.mark.parametrize("name", ["E", "density", "thickness", "width", "length"])
def test_the_powers_do_what_building_another_structure_does(spec: Spec, name: str) -> None:
    material = name in ("E", "density")
    if material:
        changed = replace(spec, material=replace(STEEL, **{name: 1.2 * getattr(STEEL, name)}))
    else:
        changed = replace(spec, **{name: 1.2 * getattr(spec, name)}, regions=())
    whole = build_structure(spec)
    terms = tuple(replace(t, coefficient=t.coefficient * t.scale({name: 1.2})) for t in whole.terms)
    found = replace(whole, terms=terms).eigen(6)[0]
    assert found == pytest.approx((2 * np.pi * frequencies(changed, 6)) ** 2, rel=1e-7)


TRUE = ExactBeam(1.0, 0.02, 0.005, shear=False, rotary=False)
ROOTS = TRUE.frequencies(3)


@settings(max_examples=15)
@given(x=st.floats(0.01, 0.99))
def test_displacement_and_slope_can_be_asked_for_anywhere(x: float) -> None:
    structure = build_structure(SLENDER)
    _, vectors = structure.eigen(3)
    shape = TRUE.shapes(ROOTS, np.array([x - 1e-3, x, x + 1e-3, 1.0]))
    rows = structure.fields.at(np.array([[x]]))
    found, slope = (rows["w"] @ vectors)[0], (rows["wx"] @ vectors)[0]
    sign = np.sign(np.sum((structure.fields.at(np.array([[1.0]]))["w"] @ vectors), axis=0))
    sign = sign * np.sign(shape[3])
    scale = np.abs(shape[3]).max()
    assert sign * found == pytest.approx(shape[1], abs=1e-4 * scale)
    assert sign * slope == pytest.approx((shape[2] - shape[0]) / 2e-3, abs=1e-2 * scale)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"length": 0.0}, "length must be positive"),
        ({"clamped": ("y0",)}, "no edge"),
        ({"theory": "kirchhoff"}, "no theory"),
        ({"elements": (4, 4)}, "elements"),
        ({"elements": (0,)}, "elements"),
    ],
)
def test_a_structure_that_cannot_be_is_refused(change: dict[str, object], says: str) -> None:
    with pytest.raises(StudyError, match=says):
        replace(BEAM, **change)


def test_a_region_off_the_structure_and_too_many_modes_are_refused() -> None:
    with pytest.raises(StudyError, match="region 'far'"):
        build_structure(replace(BEAM, regions=(Region("far", (1.0, 2.0)),)))
    with pytest.raises(StudyError, match="more elements"):
        build_structure(replace(SLENDER, elements=(2,))).eigen(5)
