"""One size of a cause in both halves of the modes and of the points, or none that is named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM as FINE
from updating_cases import case_of, specimen, struck

from updating import LIBRARY, Measured, diagnose
from updating.diagnosis.answer import consistency
from updating.diagnosis.answer.consistency import Split, _halves, _Part, splits
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.evidence import explain
from updating.models.state import NOMINAL
from updating.problem.candidate import Candidate

BEAM = FINE.with_elements(20)
SOFTER = Candidate((LIBRARY["E"],))


def softer(seed: int) -> Measured:
    """The test of a beam whose modulus is a tenth lower."""
    rng = np.random.default_rng(seed)
    beam = specimen(rng)
    return struck(replace(beam, E=0.9 * beam.E), rng)


def inconsistent_parameters(test: Measured) -> tuple[Split, ...]:
    problem, _ = pose(case_of(test, BEAM))
    return splits(problem, explain(problem, SOFTER))


@pytest.mark.parametrize("seed", range(6))
def test_a_true_cause_has_one_size_in_all_data(seed: int) -> None:
    assert inconsistent_parameters(softer(seed)) == ()


def test_a_size_that_differs_from_the_low_to_the_high_modes_is_found() -> None:
    test = softer(3)
    count = len(test.frequency)
    upper = np.arange(count) >= (count + 1) // 2
    found = inconsistent_parameters(replace(test, frequency=test.frequency * np.where(upper, 1.05, 1.0)))
    assert found[0].parameter == "E.factor"
    assert "the lower and the upper modes" in str(found[0])
    assert found[0].sigma > 3


@pytest.mark.long
def test_few_data_are_a_warning() -> None:
    test = softer(3)
    few = replace(test.modes(np.arange(2)), seen=test.seen[:1], hit=test.hit[:1])
    few = replace(few, constants=few.constants[:1], constants_sigma=few.constants_sigma[:1], phase=None)
    warnings = diagnose(case_of(few, BEAM), library=[LIBRARY["E"], LIBRARY["length"]]).warnings
    assert any("data are left to test the fit" in warning for warning in warnings)
    many = diagnose(case_of(test, BEAM), library=[LIBRARY["E"], LIBRARY["length"]]).warnings
    assert not any("data are left to test the fit" in warning for warning in many)


def test_a_half_without_any_mode_that_has_a_partner_is_no_half() -> None:
    """What a test says of a mode that has none stands in both."""
    problem, _ = pose(case_of(softer(3), BEAM))
    found = problem.compare(NOMINAL)
    lowest = found.mode == 0
    one = replace(
        found,
        **{name: getattr(found, name)[lowest] for name in ("residual", "variance", "channel", "source")},
    )
    one = replace(one, mode=np.append(found.mode[lowest][:-1], -1), nuisance=found.nuisance[lowest])
    assert "the lower and the upper modes" not in [name for name, *_ in _halves(one)]
    assert "the lower and the upper modes" in [name for name, *_ in _halves(found)]


@pytest.mark.parametrize(("spread", "apart"), [(0.004, True), (0.05, False)])
def test_a_part_that_knows_next_to_nothing_of_a_parameter_is_no_test_of_it(
    monkeypatch: pytest.MonkeyPatch, spread: float, apart: bool
) -> None:
    """Both sizes are ten deviations apart; the second part has a sixteenth of the information, or 4e-4."""
    problem, _ = pose(case_of(softer(3), BEAM))
    found = explain(problem, SOFTER)
    sizes = ((0.4, 0.001), (0.4 + 10 * np.hypot(0.001, spread), spread))
    parts = [_Part(np.array([at]), np.array([[own**2]])) for at, own in sizes]
    taken = iter(parts * 2)
    monkeypatch.setattr(consistency, "_part", lambda *_: next(taken))
    assert bool(splits(problem, found)) is apart
