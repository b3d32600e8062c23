"""Correlation of a test with a model, on tests whose answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, EstimationError, FrfSet, StudyError
from updating import Case, Material, Measured, Predictor, Spec
from updating.correlation import correlate, model_frfs

BEAM = Spec("beam", 0.4, 0.03, 0.005, (12,), ("x0",), "euler-bernoulli", Material(210e9, 7850.0, 0.3))
POINTS = 0.4 * np.arange(1, 7)[:, None] / 6


def seen(frequency: np.ndarray, constants: np.ndarray) -> Measured:
    n, m = constants.shape
    return Measured(
        frequency, 1e-4 * frequency, np.full(m, 0.01), np.full(m, 1e-4), POINTS, tuple(range(11, 11 + n)),
        np.full(n, n - 1), np.arange(n), constants, 0.01 * np.abs(constants), absolute=True,
    )  # fmt: skip


@pytest.fixture(scope="module")
def model():
    """Return the model's own modes at the points of the test."""
    stub = seen(np.array([26.0, 160.0, 450.0, 900.0]), np.ones((6, 4)))
    return Predictor(BEAM, stub).predict(count=4)


def test_a_model_agrees_with_itself(model) -> None:
    found = correlate(Case("self", BEAM, seen(model.frequency, model.constants)))
    assert found.rms_percent == pytest.approx(0, abs=1e-9)
    assert found.table["MAC"].to_numpy() == pytest.approx(np.ones(4))
    assert found.table["model mode"].tolist() == [1, 2, 3, 4]
    assert found.frac["FRAC"].to_numpy() == pytest.approx(np.ones(6))
    assert found.frac["response"].tolist() == [16] * 6
    assert np.diag(found.mac) == pytest.approx(np.ones(4))
    assert found.unpaired_test.empty


def test_exchanged_modes_are_paired_by_shape(model) -> None:
    order = [0, 2, 1, 3]
    found = correlate(Case("swap", BEAM, seen(model.frequency, model.constants[:, order])))
    assert found.table["model mode"].tolist() == [1, 3, 2, 4]
    expected = 100 * (model.frequency[order] / model.frequency - 1)
    assert found.table["error [%]"].to_numpy() == pytest.approx(expected)


def test_what_has_no_partner_is_listed_on_both_sides(model) -> None:
    rng = np.random.default_rng(3)
    strange = rng.standard_normal(6)
    low = model.constants[:, [0, 1, 3]]
    strange -= low @ np.linalg.lstsq(low, strange, rcond=None)[0]
    strange -= model.constants @ np.linalg.lstsq(model.constants, strange, rcond=None)[0]
    frequency = np.array([model.frequency[0], 99.0, model.frequency[1], model.frequency[3]])
    constants = np.column_stack([low[:, 0], strange, low[:, 1], low[:, 2]])
    found = correlate(Case("gaps", BEAM, seen(frequency, constants)))
    assert found.unpaired_test["frequency [Hz]"].tolist() == [99.0]
    assert found.unpaired_test["mode"].tolist() == [2]
    assert found.unpaired_model["mode"].tolist() == [3]
    assert any("99.00 Hz" in w for w in found.warnings)


def test_nothing_in_common_is_an_error(model) -> None:
    left = np.linalg.svd(model.constants)[0][:, 5:]
    with pytest.raises(EstimationError, match="looks like one of the model's"):
        correlate(Case("none", BEAM, seen(np.array([100.0]), left[:, :1])))


def test_frac_of_frfs_is_one_for_the_models_own_and_less_for_others(model) -> None:
    case = Case("frfs", BEAM, seen(model.frequency, model.constants))
    whole = Predictor(BEAM, case.measured).predict()
    damping = np.full(len(whole.frequency), 0.01)
    points = [Dof(n, 3) for n in case.measured.nodes]
    blank = FrfSet(np.arange(0.0, 600.0), np.ones((6, 600)), (points[-1],) * 6, tuple(points))
    own = replace(blank, values=model_frfs(whole.frequency, damping, whole.constants, blank))
    shifted = replace(blank, values=model_frfs(1.1 * whole.frequency, damping, whole.constants, blank))
    assert correlate(case, own).frac["FRAC"].to_numpy() == pytest.approx(np.ones(6))
    assert (correlate(case, shifted).frac["FRAC"] < 0.5).all()


def test_a_model_frf_is_the_textbook_one() -> None:
    like = FrfSet(np.array([5.0, 6.0]), np.ones((1, 2)), (Dof(1, 3),), (Dof(1, 3),), "accelerance")
    f, zeta, a = 7.0, 0.02, 3.0
    found = model_frfs(np.array([f]), np.array([zeta]), np.array([[a]]), like)
    r = np.array([5.0, 6.0]) / f
    assert found[0] == pytest.approx(-a * r**2 / (1 - r**2 + 2j * zeta * r))


def test_frfs_of_another_test_are_refused(model) -> None:
    strangers = FrfSet(np.arange(0.0, 9.0), np.ones((1, 9)), (Dof(99, 3),), (Dof(98, 3),))
    with pytest.raises(StudyError, match="none of these FRFs"):
        correlate(Case("x", BEAM, seen(model.frequency, model.constants)), strangers)
