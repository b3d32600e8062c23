"""A cause in no library has a place and a size: those of what was put there, on the model and on an exact beam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, case_of, observed, specimen, struck

from updating import Predictor
from updating.diagnosis.answer.mechanism import Component
from updating.diagnosis.answer.quantiles import quantiles
from updating.diagnosis.diagnose import pose
from updating.diagnosis.generic.field import Field, Kind, beside
from updating.diagnosis.generic.parts import channels, parts
from updating.diagnosis.search.evidence import explain
from updating.models.state import State
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

TENTHS = replace(BEAM.with_elements(10), regions=())


def posed(state: State) -> SpecimenProblem:
    """A test of the model itself in some state, with noise."""
    found = Predictor(TENTHS, blank(POINTS)).predict(state, count=5)
    rng = np.random.default_rng(4)
    return pose(case_of(observed(found.frequency, found.damping, found.constants, POINTS, rng), TENTHS))[0]


def found_in(problem: SpecimenProblem) -> tuple[Field, tuple[Component, ...]]:
    field = beside(problem, explain(problem, Candidate()))
    return field, parts(problem, field)


def interval(part: Component) -> tuple[float, float, float]:
    (values,) = part.sizes.values()
    return quantiles(values, part.weights)


def along(part: Component) -> tuple[float, float, float]:
    assert part.places is not None
    return quantiles(part.places[:, 0], part.weights)


def test_a_soft_region_is_a_place_with_its_compliance() -> None:
    problem = posed(State(regional={(3, "E"): 0.7}))
    field, (leading, *_) = found_in(problem)
    assert (leading.channel, leading.extent) == ("stiffness", "local")
    assert list(leading.sizes) == [("compliance", "m")]
    low, _, high = interval(leading)
    assert low < (1 / 0.7 - 1) * 0.1 * BEAM.length < high
    low, middle, high = along(leading)
    assert middle == pytest.approx(0.35 * BEAM.length, abs=0.1 * BEAM.length)
    assert channels(field)["stiffness"] > 0.9


def test_an_even_change_is_everywhere() -> None:
    _, (leading, *more) = found_in(posed(State(factors={"density": 1.15})))
    assert (leading.channel, leading.extent, leading.places) == ("mass", "global", None)
    low, middle, high = interval(leading)
    assert list(leading.sizes) == [("relative mass", "-")]
    assert 0 < low < middle < high
    assert not more


@pytest.mark.long
@pytest.mark.parametrize(("at", "mass"), [(0.207, 0.05), (0.2256, 0.03), (0.3, 0.02), (0.11, 0.04)])
def test_a_body_on_an_exact_beam_within_a_region_or_between_two(at: float, mass: float) -> None:
    rng = np.random.default_rng(21)
    problem = pose(case_of(struck(specimen(rng, masses=((at, mass),)), rng)))[0]
    _, (leading, *_) = found_in(problem)
    assert (leading.channel, leading.extent) == ("mass", "local")
    low, middle, high = along(leading)
    assert low < at < high and middle == pytest.approx(at, abs=0.06 * BEAM.length)
    low, middle, high = interval(leading)
    assert low > 0 and middle == pytest.approx(mass, rel=0.35)


def field(changes: dict[int, float], sigma: float = 0.02) -> Field:
    """A field of mass, as sure everywhere, on the ten regions of the beam."""
    values = np.zeros((2, 11))
    for region, change in changes.items():
        values[1, region] = change
    spread = np.zeros((22, 22))
    spread[11:, 11:] = sigma**2 * np.eye(11)
    kind = Kind(("density",), 0.5)
    return Field(5.0, kind, values, spread, {kind: 1.0})


PLAIN = posed(State())


def test_side_lobes_are_no_places_and_far_changes_are() -> None:
    lobes = field({2: -0.1, 3: 0.2, 4: -0.3, 5: 0.8, 6: -0.25})
    assert len(parts(PLAIN, lobes)) == 1
    apart = parts(PLAIN, field({1: 0.4, 8: 0.5}))
    assert [along(part)[1] > BEAM.length / 2 for part in apart] == [True, False]
    own = BEAM.material.density * BEAM.width * BEAM.thickness * BEAM.length / 10
    for part, change in zip(apart, (0.5, 0.4), strict=True):
        assert interval(part)[1] == pytest.approx(own * np.expm1(change), rel=0.15)


def test_half_of_the_structure_is_no_place() -> None:
    (part,) = parts(PLAIN, field(dict.fromkeys(range(6), 0.2)))
    assert part.extent == "global"


def test_where_nothing_is_sure_nothing_is_stated() -> None:
    assert parts(PLAIN, field({4: 0.03})) == ()


@pytest.mark.long
def test_place_and_size_of_bodies_and_soft_places_drawn_at_random() -> None:
    """Exact beams off by their tolerances: the place nearly always, the size as often as 95 % intervals of a sketch."""
    placed, sized = [], []
    for seed in range(300, 320):
        rng = np.random.default_rng(seed)
        at = rng.uniform(0.06, 0.3)
        if seed % 2:
            true = float(np.exp(rng.uniform(np.log(0.008), np.log(0.08))))
            change: dict[str, object] = {"masses": ((at, true),)}
        else:
            wide, loss = rng.uniform(0.01, 0.04), rng.uniform(0.2, 0.6)
            true = wide * loss / (1 - loss)
            change = {"soft": (at - wide / 2, at + wide / 2, loss)}
        problem = pose(case_of(struck(specimen(rng, **change), rng)))[0]
        _, (leading, *_) = found_in(problem)
        assert leading.channel == ("mass" if seed % 2 else "stiffness")
        low, _, high = along(leading)
        placed.append(low <= at <= high)
        if leading.sizes:
            low, _, high = interval(leading)
            sized.append(low <= true <= high)
    assert np.mean(placed) >= 0.9
    assert len(sized) >= 15 and np.mean(sized) >= 0.8
