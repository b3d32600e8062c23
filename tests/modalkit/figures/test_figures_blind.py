"""Figures of a blind run: they show what its score says."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from blind_outcomes import diagnosis, honest_run, run_of, truth
from figure_text import assert_legible, panels, words

from acquisition import InputError
from modalkit.blind import score
from modalkit.blind.scoring.abstention import KNOWN
from modalkit.blind.scoring.calibration import CAME_TRUE, STATED
from modalkit.figures import blind_figures
from modalkit.figures.blind.confidence import curve_of
from modalkit.figures.blind.confusion import confusion_figure, gathered


@pytest.mark.long
@pytest.mark.parametrize(("trials", "leave_out"), [(12, False), (60, False), (60, True), (1000, False)])
def test_blind_run_is_legible(trials: int, leave_out: bool) -> None:
    figures = blind_figures(score(honest_run(trials, 5, leave_out=leave_out)))
    assert {"blind_rates", "blind_confusion", "blind_abstention"} <= figures.keys()
    for figure in figures.values():
        assert_legible(figure)


def test_blind_confusion_shares_classes_and_gathers_pairs() -> None:
    result = score(
        run_of(
            (truth("E"), diagnosis("named", ("E",))),
            (truth("E"), diagnosis("class", ("E",), ("density",), others=[("length",)])),
            (truth("E", "length"), diagnosis("named", ("E", "length"))),
            (truth("E", "shear"), diagnosis("named", ("density", "shear"))),
            (truth("taper"), diagnosis("unknown")),
            (truth(), diagnosis("none")),
        )
    )
    counts = gathered(result.answers)
    assert counts.rows == ["E", "pairs", "taper", "none"]
    assert counts.columns == ["E", "density", "the pair", "other pair", "unknown", "none"]
    assert counts.trials.tolist() == [
        [1.5, 0.5, 0, 0, 0, 0],
        [0, 0, 1, 1, 0, 0],
        [0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, 1],
    ]
    assert [(i, counts.columns[j]) for i, j in np.argwhere(counts.right)] == [
        (0, "E"),
        (1, "the pair"),
        (2, "unknown"),
        (3, "none"),
    ]
    figure = blind_figures(result)["blind_confusion"]
    assert "4 of 6 blind trials answered correctly" in words(figure)


@pytest.mark.long
def test_blind_curves_show_what_they_are_given() -> None:
    result = score(honest_run(300, 8))
    figures = blind_figures(result)
    known = curve_of(result, KNOWN)
    assert f"{known.right.count} of {known.right.total} right" in words(figures["blind_abstention"])
    curve = panels(figures["blind_abstention"])["abstention"].get_lines()[0]
    np.testing.assert_allclose(curve.get_ydata(), 100 * known.points["right"])
    dots = panels(figures["blind_reliability"])["Reliability"].collections[-1].get_offsets()
    across, up = ([100 * row.rate for row in result.rates.of(q)] for q in (STATED, CAME_TRUE))
    np.testing.assert_allclose(dots, np.column_stack([across, up]))
    covered = result.severity["covered"].astype(bool)
    assert f"{covered.sum()} of {len(covered)} parameters" in words(figures["blind_severity"])


def test_blind_figures_leave_out_what_the_run_has_nothing_for() -> None:
    figures = blind_figures(score(run_of((truth("taper"), None))))
    assert set(figures) == {"blind_rates", "blind_confusion"}
    for figure in figures.values():
        assert_legible(figure)
    with pytest.raises(InputError, match="no trials"):
        confusion_figure(pd.DataFrame())
