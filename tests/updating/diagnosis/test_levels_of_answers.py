"""Sets that do one thing alike are one mechanism: units, places, mirror images, shares that add up."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from updating_cases import BEAM, POINTS, blank, case_of, exactly, specimen, struck

from updating import LIBRARY, Diagnosis, Measured, Predictor, Spec, diagnose
from updating.diagnosis.answer.in_no_library import SomethingElse
from updating.diagnosis.answer.levels import Holder, alike, levels, mechanism
from updating.diagnosis.answer.located import LikelyPlace, Where
from updating.diagnosis.answer.mechanism import Component
from updating.diagnosis.diagnose import pose
from updating.models.state import NOMINAL
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

RNG = np.random.default_rng(3)
N = 200
EVEN = np.full(N, 1 / N)
MASS, SOFT = ("added mass", "kg"), ("compliance", "m")


def part(
    at: float | None = 0.13,
    *,
    size: tuple[str, str] = MASS,
    value: float = 0.05,
    channel: Any = "mass",
    extent: Any = "local",
    **more: Any,
) -> Component:
    """What an effect does, known to 1 mm and to 2 %."""
    places = None if at is None else np.column_stack([at + 1e-3 * RNG.standard_normal(N), np.zeros((N, 2))])
    sizes = {size: value * (1 + 0.02 * RNG.standard_normal(N))}
    return Component(channel, extent, EVEN, sizes, places, **more)


def nowhere(*places: LikelyPlace) -> Where:
    return Where(
        channel="mass",
        channels={"mass": 1.0},
        location=None,
        locations=(),
        points=(),
        zones=(),
        likely_places=places,
    )


@pytest.mark.parametrize(
    ("other", "same"),
    [
        (part(0.135), True),
        (part(0.4), False),
        (part(channel="stiffness"), False),
        (part(size=SOFT), False),
        (part(value=-0.05), False),
        (part(None, extent="global"), False),
        (part(extent="edge"), True),
        (part(count=2), False),
    ],
)
def test_one_mechanism_is_one_channel_place_currency_and_direction(other: Component, same: bool) -> None:
    one = part()
    assert alike(one, other, 0.02) == alike(other, one, 0.02) == same


def test_places_whose_intervals_meet_are_one() -> None:
    wide = part(0.2)
    assert wide.places is not None
    spread = Component(
        "mass", "local", EVEN, wide.sizes, wide.places + [[0.06, 0, 0]] * RNG.standard_normal((N, 1))
    )
    assert alike(part(), spread, 0.02)


def test_size_and_probability_are_those_of_all_sets_that_share_it() -> None:
    body, coating, soft = part(value=0.05), part(value=0.052), part(channel="stiffness", size=SOFT)
    holders = [
        Holder(("lumped_mass",), 0.7, (body,)),
        Holder(("local_mass",), 0.2, (coating,)),
        Holder(("local_stiffness",), 0.1, (soft,)),
    ]
    found = mechanism(body, holders, nowhere(), 0.02, {})
    assert found.probability == pytest.approx(0.9)
    assert [one.effects for one in found.sets] == [("lumped_mass",), ("local_mass",)]
    assert sum(one.probability for one in found.sets) == pytest.approx(found.probability)
    assert found.size is not None
    assert (found.size.quantity, found.size.unit) == MASS
    assert 0.045 < found.size.low95 < found.size.value < found.size.high95 < 0.056
    assert found.location_low95 is not None and found.location_high95 is not None
    assert found.location_low95[0] < 0.13 < found.location_high95[0]


@pytest.mark.parametrize(("share", "quantity"), [(0.98, "turning"), (0.6, "compliance")])
def test_the_currency_is_one_that_nearly_all_sets_have_the_leading_ones_first(
    share: float, quantity: str
) -> None:
    """A clamp that turns by its stiffness; where a longer structure may be it, by what both have."""
    own = ("turning", "N m/rad")
    soft = part(channel="stiffness", extent="edge", size=SOFT, value=1e-3)
    clamp = replace(soft, sizes={own: 500 + RNG.standard_normal(N), **soft.sizes})
    longer = part(channel="stiffness", extent="edge", size=SOFT, value=1e-3)
    holders = [Holder(("clamp_rotation",), share, (clamp,)), Holder(("length",), 1 - share, (longer,))]
    found = mechanism(clamp, holders, nowhere(), 0.02, {})
    assert found.size is not None and found.size.quantity == quantity
    assert found.probability == pytest.approx(1.0)


def test_a_set_of_more_effects_has_the_mechanisms_of_fewer() -> None:
    body = part()
    both = Holder(
        ("E", "lumped_mass"), 0.4, (part(None, channel="stiffness", extent="global", size=SOFT), part())
    )
    found = mechanism(body, [Holder(("lumped_mass",), 0.6, (body,)), both], nowhere(), 0.02, {})
    assert found.probability == pytest.approx(1.0)


def test_mirrored_places_are_listed_with_the_one_found() -> None:
    left, right = (0.13, 0.0, 0.0), (0.67, 0.0, 0.0)
    still = (1e-3, 0.0, 0.0)
    where = nowhere(
        LikelyPlace(left, still, 0.5, "mass"),
        LikelyPlace(right, still, 0.5, "mass"),
        LikelyPlace((0.3, 0.0, 0.0), still, 1.0, "mass", 1),
        LikelyPlace((0.4, 0.0, 0.0), still, 1.0, "stiffness"),
    )
    body = part()
    found = mechanism(body, [Holder(("lumped_mass",), 1.0, (body,))], where, 0.02, {})
    assert found.locations == (left, right)
    assert found.location == left


def test_a_cause_in_no_library_counts_as_far_as_it_is_sure_of_the_channel() -> None:
    body = part()
    holders = [Holder(("lumped_mass",), 0.6, (body,)), Holder(("something_else",), 0.4, (part(),))]
    found = mechanism(body, holders, nowhere(), 0.02, {"mass": 0.5})
    assert found.probability == pytest.approx(0.8)


def test_relative_sizes_are_written_in_per_cent_and_masses_without_their_name() -> None:
    body = part()
    found = mechanism(body, [Holder(("lumped_mass",), 1.0, (body,))], nowhere(), 0.02, {})
    assert str(found).startswith("mass near x = 130 mm, ") and "added" not in str(found)
    softer = part(None, channel="stiffness", extent="global", size=("relative stiffness", "-"), value=-0.1)
    found = mechanism(softer, [Holder(("E",), 1.0, (softer,))], nowhere(), 0.02, {})
    assert "of the whole structure" in str(found) and "-10" in str(found) and "%" in str(found)


SPECIMEN: SpecimenProblem = pose(
    case_of(exactly(Predictor(BEAM, blank(POINTS)), Predictor(BEAM, blank(POINTS)).predict(NOMINAL, count=5)))
)[0]


def compared(probability: float, values: dict[str, dict[str, float]]) -> Any:
    """A set with a narrow posterior about some values of its effects."""
    candidate = Candidate(tuple(LIBRARY[name] for name in values))
    stated = {f"{name}.{key}": v for name, own in values.items() for key, v in own.items()}
    middle = candidate.coordinates(SPECIMEN.predictor, stated)
    samples = np.clip(middle + 0.002 * RNG.standard_normal((50, len(middle))), 0.0, 1.0)
    explanation = SimpleNamespace(
        candidate=candidate, names=candidate.names, samples=samples, weights=np.full(50, 0.02)
    )
    return SimpleNamespace(
        names=candidate.names, explanation=explanation, probability=probability, forms=((explanation, 1.0),)
    )


def answered(verdict: Any, sets: Any, *rows: Any, other: SomethingElse | None = None) -> Any:
    found: Any = SimpleNamespace(compared=rows)
    return levels(SPECIMEN, found, nowhere(), verdict, sets, other)


BODY = {"lumped_mass": {"mass": 0.02, "x": 0.2, "bulk": 1.0}}
COATING = {"local_mass": {"x": 0.2, "extent": 0.03, "factor": 1.6}}
SPOT = {"local_stiffness": {"x": 0.1, "extent": 0.02, "loss": 0.4}}


def test_one_set_is_a_story() -> None:
    found = answered("named", (("lumped_mass",),), compared(0.97, BODY), compared(0.03, SPOT))
    assert found.level == "story"
    assert (found.mechanisms[0].channel, found.mechanisms[0].extent) == ("mass", "local")
    assert found.mechanisms[0].size.value == pytest.approx(0.02, rel=0.02)


def test_two_sets_at_one_place_are_a_mechanism() -> None:
    sets = (("lumped_mass",), ("local_mass",))
    found = answered("class", sets, compared(0.7, BODY), compared(0.29, COATING), compared(0.01, SPOT))
    assert found.level == "mechanism"
    assert found.mechanisms[0].probability == pytest.approx(0.99)
    assert found.mechanisms[0].location[0] == pytest.approx(0.2, abs=0.003)


def test_two_sets_that_do_different_things_are_neither() -> None:
    sets = (("lumped_mass",), ("local_stiffness",))
    found = answered("class", sets, compared(0.6, BODY), compared(0.4, SPOT))
    assert found.level is None
    assert found.mechanisms[0].probability == pytest.approx(0.6)


def test_a_rival_of_another_mechanism_in_the_answer_leaves_the_mechanism_open() -> None:
    sets = (("lumped_mass",), ("local_stiffness",))
    found = answered("class", sets, compared(0.98, BODY), compared(0.02, SPOT))
    assert found.level is None


def test_without_a_gap_there_is_no_mechanism() -> None:
    assert answered("none", (), compared(0.2, BODY)).mechanisms == ()


@pytest.mark.parametrize(("share", "level"), [(0.99, "mechanism"), (0.7, None)])
def test_an_unknown_cause_has_the_content_of_its_field(share: float, level: str | None) -> None:
    field = part(0.3, value=0.01)
    other = SomethingElse(share, 2.0, (), {"mass": 1.0, "stiffness": 0.01}, (field,))
    found = answered("unknown", (), compared(1.0, SPOT), other=other)
    assert found.level == level
    assert found.mechanisms[0].sets[0].effects == ("something_else",)
    assert found.mechanisms[0].location[0] == pytest.approx(0.3, abs=0.01)
    assert found.mechanisms[0].probability == pytest.approx(share)


def test_an_unknown_cause_without_a_leading_field_has_no_content() -> None:
    other = SomethingElse(0.2, 2.0, (), {"mass": 1.0}, (part(),))
    assert answered("unknown", (), compared(1.0, SPOT), other=other).mechanisms == ()


def quick(test: Measured, *names: str, spec: Spec = BEAM) -> Diagnosis:
    """A diagnosis by a few effects alone."""
    return diagnose(case_of(test, spec), library=[LIBRARY[name] for name in names])


@pytest.mark.long
def test_a_body_on_an_exact_beam_is_a_mass_at_its_place_whatever_it_is_called() -> None:
    rng = np.random.default_rng(5)
    beam = specimen(rng, masses=((0.2, 0.02),))
    found = quick(struck(beam, rng), "lumped_mass", "local_mass", "E", "local_stiffness")
    assert found.level in ("story", "mechanism")
    leading = found.mechanism
    assert leading is not None and leading.location is not None and leading.size is not None
    assert (leading.channel, leading.extent, leading.size.unit) == ("mass", "local", "kg")
    assert leading.location[0] == pytest.approx(0.2, abs=0.01)
    assert leading.size.low95 < 0.02 < leading.size.high95
    assert leading.probability > 0.99


@pytest.mark.long
def test_a_body_that_no_effect_describes_has_the_content_of_a_mass_at_its_place() -> None:
    rng = np.random.default_rng(6)
    beam = specimen(rng, masses=((0.2, 0.05),))
    found = quick(struck(beam, rng), "E", "polarity")
    assert found.verdict == "unknown"
    leading = found.mechanism
    assert leading is not None and leading.location is not None
    assert (leading.channel, leading.extent) == ("mass", "local")
    assert leading.location_low95 is not None and leading.location_high95 is not None
    assert leading.location_low95[0] < 0.2 < leading.location_high95[0]
    assert leading.sets[0].effects == ("something_else",)
    assert found.next_test[0].measure.startswith("look for a body")


@pytest.mark.long
def test_an_error_of_a_sign_is_in_the_chain() -> None:
    rng = np.random.default_rng(7)
    test = struck(specimen(rng), rng)
    signs = np.where(np.arange(len(POINTS)) == 2, -1.0, 1.0)[:, None]
    found = quick(replace(test, constants=test.constants * signs), "E", "polarity", "lumped_mass")
    assert found.level == "story"
    assert found.mechanism is not None
    assert (found.mechanism.channel, found.mechanism.extent) == ("measurement", "chain")
    assert found.mechanism.location == pytest.approx((POINTS[2], 0.0, 0.0))


@pytest.mark.long
def test_by_frequencies_alone_a_place_on_a_free_beam_has_its_mirror_image() -> None:
    rng = np.random.default_rng(8)
    beam = replace(specimen(rng, soft=(0.11, 0.13, 0.6)), clamped=False)
    test = struck(beam, rng, modes=6)
    none, count = np.zeros(0, dtype=int), len(test.frequency)
    empty = np.zeros((0, count))
    bare = replace(
        test, seen=none, hit=none, constants=empty, constants_sigma=empty, absolute=False, phase=None
    )
    found = quick(bare, "local_stiffness", "E", spec=replace(BEAM, clamped=(), regions=()))
    leading = found.mechanism
    assert leading is not None and leading.channel == "stiffness"
    assert len(leading.locations) == 2
    assert sum(place[0] for place in leading.locations) == pytest.approx(BEAM.length, abs=0.01)
    assert min(abs(place[0] - 0.12) for place in leading.locations) < 0.02
