"""Five lines for every verdict: what, where, how far, how sure, what next.

The tests ask for the facts that a line states: names, numbers with their units, sentences of the library. How a line
words them is left to it; where only the wording can carry a fact, the line has to differ from that without the fact.
"""

import re
from dataclasses import replace
from typing import get_args

import numpy as np
import pandas as pd
import pytest

from modalkit.output.summary import searched_text, separated, summary_text
from modalkit.output.words import answer
from updating import LIBRARY, Diagnosis
from updating.diagnosis.answer.closing import Closed, Remainder, Shrink
from updating.diagnosis.answer.located import Where, Zone
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked
from updating.diagnosis.answer.result import Gap, NextTest, Shortcoming
from updating.diagnosis.search.compared import Searched

HEADS = ["Cause", "Where", "Closes", "Sure", "Next"]
FREE_END = (0.376, 0.0, 0.0)
MASS = ParameterEstimate(value=0.0123, unit="kg", low95=0.0119, high95=0.0127, at_bound=False)
FACTOR = ParameterEstimate(value=0.9, unit="-", low95=0.89, high95=0.91, at_bound=False)


def ranked(
    *effects: str,
    probability: float,
    p_value: float = 0.3,
    plausible: bool = True,
    **parameters: ParameterEstimate,
) -> Ranked:
    """Return a row of the ranking; parameters as ``effect__name``."""
    own = {name.replace("__", "."): estimate for name, estimate in parameters.items()}
    return Ranked(
        effects=effects,
        probability=probability,
        equivalents=(),
        parameters=own,
        plausible=plausible,
        p_value=p_value,
    )


def where(channel: str, channels: dict[str, float], **more: object) -> Where:
    """Return a place, by default nowhere in particular."""
    nowhere = {"location": None, "locations": (), "points": (), "zones": ()}
    return Where(channel=channel, channels=channels, **{**nowhere, **more})  # type: ignore[arg-type]


SENSOR = ranked("sensor_mass", probability=0.97, p_value=0.4, sensor_mass__mass=MASS)
E = ranked("E", probability=0.02, p_value=0.001, E__factor=FACTOR)
TIP = where(
    "mass",
    {"mass": 0.97, "stiffness": 0.03},
    location=FREE_END,
    locations=(FREE_END,),
    points=(5,),
    nearest=(5,),
)
NAMED = Diagnosis(
    title="beam",
    significant=True,
    p_value=1e-12,
    gap=Gap(modes=pd.DataFrame(), rms_percent=5.0, floor_percent=0.05, frac=np.zeros(0)),
    where=TIP,
    shrink=Shrink(
        metric="frequency",
        before=5.0,
        after=0.1,
        held_before=5.0,
        held_after=0.2,
        held_runner_up=1.5,
        held_nuisance=4.0,
        floor=0.05,
        closed=Closed(value=99.0, low95=97.0, high95=99.8),
    ),
    verdict="named",
    sets=(("sensor_mass",),),
    ranking=(SENSOR, E),
    next_test=(),
    warnings=(),
    not_examined={},
)
TESTS = (NextTest("weigh the specimen", ("E", "density"), 8.4), NextTest("calibrate", ("E", "density"), 3.0))
SPLIT = replace(
    NAMED,
    where=where("stiffness", {"stiffness": 0.6, "mass": 0.4}),
    verdict="class",
    sets=(("E",), ("density", "length")),
    ranking=(replace(E, probability=0.6), ranked("density", "length", probability=0.38)),
    next_test=TESTS,
)
UNKNOWN = replace(NAMED, verdict="unknown", sets=(), where=replace(TIP, points=()))
NONE = replace(
    NAMED,
    significant=False,
    p_value=0.4,
    verdict="none",
    sets=(),
    where=where("none", {"none": 0.9, "mass": 1.0}),
    shrink=replace(NAMED.shrink, closed=None, held_runner_up=None),
    ranking=tuple(replace(row, probability=0.1) for row in NAMED.ranking),
)


