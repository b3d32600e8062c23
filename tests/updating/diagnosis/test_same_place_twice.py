"""One effect twice: at two places a pair of causes, in one and the same region one cause with two sizes."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from space_frame import Hidden, case
from updating_cases import BEAM, blank, case_of

from updating import LIBRARY
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.larger import _drafts
from updating.diagnosis.search.sets import _allowed
from updating.diagnosis.search.together import same_place_twice
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem


@pytest.fixture(scope="module")
def frame() -> SpecimenProblem:
    return pose(case(Hidden(), ()))[0]


def in_region(problem: SpecimenProblem, name: str, number: int) -> Candidate:
    effect = LIBRARY[name]
    regions = list(dict.fromkeys(form.values["region"] for form in problem.forms(effect)))
    form = next(form for form in problem.forms(effect) if form.values["region"] == regions[number])
    return Candidate((effect,), chosen=(form,))


def single(candidate: Candidate) -> Any:
    """Return what is looked at of an explanation when sets are drafted."""
    best = SimpleNamespace(coordinates=np.full(1, 0.5), comparison=SimpleNamespace(residual=np.zeros(30)))
    return SimpleNamespace(candidate=candidate, names=candidate.names, best=best)


@pytest.mark.parametrize("name", ["local_mass", "local_stiffness"])
def test_a_region_is_one_cause_and_two_regions_are_two(frame: SpecimenProblem, name: str) -> None:
    first, second = in_region(frame, name, 0), in_region(frame, name, 1)
    assert same_place_twice(frame, first, first)
    assert not same_place_twice(frame, first, second)
    assert _allowed(frame, [single(first), single(second), single(first)]) == [(0, 1), (1, 2)]
    assert not list(_drafts(frame, single(first), [single(first)]))


def test_what_is_searched_for_its_place_may_be_at_two() -> None:
    problem = pose(case_of(replace(blank(np.array([0.1, 0.2, 0.4])), **MODES), BEAM))[0]
    anywhere = Candidate((LIBRARY["local_mass"],), chosen=(problem.forms(LIBRARY["local_mass"])[0],))
    assert not same_place_twice(problem, anywhere, anywhere)


FREQUENCY = np.array([26.0, 163.0, 456.0])
MODES: dict[str, Any] = {
    "frequency": FREQUENCY,
    "frequency_sigma": 1e-3 * FREQUENCY,
    "damping": np.full(3, 0.002),
    "damping_sigma": np.full(3, 1e-4),
    "constants": np.zeros((0, 3)),
    "constants_sigma": np.zeros((0, 3)),
    "seen": np.zeros(0, dtype=int),
    "hit": np.zeros(0, dtype=int),
}
