"""The damping over frequency is one chart: its numbers are the test's and the formula's, on paper and in both pages."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from figure_cases import model_of
from figure_text import assert_legible, words
from opening import opened

from acquisition import InputError, ModalData
from modalkit.figures import damping_figure, draw
from modalkit.report.tested import expected_of, session_sections
from modalkit.samples import sample_file
from modalkit.views.chart import Chart
from modalkit.views.charts.damping import ExpectedDamping, damping_chart
from modalkit.workflow.case import Session, open_study

ALPHA, BETA = 3.0, 1e-7


@pytest.fixture(scope="module")
def published() -> Session:
    """Frequencies and damping of a beam, whose study states alpha and beta."""
    return open_study(sample_file("tape_taped/published.toml"), with_baseline=False)


def test_every_mode_has_its_ratio_with_two_standard_deviations() -> None:
    modal = model_of(12).modal
    assert modal.damping is not None and modal.damping_sigma is not None
    chart = damping_chart(modal)
    assert chart is not None
    (identified,) = chart.series
    assert identified.x == pytest.approx(modal.frequency)
    assert identified.y == pytest.approx(100 * modal.damping)
    assert identified.more["error"] == pytest.approx(200 * modal.damping_sigma)
    assert "expects" not in chart.title
    assert_legible(damping_figure(modal))


def test_a_model_expects_what_alpha_and_beta_come_to(published: Session) -> None:
    found = expected_of(published)
    assert found is not None
    omega = 2 * np.pi * found.frequency
    assert found.ratio == pytest.approx(0.5 * (ALPHA / omega + BETA * omega), rel=1e-3)
    assert found.measured == pytest.approx(published.case.measured.frequency)


def test_one_record_is_drawn_by_report_app_and_figures(published: Session) -> None:
    path = sample_file("tape_taped/published.toml")
    in_report = next(
        part
        for section in session_sections(published)
        for part in section.shown
        if isinstance(part, Chart) and part.name == "damping"
    )
    in_app = opened(Path(path)).damping()
    assert in_app == in_report.data()
    assert [one["name"] for one in in_app["series"]] == ["expected by the model", "identified"]
    modal = ModalData(
        published.case.measured.frequency, np.full(6, 0.1), published.case.measured.damping, np.full(6, 1e-4)
    )
    assert "the model expects" in words(damping_figure(modal, expected_of(published)))


def test_a_study_without_damping_has_no_second_series() -> None:
    session = open_study(sample_file("tape_taped/published.toml"), with_baseline=False)
    assert session.study.model is not None
    silent = replace(session.case, spec=replace(session.case.spec, damping=type(session.case.spec.damping)()))
    assert expected_of(replace(session, case=silent)) is None


def test_what_is_not_known_is_not_drawn() -> None:
    bare = ModalData(np.array([10.0]), np.array([0.1]))
    assert damping_chart(bare) is None
    with pytest.raises(InputError, match="no damping ratios"):
        damping_figure(bare)
    some = ModalData(
        np.array([10.0, 20.0]), np.full(2, 0.1), np.array([0.01, np.nan]), np.array([np.nan, np.nan])
    )
    chart = damping_chart(some, ExpectedDamping(np.array([11.0]), np.array([0.02]), np.array([10.0])))
    assert chart is not None
    assert "standard deviations are unknown" in chart.text
    assert chart.title == "Damping of 1 mode: 1 %; the model expects 2 %"
    assert chart.data()["series"][1]["error"] == [None]
    assert "mode 1: 10.00 Hz" in chart.series[1].more["text"][0]


def test_identified_modes_draw_it_too() -> None:
    assert "damping" in draw(model_of(12).modal)