def lines(diagnosis: Diagnosis, **changes: object) -> dict[str, str]:
    """Return what follows each head, of a diagnosis with some changes."""
    found = summary_text(replace(diagnosis, **changes))  # type: ignore[arg-type]
    assert all("\n" not in line and len(line) > 15 for line in found)
    assert not any(word in " ".join(found) for word in ("nan", "None", "inf ", "()"))
    split = dict(re.split(r":\s+", line, maxsplit=1) for line in found)
    assert list(split) == HEADS
    return split


def numbers(text: str) -> list[str]:
    """Return the numbers of a line in their order, each with its unit."""
    return re.findall(r"(?<![\w.])-?\d[\d.]*(?:e-?\d+)?(?:(?<=\d) (?:%|g|mm|sigma))?", text)


@pytest.mark.parametrize("diagnosis", [NAMED, SPLIT, UNKNOWN, NONE])
def test_five_lines_for_every_verdict(diagnosis: Diagnosis) -> None:
    lines(diagnosis)
    lines(diagnosis, ranking=() if diagnosis.verdict in ("unknown", "none") else diagnosis.ranking)


def test_points_of_the_measurement_are_not_called_nearest_to_a_place_in_the_structure() -> None:
    place = (0.31, 0.0, 0.0)
    at = replace(TIP, location=place, locations=(place,), points=(5,), nearest=(3,))
    both, near = lines(NAMED, where=at)["Where"], lines(NAMED, where=replace(at, points=()))["Where"]
    assert numbers(both) == ["97 %", "310 mm", "3", "5"]
    assert numbers(near) == ["97 %", "310 mm", "3"]
    assert both.startswith(near)


def test_a_sensor_is_named_in_the_sentence_on_the_cause() -> None:
    channel = ParameterEstimate(value="5+Z", unit="channel", low95=None, high95=None, at_bound=False)
    row = ranked("channel_gain", probability=0.97, channel_gain__gain=FACTOR, channel_gain__channel=channel)
    stated = lines(NAMED, sets=(row.effects,), ranking=(row, E))["Cause"]
    assert LIBRARY["channel_gain"].sentence({"channel": "5+Z"}) in stated


def test_unknown_says_what_the_nearest_set_lacks() -> None:
    """In a sentence for each; where nothing fits, or hardly a mode has a partner, no set is named."""
    stated = {
        lacks: lines(UNKNOWN, lacks=lacks, comparable=lacks != "partners")["Cause"]
        for lacks in get_args(Shortcoming)
    }
    assert len(set(stated.values())) == len(stated)
    assert {lacks for lacks, text in stated.items() if "sensor_mass" not in text} == {"fit", "partners"}
    assert numbers(stated["evidence"]) == ["20"]  # as many times as likely


def test_unknown_says_that_the_nearest_set_fits_at_an_unlikely_size() -> None:
    at_bound = replace(MASS, at_bound=True)
    heavy = ranked("sensor_mass", probability=0.97, p_value=0.4, plausible=False, sensor_mass__mass=at_bound)
    nothing = lines(UNKNOWN, lacks="fit")["Cause"]
    fits = lines(UNKNOWN, lacks="fit", ranking=(heavy, E))["Cause"]
    assert "sensor_mass.mass" in fits
    assert numbers(fits) == ["12.3 g"]
    assert lines(UNKNOWN, lacks="fit", ranking=(replace(heavy, p_value=1e-5), E))["Cause"] == nothing


def test_no_gap_in_the_few_modes_that_are_paired_frees_no_model_for_use() -> None:
    found, plain = lines(NONE, comparable=False), lines(NONE)
    assert found["Cause"] != plain["Cause"]
    assert found["Next"] != plain["Next"]


def test_a_gap_that_is_not_remarkable_by_its_size_tells_by_its_pattern() -> None:
    rare, common, more = (lines(NAMED, p_value=chance)["Sure"] for chance in (1e-12, 0.2, 0.3))
    assert numbers(common)[-1] == "0.2"
    assert common.replace("0.2", "0.3") == more
    assert len(common) > len(rare)


