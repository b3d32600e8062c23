"""Paper B's tables through the whole chain, against the printed figures."""

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import modalkit.papers.tables
from modalkit.cli import app
from modalkit.figures import save_figures
from modalkit.papers.b import printed
from modalkit.papers.render import PaperTable, render
from modalkit.papers.tables import Work, work

TEST = np.array([24.3, 67.2, 130.3, 217.1, 323.8, 453.2])


@pytest.fixture(scope="module")
def worked() -> Work:
    return work("B")


@pytest.fixture(scope="module")
def made(worked: Work) -> dict[object, PaperTable]:
    return {table.number: table for table in worked.tables()}


def column(table: PaperTable, name: str) -> np.ndarray:
    return table.table[name].to_numpy(float)


@pytest.mark.long
def test_there_are_tables_2_to_5_and_the_frac(made: dict[object, PaperTable]) -> None:
    assert list(made) == [2, 3, 4, 5, "Figs. 6 and 9"]


def test_measured_values_come_out_of_the_chain(made: dict[object, PaperTable]) -> None:
    assert column(made[3], "test, ours") == pytest.approx(TEST, rel=5e-4)
    assert column(made[5], "damping, test, ours") == pytest.approx(
        column(made[5], "damping, test [%]"), rel=0.01
    )


def test_the_nominal_beam(made: dict[object, PaperTable]) -> None:
    assert column(made[3], "before, ours") == pytest.approx(column(made[3], "before [Hz]"), rel=2e-3)


def test_the_printed_section_gives_the_printed_frequencies(made: dict[object, PaperTable]) -> None:
    ours = column(made[3], "after at the printed A and I, ours")
    assert ours == pytest.approx(column(made[3], "after [Hz]"), rel=2e-3)


def test_damping_before_needs_the_erratum_of_beta_2(made: dict[object, PaperTable]) -> None:
    ours, given = column(made[5], "damping before, ours"), column(made[5], "damping before [%]")
    assert np.abs(ours - given).max() < 0.005
    assert "1e-7" in made[4].table.set_index("parameter").loc["beta_2", "erratum"]


def test_damping_at_the_printed_parameters(made: dict[object, PaperTable]) -> None:
    ours = column(made[5], "damping after at the printed parameters, ours")
    assert np.abs(ours - np.array([1.975, 0.840, 0.509, 0.415, 0.428, 0.529])).max() < 0.005
    assert np.abs(ours - column(made[5], "damping after [%]")).max() < 0.005 + 0.001


def test_our_update_finds_the_section_that_the_paper_printed(made: dict[object, PaperTable]) -> None:
    ours, given = column(made[2], "updated, ours"), column(made[2], "updated")
    sigma = column(made[2], "sigma, ours")
    assert (sigma < 0.08 * given).all()
    assert (np.abs(ours - given) < 2 * sigma).all()
    # and without the calibration error it is the section that was measured
    assert column(made[2], "times 0.74, ours")[:2] == pytest.approx([144.9, 255.5], rel=0.05)


def test_our_update_meets_frequencies_shapes_and_damping(made: dict[object, PaperTable]) -> None:
    test, ours = column(made[3], "test [Hz]"), column(made[3], "after, ours")
    missed, printed_miss = (
        np.sqrt(np.mean((f / test - 1) ** 2)) for f in (ours, column(made[3], "after [Hz]"))
    )
    assert missed < printed_miss < 0.005
    assert column(made[3], "MAC after, ours").min() >= 99.6
    errors = made[5].factors.iloc[0]
    assert errors["mean error after [%]"] == pytest.approx(14.4, abs=0.05)
    assert errors["mean error after, ours"] < 14.4
    assert errors["mean error before [%]"] == pytest.approx(65, abs=0.1)


def test_the_tape_is_on_the_taped_side(made: dict[object, PaperTable]) -> None:
    found = made[4].table.set_index("parameter")["updated, ours"]
    assert found["beta_2"] > 5 * found["beta_1"]


