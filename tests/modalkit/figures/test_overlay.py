"""FRFs of test and model in the figure, the command and its JSON."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conforming import departures

from acquisition import Dof, FrfSet
from modalkit.cli import main
from modalkit.figures import overlay_figure
from modalkit.output.schemas import CorrelationDocument
from modalkit.samples import sample_file
from modalkit.views.charts.frfs import chosen_frfs
from updating.correlation.frfs import CorrelatedFrfs


def pairs(frac: list[float], drive: int = 2) -> CorrelatedFrfs:
    lines = np.arange(1.0, 60.0)
    test = FrfSet(
        lines,
        np.outer(1 + np.arange(len(frac)), 1 / (30.0**2 - lines**2 + 1j * lines)),
        (Dof(drive + 1, 3),) * len(frac),
        tuple(Dof(i + 1, -3) for i in range(len(frac))),
        decay=4.0,
    )
    return CorrelatedFrfs(
        test, replace(test, values=1.5 * test.values), np.array(frac), "the model's own damping"
    )


def test_drive_point_best_and_worst_are_shown() -> None:
    chosen = chosen_frfs(pairs([0.5, 0.9, 0.7, 0.1, 0.6, 0.65]), 4)
    assert chosen[2] == "drive point"
    assert chosen[1] == "best FRAC"
    assert chosen[3] == "worst FRAC"
    assert len(chosen) == 4


def test_one_frf_is_everything_at_once() -> None:
    assert chosen_frfs(pairs([0.5], drive=0), 4) == {0: "drive point, best FRAC, worst FRAC"}


def test_both_curves_are_in_every_panel() -> None:
    both = pairs([0.5, 0.9, 0.7, 0.1, 0.6])
    figure = overlay_figure(both)
    panels = {a.get_label(): a for a in figure.axes}
    assert len(panels) == 8
    curves = {line.get_label(): line for line in panels["3+Z / 2-Z (best FRAC)"].lines}
    assert curves["measured"].get_ydata() == pytest.approx(np.abs(both.measured.values[1]))
    assert curves["unchanged model, FRAC 0.900"].get_ydata() == pytest.approx(
        1.5 * np.abs(both.measured.values[1])
    )
    message = " ".join(t.get_text() for t in figure.texts)
    assert "4 of 5 FRFs" in message
    assert "window of 4 1/s" in message
    assert "the model's own damping" in message


@pytest.mark.long
def test_correlate_writes_record_and_figure(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    target = tmp_path / "out.json"
    study = sample_file("beam_dry/study.toml")
    arguments = ["modalkit", "correlate", str(study), "--json", str(target), "--figures", str(tmp_path)]
    monkeypatch.setattr(sys, "argv", arguments)
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    assert "Model's FRFs: identified damping ratios" in capfd.readouterr().out
    record = json.loads(target.read_text())
    assert not departures(record, CorrelationDocument)
    assert [p["test_hz"] for p in record["pairs"]] == pytest.approx([24.47, 153.96, 429.15], rel=5e-4)
    assert np.shape(record["mac"])[0] == 3
    assert {f["force"] for f in record["frac"]} == {1, 2, 3, 4, 5}
    assert (tmp_path / "overlay.png").stat().st_size > 10_000
