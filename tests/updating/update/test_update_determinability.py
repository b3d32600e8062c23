"""What data determine is said, and what they do not is named; bad input is refused in one line."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, EstimationError, Geometry, ModalData, StudyError
from updating import Axes, Case, Material, Region, Spec, Tolerances, build_structure, measured_from_modes
from updating.update import update
from updating.update.statistics.identifiability import best_subset

STEEL = Material(210e9, 7850.0, 0.3)
PARTS = (Region("root", (0.0, 0.1)), Region("middle", (0.1, 0.25)), Region("tip", (0.25, 0.4)))
BEAM = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(12,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=STEEL,
    regions=PARTS,
)
DOUBTS = Tolerances({"E": 0.3, "density": 0.3, "thickness": 0.3})


def frequencies(spec: Spec, count: int = 6) -> np.ndarray:
    return np.sqrt(build_structure(spec).eigen(count)[0]) / (2 * np.pi)


def case_of(measured: np.ndarray, doubts: Tolerances = DOUBTS, spec: Spec = BEAM) -> Case:
    data = ModalData(frequency=measured, frequency_sigma=1e-3 * measured)
    return Case(
        "bar",
        spec,
        measured_from_modes(data, Axes(), spec, repeatability=0.0),
        baseline=None,
        tolerances=doubts,
    )


def softer_root() -> np.ndarray:
    return frequencies(replace(BEAM, regions=(replace(PARTS[0], E=0.8 * 210e9), *PARTS[1:])))


def test_modulus_and_density_of_everything_are_a_pair_of_which_the_ratio_is_known() -> None:
    result = update(case_of(frequencies(BEAM)), parameters=["E", "density"])
    assert result.undetermined == ("E", "density")
    assert result.determinability is not None
    (pair,) = result.determinability.couplings
    assert pair.parameters == ("E", "density")
    assert pair.determined[0] in ("E / density", "density / E")
    # ln f = (ln E - ln density) / 2, six frequencies known to 1e-3 each
    assert pair.sigma[0] == pytest.approx(2e-3 / np.sqrt(6), rel=1e-3)
    for p in result.parameters:  # what is left of a tolerance of 0.3 when only the ratio is known
        assert p.sigma / p.value == pytest.approx(0.3 / np.sqrt(2), rel=1e-3)


def test_three_properties_leave_two_directions_open_and_one_power_law() -> None:
    plain = replace(BEAM, regions=())
    result = update(case_of(frequencies(plain), spec=plain), parameters=["E", "density", "thickness"])
    assert result.determinability is not None
    (group,) = result.determinability.couplings
    assert len(group.determined) == 1
    # f goes with thickness (E / density)^(1/2)
    assert "thickness" in group.determined[0]
    assert "^0.5" in group.determined[0]
    assert np.sum(result.determinability.singular_values > 1) == 1


def test_regions_that_frequencies_tell_apart_are_not_called_undetermined() -> None:
    result = update(case_of(softer_root()), parameters=["root.E", "tip.density"])
    assert result.undetermined == ()
    assert result.determinability is not None
    assert result.determinability.couplings == ()
    assert np.all(result.determinability.alone < 1)


def test_the_parameter_that_was_changed_explains_the_residual_best() -> None:
    names = ["middle.E", "tip.density", "root.E"]
    result = update(case_of(softer_root()), parameters=names)
    assert result.determinability is not None
    assert result.determinability.subset[0] == "root.E"
    assert result.determinability.explained[0] > 0.98


def test_best_subset_is_orthogonal_matching() -> None:
    columns = np.array([[1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    order, explained = best_subset(columns, np.array([9.0, 0.5, 5.0]))
    assert order == (0, 2)  # 0.25 left over, less than noise gives
    assert explained == pytest.approx((81 / 106.25, 106 / 106.25))


def test_the_report_says_what_a_fit_says() -> None:
    text = update(case_of(softer_root()), parameters=["E", "density", "root.E"]).report()
    for message in ("[[Fit statistics]]", "reduced chi-square", "+-", "init 2.1e+11", "C(E, density)"):
        assert message in text
    assert "E, density: the data determine only" in text
    assert "NOT DETERMINED" in text


def test_a_value_at_its_bound_is_flagged() -> None:
    result = update(case_of(frequencies(BEAM) * 6.0), parameters=["E"], weights="relative")
    assert result.parameters[0].at_bound
    assert "AT BOUND" in result.report()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"parameters": ["E", "length", "root.E", "middle.E", "tip.E"], "weights": "relative"}, "5 parameters"),
        ({"parameters": ["E"], "shared": ["length"]}, "'length'"),
        ({"parameters": ["E"], "weights": [1.0, 2.0]}, "2 weights for 3"),
        ({"parameters": ["E"], "weights": [1.0, -2.0, 1.0]}, "none negative"),
        ({"parameters": ["nose.E"]}, "'nose.E'"),
        ({"parameters": []}, "no parameters"),
        ({"parameters": ["E", "E"]}, "is given twice"),
        ({"parameters": ["E"], "data": ["shapes"]}, "no frequencies"),
        ({"parameters": ["E"], "data": ["frequencies", "sound"]}, "sound"),
        ({"parameters": ["E"], "data": ["frequencies", "shapes"]}, "no shapes were measured"),
    ],
)  # fmt: skip
def test_bad_input_is_refused_in_one_line(options: dict[str, object], message: str) -> None:
    with pytest.raises(StudyError, match=message) as refused:
        update(case_of(frequencies(BEAM, 3)), **options)  # type: ignore[arg-type]
    assert "\n" not in str(refused.value)


def shapes_at(dofs: tuple[Dof, ...], shapes: np.ndarray) -> Case:
    geometry = Geometry(
        tuple(range(1, len(dofs) + 1)),
        np.column_stack([np.linspace(0, 0.4, len(dofs)), np.zeros((len(dofs), 2))]),
    )
    data = ModalData(
        frequency=np.array([200.0]),
        frequency_sigma=np.array([1.0]),
        dofs=dofs,
        shapes=shapes[:, None],
        geometry=geometry,
    )
    return Case("bar", BEAM, measured_from_modes(data, Axes(), BEAM), baseline=None, tolerances=DOUBTS)


def test_no_common_mode_is_said() -> None:
    dofs = tuple(Dof(i + 1, 3) for i in range(9))
    # a shape that changes its sign from point to point is none of a clamped beam's lowest
    with pytest.raises(EstimationError, match="no measured mode has a partner") as refused:
        update(shapes_at(dofs, (-1.0) ** np.arange(9)), parameters=["E"], weights="relative")
    assert "\n" not in str(refused.value)


def test_a_frequency_far_from_all_of_the_model_is_none_of_its_modes() -> None:
    data = ModalData(frequency=np.array([1e6]), frequency_sigma=np.array([1.0]))
    case = Case("bar", BEAM, measured_from_modes(data, Axes(), BEAM), baseline=None, tolerances=DOUBTS)
    with pytest.raises(EstimationError, match="no modes in common"):
        update(case, parameters=["E"], weights="relative")


def test_tolerances_that_the_data_contradict_are_not_trusted() -> None:
    """One per cent of doubt and a modulus a quarter off: what only the tolerance holds is uncertain by as much."""
    tight = Tolerances({"E": 0.01, "density": 0.01})
    result = update(case_of(np.sqrt(0.75) * frequencies(BEAM), tight), parameters=["E", "density"])
    assert any("tolerances from its nominal value" in w for w in result.warnings)
    truth = {"E": 0.75 * 210e9, "density": 7850.0}
    for p in result.parameters:
        assert abs(p.value - truth[p.name]) < 2 * p.sigma
    calm = update(case_of(frequencies(BEAM), tight), parameters=["E", "density"])
    assert not any("contradict" in w for w in calm.warnings)
    assert max(p.sigma / p.value for p in calm.parameters) < 0.01


def test_damping_is_no_parameter_of_frequencies() -> None:
    with pytest.raises(StudyError, match=r"root\.alpha is a coefficient of damping"):
        update(case_of(frequencies(BEAM)), parameters=["E", "root.alpha"])
