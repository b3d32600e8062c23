"""Correlation of a test with a model, on tests whose answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, EstimationError, FrfSet, StudyError
from updating import Case, Damping, Material, Measured, Predictor, Region, Spec
from updating.correlation.correlate import correlate
from updating.simulation import frf_set, simulated

BEAM = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(12,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=Material(210e9, 7850.0, 0.3),
)
POINTS = 0.4 * np.arange(1, 7)[:, None] / 6


def seen(frequency: np.ndarray, constants: np.ndarray) -> Measured:
    n, m = constants.shape
    return Measured(
        frequency=frequency, frequency_sigma=1e-4 * frequency, damping=np.full(m, 0.01),
        damping_sigma=np.full(m, 1e-4), points=POINTS, nodes=tuple(range(11, 11 + n)),
        seen=np.full(n, n - 1), hit=np.arange(n), constants=constants,
        constants_sigma=0.01 * np.abs(constants), absolute=True,
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
    assert found.frac["force direction"].tolist() == ["+Z"] * 6
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


def test_frac_of_mere_shapes_knows_that_their_signs_are_free_and_needs_their_level(model) -> None:
    """Constants of one FRF over the modes: a mode turned over is the same mode, one of another size is not."""
    turned = model.constants * np.array([1.0, -1.0, -1.0, 1.0])
    shapes = replace(seen(model.frequency, turned), hit=np.full(6, -1))
    assert correlate(Case("scaled", BEAM, shapes)).frac["FRAC"].to_numpy() == pytest.approx(np.ones(6))
    assert correlate(Case("free", BEAM, replace(shapes, absolute=False))).frac.empty


def test_nothing_in_common_is_an_error(model) -> None:
    left = np.linalg.svd(model.constants)[0][:, 5:]
    with pytest.raises(EstimationError, match="has a partner in the model"):
        correlate(Case("none", BEAM, seen(np.array([100.0]), left[:, :1])))


def own_frfs(measured: Measured, *, spec: Spec = BEAM, turn: float = 1.0, **options: object) -> FrfSet:
    """The FRFs of a model at the points of a test; ``turn`` < 0 is a sensor upside down."""
    seen = simulated(Predictor(spec, measured))
    dofs = [Dof(n, 3) for n in measured.nodes]
    frfs = frf_set(seen, np.arange(0.0, 600.0), seen=measured.seen, hit=measured.hit, dofs=dofs, **options)
    if turn > 0:
        return frfs
    return replace(frfs.scaled(-1.0), responses=tuple(Dof(d.node, -3) for d in frfs.responses))


def test_frac_of_frfs_is_one_for_the_models_own_and_less_for_others(model) -> None:
    case = Case("frfs", BEAM, seen(model.frequency, model.constants))
    damped = replace(BEAM, damping=Damping(ratios=(0.01,)))
    stiffer = replace(damped, material=replace(BEAM.material, E=1.21 * 210e9))
    found = correlate(case, own_frfs(case.measured, spec=damped))
    assert found.frac["FRAC"].to_numpy() == pytest.approx(np.ones(6))
    assert found.frfs is not None
    assert found.frfs.damping.startswith("identified")
    assert found.frfs.model.values == pytest.approx(found.frfs.measured.values)
    assert (correlate(case, own_frfs(case.measured, spec=stiffer)).frac["FRAC"] < 0.5).all()


@pytest.mark.parametrize("form", ["receptance", "mobility"])
def test_the_models_frfs_point_as_the_transducers_do_and_keep_form_and_window(model, form) -> None:
    spec = replace(BEAM, damping=Damping(beta=2e-5))
    case = Case("turned", spec, seen(model.frequency, model.constants))
    frfs = own_frfs(case.measured, spec=spec, turn=-1.0, form=form, decay=7.0)
    found = correlate(case, frfs).frfs
    assert found is not None
    assert found.damping == "the model's own damping"
    assert found.model.values == pytest.approx(frfs.values)
    assert found.model.decay == 7.0


def test_damping_by_region_couples_the_models_modes() -> None:
    halves = (Region("bare", (0.0, 0.2), alpha=1.0), Region("taped", (0.2, 0.4), alpha=40.0))
    spec = replace(BEAM, regions=halves)
    stub = seen(np.array([26.0, 160.0, 450.0, 900.0]), np.ones((6, 4)))
    predicted = Predictor(spec, stub).predict(count=4)
    case = Case("regions", spec, seen(predicted.frequency, predicted.constants))
    found = correlate(case, own_frfs(case.measured, spec=spec)).frfs
    assert found is not None
    proportional = replace(spec, regions=(), damping=Damping(ratios=tuple(predicted.damping)))
    assert found.model.values == pytest.approx(found.measured.values)
    other = own_frfs(case.measured, spec=proportional).values[:, 1:]
    assert np.abs(other - found.model.values).max() > 1e-3 * np.abs(other).max()


def test_what_nobody_says_of_damping_is_said(model) -> None:
    silent = replace(seen(model.frequency, model.constants), damping=np.full(4, np.nan))
    found = correlate(Case("silent", BEAM, silent), own_frfs(silent, spec=BEAM)).frfs
    assert found is not None
    assert "0.5 %" in found.damping


def test_an_accepted_window_and_gain_are_in_the_models_frfs(model) -> None:
    spec = replace(BEAM, damping=Damping(alpha=3.0))
    off = {"accepted": (("exponential_window", {"decay": 2.0}), ("calibration_gain", {"gain": 1.1}))}
    case = Case("off", spec, seen(model.frequency, model.constants), **off)
    found = correlate(case, own_frfs(case.measured, spec=spec)).frfs
    assert found is not None
    beside = own_frfs(case.measured, spec=spec, decay=2.0)
    assert found.model.values == pytest.approx(1.1 * beside.values[:, 1:])


def test_frfs_of_another_test_are_refused(model) -> None:
    strangers = FrfSet(np.arange(0.0, 9.0), np.ones((1, 9)), (Dof(99, 3),), (Dof(98, 3),))
    with pytest.raises(StudyError, match="none of these FRFs"):
        correlate(Case("x", BEAM, seen(model.frequency, model.constants)), strangers)