def test_halves_of_a_pair_are_both_placed() -> None:
    ends = ((0.0, 0.0, 0.0), FREE_END)
    both = replace(TIP, channels={"mass": 0.5, "stiffness": 0.495}, locations=ends)
    found = lines(NAMED, where=replace(both, channel="stiffness", location=ends[0]))["Where"]
    assert all(channel in found for channel in ("stiffness", "mass"))
    assert numbers(found)[:3] == ["50 %", "0 mm", "376 mm"]


def test_what_fits_but_for_odd_data_says_so() -> None:
    odd = Remainder(significant=True, percent=0.3, sigma=12.0, carried_by=("mode 9 shape",))
    found, plain = lines(NAMED, remainder=odd), lines(NAMED)
    assert found["Sure"] != plain["Sure"]
    assert found["Closes"].startswith(plain["Closes"])
    assert "mode 9 shape" in found["Closes"]
    assert "12 sigma" in numbers(found["Closes"])


def test_a_likely_cause_of_a_gap_that_chance_might_make_is_named() -> None:
    found, plain = lines(NONE, ranking=NAMED.ranking), lines(NONE)
    assert "sensor_mass" in found["Cause"]
    assert numbers(found["Cause"]) == ["97 %"]
    assert "sensor_mass" not in plain["Cause"]
    assert all(found[head] != plain[head] for head in ("Cause", "Where", "Next"))


def test_a_named_cause_says_its_size_its_place_and_its_test() -> None:
    found = lines(NAMED)
    assert found["Cause"].startswith("sensor_mass")
    assert LIBRARY["sensor_mass"].summary in found["Cause"]
    assert numbers(found["Cause"])[:3] == ["12.3 g", "11.9", "12.7"]
    assert found["Where"].startswith("mass")
    assert numbers(found["Where"]) == ["97 %", "376 mm", "5"]
    before, after, held, floor = ["5 %", "0.1 %"], ["0.2 %"], ["0.05 %"], ["1.5 %", "4 %"]
    assert numbers(found["Closes"]) == [*before, *after, *held, *floor, "99 %", "97", "100"]
    assert numbers(found["Sure"]) == ["97 %", "2 %", "0.4", "1e-12"]
    assert LIBRARY["sensor_mass"].separated_by in found["Next"]


def test_a_test_confirms_only_what_it_tells_from_the_most_probable_other_set() -> None:
    own, rival = ("sensor_mass",), ("E",)
    sure = NextTest("weigh the sensor", ("sensor_mass", "E"), 8.4, ((own, rival),))
    confirms = lines(NAMED, next_test=(sure,))["Next"]
    assert sure.measure in confirms
    weak = lines(NAMED, next_test=(replace(sure, expected_sigma=1.1),))["Next"]
    assert confirms not in weak
    assert numbers(weak)[-2:] == ["3 sigma", "1 sigma"]  # what it would take, and what it does
    assert weak.startswith("look at the structure at x = 376 mm first; ")
    unplaced = replace(TIP, location=None, locations=())
    assert "look" not in lines(NAMED, where=unplaced, next_test=(sure,))["Next"]
    aside = replace(sure, pairs=((own, ("density",)),))
    assert re.search(rf"{separated(aside)}.*\bE\b", lines(NAMED, next_test=(aside,))["Next"])
    more = ranked("sensor_mass", "density", probability=0.02)
    larger = lines(NAMED, ranking=(SENSOR, more), next_test=(sure,))["Next"]
    assert larger.startswith(confirms)
    assert "sensor_mass + density" in larger


def test_a_pair_is_named_with_both() -> None:
    both = ranked("E", "sensor_mass", probability=0.99, E__factor=FACTOR, sensor_mass__mass=MASS)
    found = lines(NAMED, sets=(both.effects,), ranking=(both,))["Cause"]
    assert found.startswith("E + sensor_mass.")
    assert numbers(found)[:6] == ["0.9", "0.89", "0.91", "12.3 g", "11.9", "12.7"]


def test_an_effect_without_parameters_and_one_from_outside() -> None:
    for name in ("shear", "gremlin"):
        row = ranked(name, probability=0.99)
        found = lines(NAMED, sets=((name,),), ranking=(row,))["Cause"]
        assert found.startswith(name)
        assert numbers(found) == []


