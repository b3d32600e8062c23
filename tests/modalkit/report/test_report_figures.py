"""The figures and tables of reports: each has its place, its words and its data."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from figure_cases import model_of
from figure_text import assert_legible
from report_pages import NOON, ROOT, Reader, complete, data_of, diagnosis_page, session_of
from test_localisation_figure import diagnosis_with

from acquisition import Dof, FrfSet
from modalkit.figures.diagnosis.all import Drawing, drawings
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from modalkit.workflow.fitted import fitted
from modalkit.workflow.overlaid import LINES, selected_lines
from updating.diagnosis.answer.closing import HeldPoints, Shrink
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked


@pytest.mark.long
def test_every_figure_has_its_place_its_words_and_its_data(tmp_path: Path) -> None:
    page = diagnosis_page(
        complete(diagnosis_with("plate", "named")), [session_of("plate", tmp_path)], when=NOON
    )
    figures = [a for tag, a in Reader(page).tags if tag == "figure"]
    charts = data_of(page)["charts"]
    assert [a["id"] for a in figures] == [c["name"] for c in charts] == ["gap", "place", "causes", "closing"]
    for figure, chart in zip(figures, charts, strict=True):
        assert figure["aria-labelledby"] in Reader(page).values("id")
        assert chart["title"] in Reader(page).text and chart["text"] in Reader(page).text
        assert any(one["y"] or one.get("value") for one in chart["series"])


def test_the_answer_is_marked_with_its_interval(tmp_path: Path) -> None:
    estimate = ParameterEstimate(0.0121, "kg", 0.0115, 0.0126, False)
    row = Ranked(
        effects=("sensor_mass",),
        probability=0.97,
        equivalents=(("lumped_mass",),),
        parameters={"sensor_mass.mass": estimate},
        plausible=True,
        p_value=0.4,
    )
    made = complete(diagnosis_with("beam", "named"))
    stated = replace(made, ranking=(row, *made.ranking[1:]), sets=(("sensor_mass",),))
    page = diagnosis_page(stated, [session_of("beam", tmp_path)], when=NOON)
    marked = re.findall(r'<tr class="answer-row">.*?</tr>', page, flags=re.DOTALL)
    assert any("mass 12.1 g (11.5 to 12.6)" in r and "97 %" in r and "lumped mass" in r for r in marked)


def test_errors_of_all_data_are_stated_in_standard_deviations(tmp_path: Path) -> None:
    made = complete(diagnosis_with("beam", "named"))
    shrink = Shrink(
        metric="combined",
        before=2500.0,
        after=120.0,
        held_before=2500.0,
        held_after=150.0,
        held_runner_up=None,
        held_nuisance=900.0,
        floor=100.0,
        closed=None,
        stretch=9.0,
        points=HeldPoints(40.0, 3.0, 20.0),
    )
    text = Reader(
        diagnosis_page(replace(made, shrink=shrink), [session_of("beam", tmp_path)], when=NOON)
    ).text
    assert "25 sigma" in text and "1.5 sigma" in text
    assert "40 % before, 3 % after, 20 % with the tolerances alone" in text


def drawn(kind: str, verdict: str, folder: Path, metric: str = "frequency") -> dict[str, Drawing]:
    made = complete(diagnosis_with(kind, verdict, points=()))
    return drawings(replace(made, shrink=replace(made.shrink, metric=metric)), [session_of(kind, folder)])  # type: ignore[arg-type]


@pytest.mark.long
@pytest.mark.parametrize("kind", ["beam", "plate"])
@pytest.mark.parametrize("metric", ["frequency", "frf", "combined"])
@pytest.mark.parametrize("verdict", ["named", "unknown", "none"])
def test_figures_of_a_report_are_legible(kind: str, metric: str, verdict: str, tmp_path: Path) -> None:
    found = drawn(kind, verdict, tmp_path, metric)
    assert list(found) == ["diagnosis", "gap", "localisation", "shrink"]
    for drawing in found.values():
        assert_legible(drawing.figure)
        assert drawing.caption.endswith(".")


def test_several_specimens_have_a_gap_each(tmp_path: Path) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    sessions = [
        session_of("beam", tmp_path / "a", title="first"),
        session_of("beam", tmp_path / "b", title="second"),
    ]
    own = {
        f"E.factor ({t})": ParameterEstimate(f, "-", 0.8, 1.2, False)
        for t, f in (("first", 0.9), ("second", 1.1))
    }
    row = Ranked(
        effects=("E",), probability=0.99, equivalents=(), parameters=own, plausible=True, p_value=0.4
    )  # type: ignore[arg-type]
    made = complete(replace(diagnosis_with("beam", "named"), ranking=(row,), sets=(row.effects,)), "first")
    modes = pd.concat([made.gap.modes, made.gap.modes.assign(study="second")])
    stated = replace(made, gap=replace(made.gap, modes=modes))
    read = Reader(diagnosis_page(stated, sessions, when=NOON))
    assert "first: modes of the test" in read.text and "second: modes of the test" in read.text
    assert "those of the first study, first" in read.text
    assert {"gap-title", "gap-2-title"} <= set(read.values("id"))
    best = [fitted(stated, session.case, alone=False).model() for session in sessions]
    factors = [state.factors["E"] for model in best if model is not None for state in model[1:]]
    assert factors[0] < 1 < factors[1]


@pytest.mark.long
def test_a_real_test_shows_its_frfs_before_and_after(tmp_path: Path) -> None:
    session = open_study(read_study(ROOT / "sample_data" / "beam_wet" / "study.toml"))
    made = diagnosis_with("beam", "named")
    estimates = {  # as the diagnosis has them
        "fluid_added_mass.fluid_density": ParameterEstimate(1090.0, "kg/m^3", 606.0, 1420.0, False),
        "fluid_added_mass.free_surface": ParameterEstimate(0.102, "m", 0.00628, 0.8, False),
        "fluid_added_mass.bottom": ParameterEstimate(0.0276, "m", 0.00323, 0.864, False),
    }
    row = Ranked(
        effects=("fluid_added_mass",),
        probability=0.99,
        equivalents=(),
        parameters=estimates,
        plausible=True,
        p_value=0.4,
    )
    stated = complete(replace(made, ranking=(row,), sets=(row.effects,)), session.case.title)
    page = diagnosis_page(stated, [session], when=NOON)
    found = re.search(r"median FRAC ([0-9.]+) before, ([0-9.]+) after", page)
    assert found is not None
    # the fit leaves 0.4 % in the frequencies: of resonances with 0.1 to 0.6 % of damping, 1 / (1 + (0.4 / 2 zeta)^2)
    # of the correlation, 0.2 to 0.9
    assert float(found[1]) < 0.1 and float(found[2]) > 0.2
    assert len(page) < 2_000_000
    for drawing in drawings(stated, [session]).values():
        assert_legible(drawing.figure)


def test_long_records_are_drawn_on_fewer_lines() -> None:
    lines = 3 * LINES - 5
    rng = np.random.default_rng(1)
    values = rng.standard_normal((1, lines)) + 1j
    dof = Dof(1, 3)
    long = FrfSet(np.linspace(1, 500, lines), values, (dof,), (dof,), coherence=np.ones((1, lines)))
    short = selected_lines(long)
    assert short.values.shape == (1, LINES - 1)
    assert short.values[0, 7] == values[0, 21]
    assert short.frequency[7] == long.frequency[21]
    assert selected_lines(short) is short


def test_shapes_are_a_picture_on_paper() -> None:
    page = model_of(3).animate().page
    assert re.search(r'<img class="paper" alt="[^"]+" src="data:image/png;base64,iVBOR', page)
    style = page[page.index("@media print") : page.index("</style>")]
    assert ".space, .screen { display: none; }" in style and ".paper { display: block;" in style