def test_frac_rises_with_the_damping_and_not_before(made: dict[object, PaperTable]) -> None:
    mean = made["Figs. 6 and 9"].factors.iloc[0]
    assert mean["mean FRAC before, undamped"] < 0.35
    assert mean["mean FRAC after stage 1, undamped"] < 0.35
    assert mean["mean FRAC after both"] > 0.9


def test_errata_are_true_of_the_printed_numbers() -> None:
    error = 100 * (np.array(printed.BEFORE) / TEST - 1)
    wrong = np.abs(error - printed.BEFORE_ERROR) > 0.0051
    assert (np.flatnonzero(wrong) + 1).tolist() == sorted(printed.TABLE_3_ERRATA) == [1, 6]
    assert error[[0, 5]] == pytest.approx([3.29, 1.88], abs=0.005)
    for values, given in (
        (printed.DAMPING_BEFORE, printed.DAMPING_BEFORE_ERROR),
        (printed.DAMPING_AFTER, printed.DAMPING_AFTER_ERROR),
    ):
        assert 100 * (np.array(values) / printed.DAMPING - 1) == pytest.approx(given, abs=0.006)


def test_every_format_carries_every_table(made: dict[object, PaperTable]) -> None:
    every = list(made.values())
    text = render(every, "md")
    assert all(table.heading in text for table in every)
    assert "opposite sign" in text
    latex = render(every, "latex")
    assert latex.count("%") == latex.count(r"\%")
    assert latex.count(r"\begin{tabular}") == sum(len(table.blocks) for table in every)
    rows = [line for line in render([made[2]], "csv").splitlines() if line.startswith("B,2,A_1")]
    assert len(rows) == 1


@pytest.mark.long
def test_the_figures_are_drawn(worked: Work, tmp_path: Path) -> None:
    figures = worked.figures()
    assert list(figures) == [f"b_fig_{i}" for i in range(4, 10)]
    panel = figures["b_fig_7"].axes[0]
    measured, before, updated = (np.log(np.asarray(line.get_ydata(), float)) for line in panel.lines)
    assert len(measured) == len(before) == len(updated) > 1000
    assert np.mean((updated - measured) ** 2) < 0.5 * np.mean((before - measured) ** 2)
    for path in save_figures(figures, tmp_path):
        assert path.stat().st_size > 10_000


def test_parameters_end_where_the_table_says(worked: Work, made: dict[object, PaperTable]) -> None:
    staged = worked.staged
    assert staged is not None
    final = made[2].table.set_index("parameter")["updated, ours"]
    assert 1e6 * staged.courses["bare.area"][-1] == pytest.approx(final["A_1"])
    assert 1e6 * staged.courses["bare.area"][0] == pytest.approx(144.9)
    assert sum(staged.result.stages) + 1 == len(staged.result.history)
    rows = len(staged.courses["bare.area"]) + len(staged.courses["bare.alpha"])
    assert rows == len(staged.result.history) + 1


@pytest.mark.long
def test_the_command_writes_tables_and_figures(
    worked: Work, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(modalkit.papers.tables, "work", lambda paper: worked)
    target, folder = tmp_path / "b.tex", tmp_path / "figures"
    arguments = ["tables", "--paper", "B", "--format", "latex", "-o", str(target), "--figures", str(folder)]
    result = CliRunner().invoke(app, arguments)
    assert result.exit_code == 0, result.output
    assert target.read_text(encoding="utf-8").count(r"\begin{table}") == 5
    assert len(list(folder.glob("*.png"))) == 6


def test_the_docs_show_every_figure(worked: Work) -> None:
    page = Path(__file__).resolve().parents[3] / "docs" / "reference" / "papers.md"
    text = page.read_text(encoding="utf-8")
    assert not [name for name in worked.figures() if f"/figures/{name}.png" not in text]