def test_a_class_lists_all_of_it_and_the_test_that_splits_it() -> None:
    found = lines(SPLIT)
    assert re.search(r"\bE \(x 0.9\), density \+ length$", found["Cause"])
    assert numbers(found["Where"]) == ["60 %"]
    assert numbers(found["Sure"])[0] == "98 %"  # together
    assert found["Next"] == f"weigh the specimen: {separated(TESTS[0])}"
    without = lines(SPLIT, next_test=())["Next"]
    assert LIBRARY["density"].separated_by in without
    assert LIBRARY["length"].separated_by in without


def test_a_test_that_separates_pairs_reads_as_such() -> None:
    """Three names of two sets are not three things to tell from one another."""
    three = (NextTest("weigh the specimen", ("E", "density", "length"), 8.4),)
    assert numbers(lines(SPLIT, next_test=three)["Next"]) == ["8 sigma"]


def test_the_unknown_is_not_dressed_up() -> None:
    """It states neither a place nor a probability of what it does not know."""
    found = lines(UNKNOWN)
    assert numbers(found["Where"]) == []
    assert numbers(found["Sure"]) == ["1e-12"]
    assert not any(name in " ".join(found.values()) for name in ("sensor_mass", "closes"))


def test_no_gap_needs_nothing() -> None:
    found = lines(NONE)
    assert numbers(found["Where"]) == []
    assert numbers(found["Closes"]) == ["5 %"]  # what there is, with no misfit beside a chance of one
    assert numbers(found["Sure"])[-1] == "0.4" and "probable that there is no cause" in found["Sure"]
    assert numbers(found["Next"]) == []


def test_a_gap_too_small_to_close_says_no_share() -> None:
    """Nor an error of a runner-up that there is not."""
    small = replace(NAMED.shrink, closed=None, held_runner_up=None)
    assert numbers(lines(NAMED, shrink=small)["Closes"]) == ["5 %", "0.1 %", "0.2 %", "0.05 %", "4 %"]


def test_a_fault_of_the_measurement_has_no_place_on_the_structure() -> None:
    chain = where("measurement", {"measurement": 1.0})
    assert lines(NAMED, where=chain)["Where"] == "measurement (> 99.9 %)"


def test_a_place_on_a_plate_has_two_coordinates_and_its_mirror_images() -> None:
    corner, mirrored = (0.3, 0.15, 0.0), (0.3, 0.05, 0.0)
    one = replace(TIP, location=corner, locations=(corner,), points=(7, 9), nearest=(7, 9))
    found = lines(NAMED, where=one)["Where"]
    assert "x = 300, y = 150 mm" in found
    assert numbers(found)[-2:] == ["7", "9"]
    both = replace(TIP, location=corner, locations=(corner, mirrored), points=(), nearest=())
    assert lines(NAMED, where=both)["Where"].endswith("x = 300, y = 150 mm and x = 300, y = 50 mm")


def test_effects_that_are_equal_by_physics_are_called_so() -> None:
    """What no hammer test separates is not said to be separated by one."""
    names = ("calibration_gain", "section_scale")
    rows = tuple(ranked(name, probability=0.5) for name in names)
    found = lines(SPLIT, sets=tuple(row.effects for row in rows), ranking=rows, next_test=TESTS)
    assert all(name in found["Cause"] for name in names)
    assert TESTS[0].measure not in found["Next"]


def test_a_size_at_the_end_of_its_range_is_called_unlikely() -> None:
    """Both are said: where the size is, and that it is implausible."""
    at_bound = replace(SENSOR, parameters={"sensor_mass.mass": replace(MASS, at_bound=True)})
    rows = (SENSOR, at_bound, replace(at_bound, plausible=False))
    plain, bound, both = (lines(NAMED, ranking=(row, E))["Cause"] for row in rows)
    assert len(plain) < len(bound) < len(both)
    assert numbers(both) == numbers(plain)


def test_tolerances_that_would_have_to_be_absurd_are_said_to_be() -> None:
    found = lines(NAMED, shrink=replace(NAMED.shrink, stretch=28.0))["Closes"]
    assert numbers(found)[5:8] == ["4 %", "3 sigma", "28 sigma"]


