"""The kinds of data: each gives its own rows, and a comparison is nothing but these put together."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, DOUBTS, POINTS, blank

from identification.fading import Fading
from updating import LIBRARY, Case, Measured, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Doubt, Quantity, View
from updating.likelihood.comparison import CHANNELS, Block, Layout, assemble
from updating.models.state import NOMINAL, State
from updating.problem.specimen import SpecimenProblem

THIN = replace(BEAM, theory="euler-bernoulli")
MODES = 4


def perfect(state: State = NOMINAL, **changes: object) -> Measured:
    """A test without error of a model: all kinds of data."""
    evaluation = Predictor(THIN, blank(POINTS))
    truth = evaluation.predict(state, count=MODES)
    ones = np.ones(MODES)
    test = replace(
        evaluation.measured,
        frequency=truth.frequency, frequency_sigma=1e-4 * truth.frequency,
        damping=truth.damping, damping_sigma=0.03 * truth.damping,
        constants=truth.constants, constants_sigma=0.01 * np.abs(truth.constants).max(axis=0) * np.ones((5, MODES)),
        phase=np.zeros((1, MODES)), phase_sigma=np.full((1, MODES), 0.01), channel_group=np.zeros(5, dtype=np.int64),
        slope=0.0 * ones, slope_sigma=1e-6 * ones, level=100.0, trend=0.0 * ones, trend_sigma=1e-4 * ones,
        fading=Fading(0.0, 5000, 2.0, 0.0),
    )  # fmt: skip
    return replace(test, **changes)  # type: ignore[arg-type]


def problem(test: Measured) -> SpecimenProblem:
    return pose(Case("a beam", THIN, test, tolerances=Tolerances(DOUBTS)))[0]


def view(diagnosis_problem: SpecimenProblem, state: State = NOMINAL, doubt: Doubt | None = None) -> View:
    now = diagnosis_problem.predictor.predict(
        state, factors=diagnosis_problem.names, at_least=diagnosis_problem.reach
    ).select(np.arange(MODES))
    return View(now, state, doubt or Doubt())


@pytest.fixture(scope="module")
def diagnosis_problem() -> SpecimenProblem:
    return problem(perfect())


def test_a_test_that_has_everything_has_every_kind_in_order(diagnosis_problem: SpecimenProblem) -> None:
    every = tuple(q.block(view(diagnosis_problem)).channel for q in diagnosis_problem.quantities)
    # of modes that have no partner there are none: here every mode has one
    assert every == tuple(name for name in CHANNELS if name != "unpaired")


@pytest.mark.parametrize("channel", [name for name in CHANNELS if name != "unpaired"])
def test_nothing_is_left_of_data_that_the_model_made(
    diagnosis_problem: SpecimenProblem, channel: str
) -> None:
    rank = [name for name in CHANNELS if name != "unpaired"].index(channel)
    quantity = diagnosis_problem.quantities[rank]
    block = quantity.block(view(diagnosis_problem))
    assert np.abs(block.residual).max() < 1e-9
    assert (block.variance > 0).all()
    assert len(block.factors) == len(block.named) == len(block.own) == len(block.mode) == len(block.residual)


@pytest.mark.parametrize(
    ("channel", "changes", "expected"),
    [
        ("frequency", {"frequency": 1.01}, np.log(1.01)),
        ("damping", {"damping": 1.2}, np.log(1.2)),
        ("level", {"slope": 2e-5}, 2e-3),
        ("phase", {"phase": 0.02}, 0.02),
        ("trend", {"trend": 2e-3}, 2e-3),
    ],
)
def test_each_kind_reads_its_own_data(channel: str, changes: dict[str, float], expected: float) -> None:
    ((name, size),) = changes.items()
    plain = perfect()
    value = (
        size * getattr(plain, name)
        if name in ("frequency", "damping")
        else np.full_like(getattr(plain, name), size)
    )
    changed = problem(replace(plain, **{name: value}))
    for quantity in changed.quantities:
        block = quantity.block(view(changed))
        assert block.residual == pytest.approx(expected if block.channel == channel else 0.0, abs=1e-9)


@pytest.mark.parametrize("lacking", ["phase", "slope", "trend", "damping", "shapes"])
def test_what_was_not_measured_adds_no_rows(lacking: str) -> None:
    nothing = {
        "phase": {"phase": None},
        "slope": {"slope": None},
        "trend": {"trend": None},
        "damping": {"damping": np.full(MODES, np.nan)},
        "shapes": {
            "points": POINTS[:0, None], "nodes": (), "seen": np.zeros(0, dtype=int), "hit": np.zeros(0, dtype=int),
            "constants": np.zeros((0, MODES)), "constants_sigma": np.zeros((0, MODES)), "absolute": False,
        },
    }[lacking]  # fmt: skip
    kinds = {"slope": {"level"}, "shapes": {"frf", "phase"}}.get(lacking, {lacking})
    comparison = problem(perfect(**nothing)).compare(NOMINAL)
    assert {name for name in CHANNELS if not comparison.of(name).any()} == {*kinds, "unpaired"}


def test_a_comparison_is_its_blocks(diagnosis_problem: SpecimenProblem) -> None:
    """Whatever the kinds are: rows in their order, the tolerances common, all else doubted for each kind alone."""
    blocks = [q.block(view(diagnosis_problem, doubt=Doubt(0.02, 0.1))) for q in diagnosis_problem.quantities]
    whole = diagnosis_problem.compare(NOMINAL, doubt=Doubt(0.02, 0.1))
    count = len(diagnosis_problem.names)
    for block in blocks:
        rows = whole.of(block.channel)
        np.testing.assert_array_equal(whole.residual[rows], block.residual)
        np.testing.assert_array_equal(whole.variance[rows], block.variance)
        np.testing.assert_array_equal(whole.nuisance[rows, :count], block.factors * diagnosis_problem.sigmas)
        used = np.flatnonzero(np.any(whole.nuisance[rows][:, count:] != 0, axis=0))
        others = np.any(whole.nuisance[~rows][:, count:] != 0, axis=0)
        assert not others[used].any()
    named = sum(block.named.shape[1] for block in blocks)
    np.testing.assert_array_equal(whole.doubts, np.arange(count + named))


def test_another_likelihood_of_a_kind_needs_no_change_of_the_assembly(
    diagnosis_problem: SpecimenProblem,
) -> None:
    """A sibling of the family in the place of another: frequencies known ten times worse."""

    class Vague(Quantity):
        @property
        def present(self) -> bool:
            return True

        def block(self, view: View) -> Block:
            plain = diagnosis_problem.quantities[0].block(view)
            return replace(plain, variance=100 * plain.variance)

    at = view(diagnosis_problem, LIBRARY["E"].state(diagnosis_problem.predictor, {"factor": 1.05}))
    kinds = (Vague(diagnosis_problem.setting), *diagnosis_problem.quantities[1:])
    zero = np.zeros(len(diagnosis_problem.names))
    families = [[q.block(at) for q in family] for family in (diagnosis_problem.quantities, kinds)]
    layout = Layout.of(families[0], len(zero))
    one, other = (
        assemble(blocks, layout, diagnosis_problem.sigmas, zero, at.now, (1.0, 0.0, 0.0, 0.0, 0.0))
        for blocks in families
    )
    rows = one.of("frequency")
    np.testing.assert_allclose(other.variance[rows], 100 * one.variance[rows])
    np.testing.assert_array_equal(other.variance[~rows], one.variance[~rows])
    np.testing.assert_array_equal(other.nuisance, one.nuisance)
