"""Weights, regularisation, determinability and refusals of the update, against closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import ModalData, StudyError
from updating import Axes, Case, Material, Spec, Tolerances, build_structure, measured_from_modes
from updating.update import Update, update

STEEL = Material(210e9, 7850.0, 0.3)
BEAM = Spec(
    "beam",
    length=0.376,
    width=0.0305,
    thickness=0.0047625,
    elements=(10,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=STEEL,
)
MEASURED = np.array([24.47, 153.96, 429.15])
NOMINAL = np.sqrt(build_structure(BEAM).eigen(3)[0]) / (2 * np.pi)
RATIO = NOMINAL / MEASURED


def case_of(measured: np.ndarray = MEASURED, sigma: np.ndarray | float = 0.001, **tolerances: float) -> Case:
    data = ModalData(frequency=measured, frequency_sigma=sigma * measured)
    return Case(
        "beam",
        BEAM,
        measured_from_modes(data, Axes(), BEAM, repeatability=0.0),
        baseline=None,
        tolerances=Tolerances(tolerances),
    )


def factor_of(result: Update) -> float:
    assert result.parameters[0].factor is not None
    return result.parameters[0].factor


def test_relative_weights_are_least_squares_of_relative_frequency() -> None:
    expected = (RATIO.sum() / (RATIO @ RATIO)) ** 2
    assert factor_of(update(case_of(), weights="relative")) == pytest.approx(expected, rel=1e-7)


def test_eigenvalue_weights_are_least_squares_of_eigenvalues() -> None:
    expected = (MEASURED**2 @ NOMINAL**2) / (NOMINAL**2 @ NOMINAL**2)
    assert factor_of(update(case_of(), weights="eigenvalue")) == pytest.approx(expected, rel=1e-7)


def test_listed_weights_weigh_each_mode_and_zero_leaves_it_out() -> None:
    w = np.array([1.0, 0.0, 3.0])
    expected = ((w @ RATIO) / (w @ RATIO**2)) ** 2
    result = update(case_of(), weights=w.tolist())
    assert factor_of(result) == pytest.approx(expected, rel=1e-7)
    assert result.pairs["used"].tolist() == [True, False, True]


def test_covariance_weights_follow_the_measured_sigmas_and_the_tolerance_regularises() -> None:
    sigma = np.array([0.02, 0.005, 0.01])
    w = 1 / sigma**2
    root = (w @ RATIO) / (w @ RATIO**2)
    assert factor_of(update(case_of(sigma=sigma))) == pytest.approx(root**2, rel=1e-7)
    held = update(case_of(sigma=sigma, E=0.02))
    # stationary point of sum w (1 - c q)^2 + (ln c^2)^2 / 0.02^2, Eq. 25 at rest
    c = np.sqrt(factor_of(held))
    assert -(w * (1 - c * RATIO)) @ RATIO * c + 2 * np.log(c**2) / 0.02**2 == pytest.approx(0, abs=1e-3)
    assert root**2 < factor_of(held) < 1


def test_sigma_of_a_factor_is_the_textbook_one() -> None:
    sigma = 0.001
    exact = NOMINAL * np.sqrt(0.8)
    result = update(case_of(exact, sigma))
    assert result.parameters[0].value == pytest.approx(0.8 * 210e9, rel=1e-8)
    assert result.parameters[0].sigma == pytest.approx(0.8 * 210e9 * 2 * sigma / np.sqrt(3), rel=1e-6)
    assert result.inflation == 1.0


def test_a_misfit_beyond_the_noise_raises_sigma_and_says_so() -> None:
    result = update(case_of(sigma=1e-5))
    assert result.inflation > 10
    assert any("misses the frequencies" in w for w in result.warnings)


def test_what_only_a_ratio_can_tell_is_named_as_undetermined() -> None:
    result = update(case_of(), parameters=["E", "density", "width"], weights="relative")
    assert set(result.undetermined) == {"E", "density", "width"}
    assert not np.isfinite([p.sigma for p in result.parameters]).any()
    assert update(case_of(), parameters=["E"], weights="relative").undetermined == ()


def test_undetermined_parameters_keep_the_tolerances_doubt() -> None:
    result = update(case_of(NOMINAL, E=0.01, density=0.003), parameters=["E", "density"])
    # the ratio is known: the modulus to what the density's tolerance leaves, a third of its own; the density no better
    assert result.undetermined == ("density",)
    values = {p.name: p for p in result.parameters}
    assert values["density"].sigma / values["density"].value == pytest.approx(0.003, rel=0.1)
    assert result.correlations[0, 1] > 0.5


def test_a_parameter_that_runs_to_the_end_of_its_range_says_so() -> None:
    result = update(case_of(NOMINAL * 0.7), parameters=["length"], weights="relative")
    assert result.parameters[0].at_bound
    assert "at bound" in result.table()["remark"][0]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"parameters": ["Young"]}, "no parameter 'Young'"),
        ({"parameters": ["zone1.colour"]}, "no 'colour'"),
        ({"parameters": ["length.depth"]}, "no parameter 'depth'"),
        ({"parameters": ["E", "E"]}, "is given twice"),
        ({"parameters": []}, "no parameters"),
        ({"parameters": ["sensor_mass"]}, "do not state where"),
        ({"parameters": ["local_stiffness.x"]}, "also needs extent, loss"),
        ({"shared": ["density"]}, "updated in no study"),
        ({"weights": "absolute"}, "unknown weights"),
        ({"weights": [1.0, 1.0]}, "2 weights for 3 measured modes"),
        ({"parameters": ["zone1.E", "zone2.E", "zone3.E", "zone4.E"], "weights": "relative"}, "4 parameters"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(options: dict[str, object], message: str) -> None:
    with pytest.raises(StudyError, match=message) as caught:
        update(case_of(), **options)  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


def test_accepted_effects_are_in_the_model_before_and_after() -> None:
    case = replace(case_of(), accepted=(("length", {"extension": 0.01}),))
    result = update(case, parameters=["E"], weights="relative")
    longer = np.sqrt(build_structure(replace(BEAM, length=0.386, regions=())).eigen(3)[0]) / (2 * np.pi)
    assert result.pairs["before_hz"].to_numpy() == pytest.approx(longer, rel=1e-4)
    assert result.exact
    ratio = result.pairs["after_hz"] / longer
    assert ratio.to_numpy() == pytest.approx(np.sqrt(factor_of(result)), rel=1e-9)
    assert factor_of(result) > factor_of(update(case_of(), weights="relative"))


def test_one_of_two_accepted_effects_of_a_name_is_not_updated_blindly() -> None:
    bodies = tuple(("lumped_mass", {"mass": 0.005, "x": x}) for x in (0.2, 0.3))
    both = replace(case_of(), accepted=bodies)
    assert update(both, parameters=["E"]).converged
    with pytest.raises(StudyError, match=r"lumped_mass is given 2 times in \[\[model.effect\]\]"):
        update(both, parameters=["lumped_mass.mass"])
