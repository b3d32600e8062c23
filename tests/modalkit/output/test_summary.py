"""Five lines for every verdict: what, where, how far, how sure, what next."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from modalkit.output.summary import searched_text, separated, summary_text
from updating import LIBRARY, Diagnosis
from updating.diagnosis.answer.result import (
    Closed,
    Gap,
    NextTest,
    ParameterEstimate,
    Ranked,
    Remainder,
    Shortcoming,
    Shrink,
    Where,
    Zone,
)
from updating.diagnosis.search.search import Searched

HEADS = ["Cause:", "Where:", "Closes:", "Sure:", "Next:"]
MASS = ParameterEstimate(0.0123, "kg", 0.0119, 0.0127, False)
SENSOR = Ranked(("sensor_mass",), 0.97, (), {"sensor_mass.mass": MASS}, True, 0.4)
E = Ranked(("E",), 0.02, (), {"E.factor": ParameterEstimate(0.9, "-", 0.89, 0.91, False)}, True, 0.001)
TIP = Where(
    "mass", {"mass": 0.97, "stiffness": 0.03}, (0.376, 0.0, 0.0), ((0.376, 0.0, 0.0),), (5,), (), nearest=(5,)
)
NAMED = Diagnosis(
    "beam",
    True,
    1e-12,
    Gap(pd.DataFrame(), 5.0, 0.05, np.zeros(0)),
    TIP,
    Shrink("frequency", 5.0, 0.1, 5.0, 0.2, 1.5, 4.0, 0.05, Closed(99.0, 97.0, 99.8)),
    "named",
    (("sensor_mass",),),
    (SENSOR, E),
    (),
    (),
    {},
)
SPREAD = Where("stiffness", {"stiffness": 0.6, "mass": 0.4}, None, (), (), ())
TESTS = (NextTest("weigh the specimen", ("E", "density"), 8.4), NextTest("calibrate", ("E", "density"), 3.0))
SPLIT = replace(
    NAMED,
    where=SPREAD,
    verdict="class",
    sets=(("E",), ("density", "length")),
    ranking=(replace(E, probability=0.6), Ranked(("density", "length"), 0.38, (), {}, True, 0.3)),
    next_test=TESTS,
)
UNKNOWN = replace(NAMED, verdict="unknown", sets=(), where=replace(TIP, points=()))
NONE = replace(
    NAMED,
    significant=False,
    p_value=0.4,
    verdict="none",
    sets=(),
    where=Where("none", {"none": 0.9, "mass": 1.0}, None, (), (), ()),
    shrink=replace(NAMED.shrink, closed=None, held_runner_up=None),
    ranking=tuple(replace(row, probability=0.1) for row in NAMED.ranking),
)


def lines(diagnosis: Diagnosis) -> dict[str, str]:
    found = summary_text(diagnosis)
    assert [line.split()[0] for line in found] == HEADS
    assert all("\n" not in line and len(line) > 15 for line in found)
    assert not any(word in " ".join(found) for word in ("nan", "None", "inf "))
    return {line.split(":")[0]: line for line in found}


@pytest.mark.parametrize("diagnosis", [NAMED, SPLIT, UNKNOWN, NONE])
def test_five_lines_for_every_verdict(diagnosis: Diagnosis) -> None:
    lines(diagnosis)
    lines(replace(diagnosis, ranking=()) if diagnosis.verdict in ("unknown", "none") else diagnosis)


def test_points_of_the_measurement_are_not_called_nearest_to_a_place_in_the_structure() -> None:
    place = (0.31, 0.0, 0.0)
    where = replace(TIP, location=place, locations=(place,), points=(5,), nearest=(3,))
    message = lines(replace(NAMED, where=where))["Where"]
    assert message.endswith("at x = 310 mm (nearest test point 3); in the measurement, point 5")


def test_a_sensor_is_named_in_the_sentence_on_the_cause() -> None:
    channel = ParameterEstimate("5+Z", "channel", None, None, False)
    gain = ParameterEstimate(0.9, "-", 0.89, 0.91, False)
    row = replace(
        SENSOR,
        effects=("channel_gain",),
        parameters={"channel_gain.gain": gain, "channel_gain.channel": channel},
    )
    message = lines(replace(NAMED, sets=(row.effects,), ranking=(row, E)))["Cause"]
    assert "The calibration of the sensor 5+Z is off: its FRFs" in message
    assert "every FRF" not in message


def test_the_summary_states_that_most_modes_have_no_partner() -> None:
    message = lines(replace(UNKNOWN, comparable=False))["Cause"]
    assert "most measured modes have no partner" in message
    assert "nothing in the library" not in message


@pytest.mark.parametrize(
    ("lacks", "words"),
    [
        ("fit", "nothing in the library"),
        ("closing", "closes too little"),
        ("evidence", "20 times"),
        ("one size", "another size"),
    ],
)
def test_unknown_says_what_the_nearest_set_lacks(lacks: Shortcoming, words: str) -> None:
    message = lines(replace(UNKNOWN, lacks=lacks))["Cause"]
    assert words in message
    assert ("sensor_mass" in message) == (lacks != "fit")


def test_unknown_says_that_the_nearest_set_fits_at_an_unlikely_size() -> None:
    heavy = replace(SENSOR, parameters={"sensor_mass.mass": replace(MASS, at_bound=True)}, plausible=False)
    message = lines(replace(UNKNOWN, lacks="fit", ranking=(heavy, E)))["Cause"]
    assert "sensor_mass fits, at the end of what is believed of it: sensor_mass.mass = 12.3 g" in message
    badly = replace(heavy, p_value=1e-5)
    assert "nothing in the library" in lines(replace(UNKNOWN, lacks="fit", ranking=(badly, E)))["Cause"]


def test_no_gap_in_the_few_modes_that_are_paired_frees_no_model_for_use() -> None:
    found = lines(replace(NONE, comparable=False))
    assert "most have none" in found["Cause"]
    assert "see first why most modes have no partner" in found["Next"]


@pytest.mark.parametrize(("chance", "worded"), [(1e-4, False), (0.3, True)])
def test_a_gap_that_is_not_remarkable_by_its_size_tells_by_its_pattern(
    chance: float, *, worded: bool
) -> None:
    assert ("its pattern tells" in lines(replace(NAMED, p_value=chance))["Sure"]) is worded


def test_halves_of_a_pair_are_both_placed() -> None:
    both = replace(
        TIP, channels={"mass": 0.5, "stiffness": 0.495}, locations=((0.0, 0.0, 0.0), (0.376, 0.0, 0.0))
    )
    found = lines(replace(NAMED, where=replace(both, channel="stiffness", location=(0.0, 0.0, 0.0))))["Where"]
    assert "stiffness and mass (50 % each), at x = 0 mm and x = 376 mm" in found


def test_what_fits_but_for_odd_data_says_so() -> None:
    odd = replace(NAMED, remainder=Remainder(True, 0.3, 12.0, ("mode 9 shape",)))
    assert "all else fits within the noise" in lines(odd)["Sure"]
    assert "; fits within the noise" in lines(NAMED)["Sure"]


def test_a_likely_cause_of_a_gap_that_chance_might_make_is_named() -> None:
    message = lines(replace(NONE, ranking=NAMED.ranking))
    assert "should there be one, sensor_mass is its likeliest cause" in message["Cause"]
    assert "nowhere that is sure" in message["Where"]
    assert "test again" in message["Next"]


def test_a_named_cause_says_its_size_its_place_and_its_test() -> None:
    message = lines(NAMED)
    assert "sensor_mass" in message["Cause"]
    assert "mass 12.3 g (11.9 to 12.7)" in message["Cause"]
    assert LIBRARY["sensor_mass"].summary in message["Cause"]
    assert "mass (97 %), at x = 376 mm (nearest test point 5)" in message["Where"]
    assert "5 % -> 0.1 % fitted, 0.2 % on modes held out (noise floor 0.05 %)" in message["Closes"]
    assert "runner-up 1.5 %" in message["Closes"]
    assert "tolerances alone 4 %" in message["Closes"]
    assert "closes 99 % (97 to 100) of what can be closed" in message["Closes"]
    assert "97 % probable" in message["Sure"]
    assert "next E 2 %" in message["Sure"]
    assert "p = 1e-12" in message["Sure"]
    assert LIBRARY["sensor_mass"].separated_by in message["Next"]


def test_a_test_confirms_only_what_it_tells_from_the_most_probable_other_set() -> None:
    own, next_set = ("sensor_mass",), ("E",)
    sure = NextTest("weigh the sensor", ("sensor_mass", "E"), 8.4, ((own, next_set),))
    assert lines(replace(NAMED, next_test=(sure,)))["Next"].startswith(
        "Next:    to confirm it, weigh the sensor"
    )
    weak = lines(replace(NAMED, next_test=(replace(sure, expected_sigma=1.1),)))["Next"]
    assert "to confirm it" not in weak
    assert "no test that was weighed would confirm it, by 3 sigma" in weak
    assert weak.endswith("separates sensor_mass from E by 1 sigma")
    other = replace(sure, pairs=((own, ("density",)),))
    assert lines(replace(NAMED, next_test=(other,)))["Next"].endswith("from E it does not tell it")
    more = Ranked(("sensor_mass", "density"), 0.02, (), {}, True, 0.3)
    larger = lines(replace(NAMED, ranking=(SENSOR, more), next_test=(sure,)))["Next"]
    assert larger.endswith("from sensor_mass + density, which has all of it and more, it does not tell it")


def test_a_pair_is_named_with_both() -> None:
    both = Ranked(("E", "sensor_mass"), 0.99, (), {**E.parameters, **SENSOR.parameters}, True, 0.5)
    message = lines(replace(NAMED, sets=(both.effects,), ranking=(both,)))
    assert message["Cause"].startswith("Cause:   E + sensor_mass.")
    assert "E factor 0.9 (0.89 to 0.91); mass 12.3 g" in message["Cause"]


def test_an_effect_without_parameters_and_one_from_outside() -> None:
    shear = Ranked(("shear",), 0.99, (), {}, True, 0.5)
    assert "()" not in lines(replace(NAMED, sets=(("shear",),), ranking=(shear,)))["Cause"]
    strange = Ranked(("gremlin",), 0.99, (), {}, True, 0.5)
    assert "gremlin" in lines(replace(NAMED, sets=(("gremlin",),), ranking=(strange,)))["Cause"]


def test_a_class_lists_all_of_it_and_the_test_that_splits_it() -> None:
    message = lines(SPLIT)
    assert "cannot tell apart: E (x 0.9), density + length" in message["Cause"]
    assert "spread over the whole structure" in message["Where"]
    assert "98 % probable together" in message["Sure"]
    assert "weigh the specimen: separates E from density by 8 sigma" in message["Next"]
    without = lines(replace(SPLIT, next_test=()))["Next"]
    assert LIBRARY["density"].separated_by in without
    assert LIBRARY["length"].separated_by in without


def test_a_test_that_separates_pairs_reads_as_such() -> None:
    """Three names of two sets are not three things to tell from one another."""
    three = (NextTest("weigh the specimen", ("E", "density", "length"), 8.4),)
    assert "by 8 sigma" in lines(replace(SPLIT, next_test=three))["Next"]


def test_the_unknown_is_not_dressed_up() -> None:
    message = lines(UNKNOWN)
    assert "unknown" in message["Cause"]
    assert "do not trust it" in message["Where"]
    assert "376" not in message["Where"]
    assert "97" not in message["Sure"]
    assert "modes that miss most" in message["Next"]


def test_no_gap_needs_nothing() -> None:
    message = lines(NONE)
    assert "no gap" in message["Cause"]
    assert "nowhere" in message["Where"]
    assert "nothing to close" in message["Closes"]
    assert "p = 0.4" in message["Sure"]
    assert "within its tolerances" in message["Next"]


def test_a_gap_too_small_to_close_says_no_share() -> None:
    small = replace(NAMED, shrink=replace(NAMED.shrink, closed=None, held_runner_up=None))
    message = lines(small)["Closes"]
    assert "of what can be closed" not in message
    assert "runner-up" not in message


def test_a_fault_of_the_measurement_has_no_place_on_the_structure() -> None:
    chain = Where("measurement", {"measurement": 1.0}, None, (), (), ())
    assert lines(replace(NAMED, where=chain))["Where"] == "Where:   measurement (> 99.9 %)"


def test_a_place_on_a_plate_has_two_coordinates_and_its_mirror_images() -> None:
    corner = (0.3, 0.15, 0.0)
    found = replace(TIP, location=corner, locations=(corner,), points=(7, 9), nearest=(7, 9))
    message = lines(replace(NAMED, where=found))["Where"]
    assert message.endswith("at x = 300, y = 150 mm (nearest test points 7, 9)")
    both = replace(TIP, location=corner, locations=(corner, (0.3, 0.05, 0.0)), points=(), nearest=())
    message = lines(replace(NAMED, where=both))["Where"]
    assert message.endswith("at x = 300, y = 150 mm and x = 300, y = 50 mm")


def test_effects_that_are_equal_by_physics_are_called_so() -> None:
    gain = Ranked(("calibration_gain",), 0.5, (("section_scale",),), {}, True, 0.5)
    width = Ranked(("section_scale",), 0.49, (("calibration_gain",),), {}, True, 0.5)
    message = lines(replace(SPLIT, sets=(gain.effects, width.effects), ranking=(gain, width), next_test=()))
    assert "no hammer test" not in message["Next"]
    assert "scale every FRF and nothing else" in message["Cause"]
    assert "calibrate the chain" in message["Next"]


def test_a_size_at_the_end_of_its_range_is_called_unlikely() -> None:
    heavy = replace(SENSOR, parameters={"sensor_mass.mass": replace(MASS, at_bound=True)}, plausible=False)
    message = lines(replace(NAMED, ranking=(heavy, E)))["Cause"]
    assert "the end of its range" in message
    assert "hardly believable" in message


def test_tolerances_that_would_have_to_be_absurd_are_said_to_be() -> None:
    message = lines(replace(NAMED, shrink=replace(NAMED.shrink, stretch=28.0)))["Closes"]
    assert (
        "tolerances alone 4 % (kept within 3 sigma; to explain it they would have to be 28 sigma off)"
        in message
    )


def test_with_one_mode_nothing_is_held_out() -> None:
    nan = float("nan")
    single = replace(NAMED.shrink, held_after=nan, held_nuisance=nan, held_runner_up=nan, closed=None)
    assert "none can be held out" in lines(replace(NAMED, shrink=single))["Closes"]


def test_all_data_together_are_told_in_standard_deviations() -> None:
    message = lines(
        replace(NAMED, shrink=replace(NAMED.shrink, metric="combined", before=1200.0, after=90.0))
    )
    assert "misfit of all data 12 sigma -> 0.9 sigma fitted" in message["Closes"]


def test_a_test_says_which_it_tells_from_which() -> None:
    a, b, c = ("E",), ("density",), ("length", "thickness")
    whole = NextTest("weigh", ("E", "density"), 5.2, ((a, b), (a, c), (b, c)))
    assert separated(whole) == "separates all that is left by 5 sigma"
    one = NextTest("weigh", ("E", "density"), 5.2, ((a, b), (c, b)), whole=False)
    assert separated(one) == "separates density from E and length + thickness by 5 sigma"
    assert separated(NextTest("look", (), float("nan"), whole=False)) == ""


def test_a_region_is_named_where_there_are_others() -> None:
    tip, root = Zone("tip", (0.3, 0.0, 0.0), 0.9), Zone("root", (0.1, 0.0, 0.0), 0.1)
    several = replace(NAMED, where=replace(TIP, zones=(root, tip)))
    assert ", region tip" in summary_text(several)[1]
    assert "region" not in summary_text(replace(NAMED, where=replace(TIP, zones=(tip,))))[1]


def test_how_many_sets_were_searched_is_stated() -> None:
    singles, pairs = Searched(1, 26, 26), Searched(2, 10, 331)
    message = searched_text(replace(NAMED, searched=(singles, pairs)))
    assert message.startswith("all 26 single causes, 10 of 331 pairs")
    assert "not ruled out" in message
    assert searched_text(replace(NAMED, searched=(singles,))) == "all 26 single causes"


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
        ("local_stiffness",),
        0.9,
        (),
        {"local_stiffness.loss": ParameterEstimate(0.4, "-", 0.3, 0.5, False)},
        True,
        0.4,
        ({"region": "storey_3"},),
        (({"region": "storey_1"},),),
    )
    sets = (("local_stiffness",), ("E",))[: 1 + (verdict == "class")]
    line = summary_text(replace(NAMED, verdict=verdict, sets=sets, ranking=(soft, E)))[0]  # type: ignore[arg-type]
    assert "storey_1" in line
