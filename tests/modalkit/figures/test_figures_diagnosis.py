"""Figures of a diagnosis: what is on them, for every verdict."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from figure_cases import EFFECTS, case_of, diagnosis_of
from figure_text import assert_legible, panels, words
from hypothesis import given, settings
from hypothesis import strategies as st

from modalkit.figures import diagnosis_figure
from modalkit.figures.charts import gap_figure
from modalkit.output.words import answer
from modalkit.views.mode_errors import ModeErrors, mode_errors
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked
from updating.models.width import across_width


@pytest.mark.parametrize("kind", ["beam", "plate"])
@pytest.mark.parametrize("verdict", ["named", "class", "unknown", "none"])
def test_diagnosis_is_legible_for_every_verdict(kind: str, verdict: str) -> None:
    figure = diagnosis_figure(diagnosis_of(kind, verdict=verdict))
    assert {"gap", "causes", "where", "channels", "held out", "next"} <= set(panels(figure))
    assert_legible(figure)


@pytest.mark.parametrize("modes", [1, 12])
def test_diagnosis_names_every_mode(modes: int) -> None:
    figure = diagnosis_figure(diagnosis_of("beam", modes=modes))
    assert len(panels(figure)["gap"].get_yticks()) == modes
    assert_legible(figure)


@pytest.mark.long
@given(
    kind=st.sampled_from(["beam", "plate"]),
    x=st.floats(0.0, 0.4),
    y=st.floats(0.0, 0.25),
    first=st.sampled_from(EFFECTS),
    sets=st.integers(2, 8),
)
@settings(max_examples=6)
def test_diagnosis_is_legible_wherever_the_cause_sits(
    kind: str, x: float, y: float, first: str, sets: int
) -> None:
    place = (x, y if kind == "plate" else 0.0, 0.0)
    verdict = "named" if sets == 2 else "class"
    assert_legible(diagnosis_figure(diagnosis_of(kind, verdict=verdict, first=first, place=place, sets=sets)))


@pytest.mark.long
@pytest.mark.parametrize("kind", ["beam", "plate"])
def test_diagnosis_with_its_case_shows_points_and_sensor(kind: str) -> None:
    case = case_of(kind, factor=0.9)
    estimate = {"E.factor": ParameterEstimate(0.9, "-", 0.89, 0.91, False)}
    given_by_hand = diagnosis_of(kind, first="E", place=None)
    ranking = (replace(given_by_hand.ranking[0], parameters=estimate), *given_by_hand.ranking[1:])
    figure = diagnosis_figure(replace(given_by_hand, ranking=ranking), case)
    assert_legible(figure)
    text = words(figure)
    assert "test points" in text and "sensor" in text and "acts on all of it" in text


def test_a_parameter_is_written_whole_or_not_at_all() -> None:
    names = ("density", "surface", "bottom", "side", "extent", "mass", "ratio", "slope")
    sizes = {f"E.{name}": ParameterEstimate(0.9, "-", 0.891, 0.912, False) for name in names}
    aside = {"E.hidden": ParameterEstimate(0.5, "-", 0.4, 0.6, False, aside=True)}
    found = diagnosis_of("beam", first="E", place=None)
    ranking = (replace(found.ranking[0], parameters={**aside, **sizes}), *found.ranking[1:])
    text = " ".join(
        t.get_text() for t in panels(diagnosis_figure(replace(found, ranking=ranking)))["causes"].texts
    )
    assert "density" in text and "), …" in text and "hidden" not in text
    assert text.count("0.9") - text.count("0.912") == text.count("0.9 (0.891 to 0.912)") > 2


def test_errors_before_and_after_are_those_of_the_modulus() -> None:
    case = case_of("beam", factor=0.9, modes=2)  # which this mesh leaves no doubt in
    row = Ranked(
        effects=("E",),
        probability=0.9,
        equivalents=(),
        parameters={"E.factor": ParameterEstimate(0.9, "-", 0.89, 0.91, False)},
        plausible=True,
        p_value=0.5,
    )
    errors = mode_errors(replace(diagnosis_of("beam", first="E"), ranking=(row,)), case)
    assert errors.before == pytest.approx(100 * (1 / np.sqrt(0.9) - 1), abs=1e-6)
    assert errors.after is not None
    assert np.abs(errors.after).max() < 1e-6
    # noise alone: identification 1e-4 and re-mounting 5e-4, two standard deviations, in per cent
    assert errors.floor == pytest.approx(200 * np.hypot(1e-4, 5e-4))
    # a doubt of 1 % in E moves frequencies by 0.5 %, one of 0.5 % in thickness by 0.5 %; and all that beams leave out
    across = across_width(case.spec, np.arange(2), np.zeros(0)).stiffening
    assert errors.doubt == pytest.approx(200 * np.sqrt(2 * 0.005**2 + across**2 + 1e-8 + 25e-8), rel=1e-6)


def test_errors_without_a_case_are_those_of_the_table() -> None:
    diagnosis = diagnosis_of("beam")
    errors = mode_errors(diagnosis)
    assert errors.after is None
    assert errors.before.tolist() == diagnosis.gap.modes["error [%]"].tolist()


def test_answers_say_the_verdict() -> None:
    assert answer(diagnosis_of("beam")) == "A soft or stiff spot at x = 130 mm explains the gap"
    assert "at x = 130, y = 50 mm" in answer(diagnosis_of("plate"))
    mass = answer(diagnosis_of("beam", first="sensor_mass"))
    assert (
        mass.replace("\N{NO-BREAK SPACE}", " ")
        == "The mass of the sensor explains the gap: 12.1 g (95 %: 11.5 to 12.6)"
    )
    several = replace(diagnosis_of("beam"), sets=(("length", "sensor_mass"),))
    assert answer(several) == "The length and the mass of the sensor together explain the gap"
    several = replace(several, sets=(("length", "sensor_mass", "shear"),))
    assert answer(several).startswith("The length, the mass of the sensor, and shear")
    assert "cannot show which" in answer(diagnosis_of("beam", verdict="class", first="E"))
    assert "nothing in the library" in answer(diagnosis_of("beam", verdict="unknown"))
    assert answer(diagnosis_of("beam", verdict="none")).startswith("No gap")


@pytest.mark.parametrize("rings", [0, 6])
def test_the_title_of_no_gap_counts_the_rings_outside_the_band(rings: int) -> None:
    """No gap in all, and yet single modes outside their bands: the title says how many, not that all are within."""
    count = 8
    before = np.where(np.arange(count) < rings, 2.0, 0.1)
    doubt = np.full(count, 0.5)
    errors = ModeErrors(np.linspace(10, 90, count), before, None, doubt / 5, doubt, "frequency")
    message = words(gap_figure(errors))
    assert f"{rings or 'none'} outside the band of noise and tolerances" in message
    assert "within" not in message