def test_with_one_mode_nothing_is_held_out() -> None:
    nan = float("nan")
    single = replace(NAMED.shrink, held_after=nan, held_nuisance=nan, held_runner_up=nan, closed=None)
    assert numbers(lines(NAMED, shrink=single)["Closes"]) == ["5 %", "0.1 %", "0.05 %"]


def test_all_data_together_are_stated_in_standard_deviations() -> None:
    combined = replace(NAMED.shrink, metric="combined", before=1200.0, after=90.0)
    assert numbers(lines(NAMED, shrink=combined)["Closes"])[:2] == ["12 sigma", "0.9 sigma"]


def test_a_test_says_which_it_tells_from_which() -> None:
    a, b, c = ("E",), ("density",), ("length", "thickness")
    whole = NextTest("weigh", ("E", "density"), 5.2, ((a, b), (a, c), (b, c)))
    assert numbers(separated(whole)) == ["5 sigma"]
    assert not any(name in separated(whole) for name in ("density", "length"))  # all of them
    one = NextTest("weigh", ("E", "density"), 5.2, ((a, b), (c, b)), whole=False)
    assert re.search(r"density .*\bE\b.* length \+ thickness .*5 sigma$", separated(one))
    assert separated(NextTest("look", (), float("nan"), whole=False)) == ""


def test_a_region_is_named_where_there_are_others() -> None:
    tip, root = Zone("tip", (0.3, 0.0, 0.0), 0.9), Zone("root", (0.1, 0.0, 0.0), 0.1)
    assert re.search(r"\btip\b", lines(NAMED, where=replace(TIP, zones=(root, tip)))["Where"])
    assert not re.search(r"\btip\b", lines(NAMED, where=replace(TIP, zones=(tip,)))["Where"])


def test_how_many_sets_were_searched_is_stated() -> None:
    singles, pairs = Searched(causes=1, sets=26, possible=26), Searched(causes=2, sets=10, possible=331)
    assert numbers(searched_text(replace(NAMED, searched=(singles, pairs)))) == ["26", "10", "331"]
    assert numbers(searched_text(replace(NAMED, searched=(singles,)))) == ["26"]


@pytest.mark.parametrize(
    ("low", "high", "stated"), [(-17131.0, 100.0, False), (-20.0, 60.0, True), (5.0, 100.0, True)]
)
def test_a_share_from_nothing_to_all_is_not_stated(low: float, high: float, stated: bool) -> None:
    open_share = replace(NAMED, shrink=replace(NAMED.shrink, closed=Closed(37.0, low, high)))
    line = summary_text(open_share)[2]
    assert ("closes 37 %" in line) is stated
    assert ("not determined" in line) is not stated


@pytest.mark.parametrize("verdict", ["named", "class"])
def test_a_mirrored_region_stands_in_the_cause(verdict: str) -> None:
    """Softer columns of the first storey and of the third shift the modes of a symmetric frame alike."""
    soft = Ranked(
        effects=("local_stiffness",),
        probability=0.9,
        equivalents=(),
        parameters={"local_stiffness.loss": ParameterEstimate(0.4, "-", 0.3, 0.5, False)},
        plausible=True,
        p_value=0.4,
        forms=({"region": "storey_3"},),
        other_forms=(({"region": "storey_1"},),),
    )
    sets = (("local_stiffness",), ("E",))[: 1 + (verdict == "class")]
    line = summary_text(replace(NAMED, verdict=verdict, sets=sets, ranking=(soft, E)))[0]  # type: ignore[arg-type]
    assert "storey_1" in line


def test_no_gap_beside_what_the_theory_neglects_says_how_much_that_is() -> None:
    said = "once shear and rotary inertia are counted, which the model neglects (up to 2.8 % of a frequency)"
    thin = lines(NONE, beneath=2.8)
    assert said in thin["Cause"]
    assert thin["Closes"].endswith(f"no more than tolerances and noise allow {said}")
    assert said in answer(replace(NONE, beneath=2.8))
    assert "neglects" not in " ".join([*lines(NONE).values(), answer(NONE)])
