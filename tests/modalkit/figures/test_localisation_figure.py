"""The page on where the gap sits: zones, places, points concerned, and what every mode adds."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from figure_cases import case_of, diagnosis_of
from figure_text import assert_legible, panels, words

from modalkit.figures import localisation_figure
from modalkit.output.location import localisation_title
from updating import Diagnosis


def diagnosis_with(kind: str, verdict: str, *, modes: int = 6, points: tuple[int, ...] = (2,)) -> Diagnosis:
    plain = diagnosis_of(kind, verdict=verdict)
    names = ["frequency [sigma]", "damping [sigma]", "shape and level [sigma]", "share [%]"]
    values = np.linspace(-12, 140, modes)
    table = pd.DataFrame(
        {"test [Hz]": np.linspace(20, 1800, modes), **dict.fromkeys(names, values)}, index=range(1, modes + 1)
    )
    table.loc[2, "damping [sigma]"] = np.nan
    band = "The gap is largest in the shape and level of modes 2 to 4 (168.8 to 954.9 Hz): up to 8.08 sigma."
    by = "regions" if verdict == "unknown" else "explanations"
    return replace(plain, where=replace(plain.where, modes=table, band=band, points=points, zones_by=by))


@pytest.mark.parametrize("kind", ["beam", "plate"])
@pytest.mark.parametrize("verdict", ["named", "class", "unknown", "none"])
def test_localisation_is_legible_for_every_verdict(kind: str, verdict: str) -> None:
    figure = localisation_figure(diagnosis_with(kind, verdict, points=()), case_of(kind))
    assert {"where", "zones", "modes"} <= set(panels(figure))
    assert_legible(figure)


@pytest.mark.parametrize("kind", ["beam", "plate"])
def test_points_concerned_are_named(kind: str) -> None:
    message = words(localisation_figure(diagnosis_with(kind, "named"), case_of(kind)))
    assert "point 2" in message


@pytest.mark.parametrize("modes", [3, 12, 30])
def test_as_many_modes_as_fit_are_shown(modes: int) -> None:
    figure = localisation_figure(diagnosis_with("beam", "named", modes=modes))
    assert_legible(figure)
    assert len(panels(figure)["modes"].patches) == 3 * min(modes, 20)


def test_unknown_says_that_nothing_explains_and_how_zones_were_weighed() -> None:
    message = words(localisation_figure(diagnosis_with("beam", "unknown")))
    assert "No explanation was found for the gap" in message
    assert "as if one of them alone were changed" in message


def test_a_measurement_is_not_in_the_structure() -> None:
    plain = diagnosis_with("beam", "named")
    reversed_point = replace(plain, where=replace(plain.where, channel="measurement", points=(3,)))
    assert "in the measurement of point 3, not in the structure" in words(localisation_figure(reversed_point))


@pytest.mark.parametrize("channel", ["measurement", "mass"])
def test_the_title_places_a_pair_in_measurement_and_structure(channel: str) -> None:
    plain = diagnosis_with("beam", "named")
    pair = replace(plain.ranking[0], effects=("polarity", "lumped_mass"))
    both = replace(
        plain,
        sets=(pair.effects,),
        ranking=(pair, *plain.ranking[1:]),
        where=replace(plain.where, channel=channel, points=(3,)),
    )
    message = words(localisation_figure(both))
    assert "in the measurement of point 3 and in the structure" in message
    assert "not in the structure" not in message


def test_without_a_table_of_modes_the_structure_stands_alone() -> None:
    figure = localisation_figure(diagnosis_of("plate"))
    assert "modes" not in panels(figure)
    assert_legible(figure)


def spread(verdict: str, *sets: tuple[str, ...]) -> Diagnosis:
    """Return an answer of certain sets that has no single place."""
    plain = diagnosis_with("beam", verdict, points=())
    rows = tuple(replace(plain.ranking[0], effects=names, probability=0.9 / len(sets)) for names in sets)
    where = replace(plain.where, channel="stiffness", location=None, locations=(), names=())
    return replace(plain, sets=sets, ranking=rows, where=where)


def test_what_acts_everywhere_is_named_and_not_by_one_channel() -> None:
    """E is a stiffness, the density a mass, the thickness and the length both: the title names them, not a channel."""
    title = localisation_title(spread("class", ("E",), ("density",), ("thickness",), ("length",)))
    assert title.startswith("The gap has no single place: ")
    assert "stiffness" not in title and " or " in title
    for name in ("modulus", "density", "thickness", "length"):
        assert name in title
    many = localisation_title(
        spread("class", *((n,) for n in ("E", "density", "thickness", "length", "taper")))
    )
    assert many.endswith("or 1 other act all over the structure") or " or 1 other acts" in many


def test_measurement_or_structure_is_left_open_where_the_class_leaves_it_open() -> None:
    title = localisation_title(spread("class", ("calibration_gain",), ("density",)))
    assert title == "These data cannot show whether the gap lies in the measurement or in the structure"


def test_a_pair_of_causes_is_not_placed_whole_where_one_of_them_sits() -> None:
    plain = diagnosis_with("beam", "named", points=())
    pair = replace(plain, sets=(("length", "sensor_mass"),))
    assert localisation_title(pair).startswith("Part of the gap sits at")
    assert localisation_title(plain).startswith("The gap sits at")
