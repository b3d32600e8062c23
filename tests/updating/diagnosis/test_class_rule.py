"""Which sets stand in the answer, decided on likelihoods, fits and probabilities put in by hand."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from acquisition.errors import InputError
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.answer.verdict import decide, is_significant, rejected, shortcoming


def row(
    names: str,
    probability: float,
    log_likelihood: float,
    *,
    fits: float = 0.5,
    without: float = -np.inf,
    at_end: bool = False,
    settled: bool = True,
) -> Any:
    """Return a set that was weighed, its parameters in the middle of their priors and determined."""
    marginal = SimpleNamespace(log_likelihood=log_likelihood)
    size = len(names.split())
    explanation = SimpleNamespace(
        candidate=SimpleNamespace(log_weight=0.0),
        names=tuple(names.split()),
        log_evidence=log_likelihood - 5,
        best=SimpleNamespace(marginal=marginal, coordinates=np.full(size, 0.5), possible=True),
        samples=np.full((2, size), 0.5),
        weights=np.array([0.5, 0.5]),
        settled=settled,
    )
    share = {"probability": probability, "p_value": fits, "as_stated": fits, "without": without}
    share["extreme"] = explanation.names if at_end else ()
    return SimpleNamespace(names=explanation.names, explanation=explanation, **share)


def answer(*rows: Any, rules: DecisionRules = DEFAULT_RULES) -> tuple[str, tuple[tuple[str, ...], ...]]:
    """Return the verdict where the empty set is far behind."""
    found: Any = SimpleNamespace(compared=rows, empty=row("", 0.0, -1000.0))
    return decide(found, significant=True, rules=rules)


@pytest.mark.parametrize(("gain", "verdict"), [(0.5, "named"), (6.0, "class")])
def test_a_second_cause_that_no_datum_shows_is_no_rival(gain: float, verdict: str) -> None:
    found, sets = answer(row("E", 0.9, 100.0), row("E taper", 0.1, 100.0 + gain))
    assert found == verdict
    assert sets[0] == ("E",)


def test_another_cause_that_holds_the_rest_is_a_rival() -> None:
    assert answer(row("E", 0.9, 100.0), row("density", 0.1, 90.0))[0] == "class"


def test_a_set_at_the_end_of_its_range_leaves_the_first_no_more_certain() -> None:
    rows = row("E", 0.53, 100.0), row("density", 0.4, 99.5, at_end=True), row("taper", 0.07, 90.0)
    assert answer(*rows) == ("class", (("E",), ("density",), ("taper",)))


def test_what_setting_data_aside_explains_by_itself_has_no_share() -> None:
    rows = row("E", 0.9, 100.0), row("density", 0.1, 90.0, without=84.0)
    assert answer(*rows) == ("named", (("E",),))


def test_a_cause_that_setting_data_aside_explains_better_without_it_is_none() -> None:
    """One that sets nothing aside is far behind what sets a bad channel aside and names no cause."""
    rows = row("E", 0.6, 100.0, without=94.0), row("density", 1e-12, 70.0)
    assert answer(*rows)[1] == ()


def test_a_set_at_the_end_of_its_range_that_holds_little_is_no_rival() -> None:
    rows = row("E", 0.96, 100.0), row("density", 0.04, 99.5, at_end=True)
    assert answer(*rows) == ("named", (("E",),))


def test_a_faint_second_cause_beside_a_rival_does_not_make_the_rival_go() -> None:
    _, sets = answer(row("E", 0.6, 100.0), row("density", 0.3, 99.8), row("E taper", 0.1, 100.5))
    assert sets == (("E",), ("density",))


def test_a_second_cause_that_no_datum_shows_beside_a_rival_counts_for_the_rival() -> None:
    rows = row("E", 0.6, 100.0), row("density", 0.3, 99.8), row("density taper", 0.1, 100.5)
    assert answer(*rows)[1] == (("E",), ("density",))
    rows = row("E", 0.96, 100.0), row("density", 0.02, 90.0), row("density taper", 0.02, 90.5)
    assert answer(*rows) == ("named", (("E",),))


@pytest.mark.parametrize(("nothing", "gap"), [(0.25, False), (0.01, True)])
def test_a_fit_that_chance_seldom_makes_shows_a_gap_once_nothing_at_all_is_not_credible(
    nothing: float, gap: bool
) -> None:
    """Four units of log evidence, twelve of log likelihood: chance makes that once in 100 000 tries."""
    empty, cause = row("", nothing, 92.0), row("E", 1 - nothing, 104.0)
    empty.explanation.log_evidence, cause.explanation.log_evidence = 95.0, 99.0
    found: Any = SimpleNamespace(compared=(cause, empty), empty=empty)
    assert is_significant(found, p_value=0.9) is gap
    assert is_significant(found, p_value=1e-4)


def test_what_setting_data_aside_explains_by_itself_is_no_cause() -> None:
    """Two modes out of line, set aside, leave nothing to explain; the set beside them closes nothing."""
    assert answer(row("E", 1.0, 100.0, without=60.0)) == ("named", (("E",),))
    assert answer(row("E", 1.0, 100.0, without=94.0))[1] == ()


@pytest.mark.parametrize(("without", "gap"), [(-np.inf, True), (94.0, False)])
def test_data_as_well_set_aside_by_themselves_show_no_gap(without: float, gap: bool) -> None:
    """Three points out of line make the data no less likely than chance does once in thirty tests."""
    empty, cause = row("", 0.0, 65.0), row("E", 1.0, 100.0, without=without)
    found: Any = SimpleNamespace(compared=(cause, empty), empty=empty)
    assert is_significant(found, p_value=0.03) is gap
    assert is_significant(found, p_value=1e-4)


def test_a_certainty_of_its_own_names_what_the_default_leaves_a_class() -> None:
    rows = row("E", 0.9, 100.0), row("density", 0.1, 90.0)
    assert answer(*rows)[0] == "class"
    assert answer(*rows, rules=DecisionRules(credible_share=0.85)) == ("named", (("E",),))


def test_the_whole_beside_its_part_and_an_effect_beside_nothing_have_a_rule_each() -> None:
    rows = row("E taper", 0.99, 105.0), row("E", 0.01, 100.0)
    assert answer(*rows)[1] == (("E", "taper"), ("E",))
    assert answer(*rows, rules=DecisionRules(effect_shows_gap=4.0))[1] == (("E", "taper"), ("E",))
    assert answer(*rows, rules=DecisionRules(whole_beside_part=4.0))[1] == (("E", "taper"),)
    found: Any = SimpleNamespace(
        compared=(row("E", 0.1, 105.0), row("", 0.9, 100.0)), empty=row("", 0.9, 100.0)
    )
    assert not is_significant(found, 0.5)
    assert not is_significant(found, 0.5, rules=DecisionRules(whole_beside_part=4.0))
    assert is_significant(found, 0.5, rules=DecisionRules(effect_shows_gap=4.0))


def test_a_fit_is_rejected_by_the_rule_of_its_number_of_causes() -> None:
    single, pair = row("E", 1.0, 100.0, fits=0.01), row("E taper", 1.0, 100.0, fits=0.01)
    assert [rejected(one, DEFAULT_RULES) for one in (single, pair)] == [False, True]
    strict, mild = DecisionRules(rejected_fit=0.05), DecisionRules(doubted_fit=0.001)
    assert [rejected(one, strict) for one in (single, pair)] == [True, True]
    assert [rejected(one, mild) for one in (single, pair)] == [False, False]
    found: Any = SimpleNamespace(compared=(single,), empty=row("", 0.0, 0.0))
    assert shortcoming(found) is None
    assert shortcoming(found, rules=strict) == "fit"


def test_rules_that_cannot_be_are_refused_and_those_changed_are_listed() -> None:
    assert DEFAULT_RULES.changed == {}
    assert DecisionRules(split_sigma=4, rival_share=0.02).changed == {"split_sigma": 4}
    for name, value in (("credible_share", 1.5), ("split_sigma", 0.0), ("close_fits", float("inf"))):
        with pytest.raises(InputError, match=f"rule {name}"):
            DecisionRules(**{name: value})


def test_a_cause_in_no_library_is_one_of_a_class_where_a_set_is_not_sure_without_it() -> None:
    found: Any = SimpleNamespace(
        compared=(row("E", 0.98, 100.0), row("density", 0.02, 90.0)), empty=row("", 0.0, 0.0)
    )
    assert decide(found, significant=True) == ("named", (("E",),))
    assert decide(found, significant=True, unnamed=0.03) == ("named", (("E",),))
    assert decide(found, significant=True, unnamed=0.1) == ("class", (("E",), ("something_else",)))
    nearly: Any = SimpleNamespace(
        compared=(row("E", 0.955, 100.0), row("density", 0.045, 90.0)), empty=row("", 0.0, 0.0)
    )
    assert decide(nearly, significant=True, unnamed=0.01) == ("class", (("E",), ("density",)))
    half: Any = SimpleNamespace(
        compared=(row("E", 0.5, 100.0), row("density", 0.5, 100.0)), empty=row("", 0.0, 0.0)
    )
    assert decide(half, significant=True, unnamed=0.04)[1] == (("E",), ("density",))
    assert decide(half, significant=True, unnamed=0.2)[1] == (("E",), ("density",), ("something_else",))


def test_a_probability_that_rests_on_hardly_any_sample_names_nothing() -> None:
    found: Any = SimpleNamespace(compared=(row("E", 1.0, 100.0, settled=False),), empty=row("", 0.0, 0.0))
    assert shortcoming(found) == "samples"
    assert shortcoming(SimpleNamespace(compared=(row("E", 1.0, 100.0),), empty=found.empty)) is None


def test_a_cause_that_closes_nothing_but_sets_the_gap_aside_is_no_answer() -> None:
    found: Any = SimpleNamespace(compared=(row("E", 1.0, 100.0),), empty=row("", 0.0, 0.0))
    assert shortcoming(found, left=True, aside=True) == "closing"
    assert shortcoming(found, left=True) is None  # next to nothing to close
    assert shortcoming(found, left=True, aside=True, closed=95.0) is None
    assert shortcoming(found, left=True, closed=50.0) == "closing"


@pytest.mark.parametrize(("held", "lacks"), [(0.97, None), (0.9, "evidence"), (0.16, "evidence")])
def test_what_no_cause_with_worse_data_holds_is_not_certain(held: float, lacks: str | None) -> None:
    found: Any = SimpleNamespace(compared=(row("E", held, 100.0),), empty=row("", 0.0, 0.0))
    assert shortcoming(found) == lacks
