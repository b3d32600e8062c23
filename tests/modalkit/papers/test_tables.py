"""Paper A's tables through the whole chain, against the printed figures."""

import csv
import io
import json

import numpy as np
import pytest
from conforming import departures

from acquisition import InputError
from modalkit.output.schemas import UpdateDocument
from modalkit.output.update import to_json
from modalkit.papers.a.chain import Walk, open_test, sample_folder, walk, walk_all
from modalkit.papers.a.figures import figures_a
from modalkit.papers.a.printed import TABLES
from modalkit.papers.a.tables import tables_a
from modalkit.papers.render import PaperTable, render
from modalkit.papers.tables import tables


@pytest.fixture(scope="module")
def walks() -> tuple[Walk, ...]:
    return walk_all(sample_folder())


@pytest.fixture(scope="module")
def made(walks: tuple[Walk, ...]) -> list[PaperTable]:
    return tables_a(walks)


def both(table: PaperTable, name: str, *, model: str | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return printed and own values of a column, where both are."""
    rows = table.table if model is None else table.table[table.table["model"] == model]
    head = name.split(" [", maxsplit=1)[0]
    printed, ours = rows[name].to_numpy(float), rows[f"{head}, ours"].to_numpy(float)
    keep = np.isfinite(printed) & np.isfinite(ours)
    assert keep.any()
    return printed[keep], ours[keep]


@pytest.mark.long
def test_there_are_four_tables(made: list[PaperTable]) -> None:
    assert [t.number for t in made] == [1, 2, 3, 4]


def test_measured_frequencies_come_out_of_the_chain(made: list[PaperTable]) -> None:
    for table in made:
        printed, ours = both(table, "test [Hz]")
        assert ours == pytest.approx(printed, rel=5e-4)


@pytest.mark.parametrize("number", [1, 2])
def test_nominal_beams(made: list[PaperTable], number: int) -> None:
    printed, ours = both(made[number - 1], "before [Hz]")
    assert (np.abs(ours / printed - 1) < 2e-4 + 0.005 / printed).all()  # 0.02 % and half the last digit


@pytest.mark.parametrize("number", [3, 4])
def test_nominal_plate(made: list[PaperTable], number: int) -> None:
    table = made[number - 1]
    untouched = table.table[~table.table["erratum"].str.contains("paired by MAC")]
    kept = PaperTable(table.paper, table.number, table.title, untouched, table.factors, table.notes)
    printed, ours = both(kept, "before [Hz]")
    assert ours == pytest.approx(printed, rel=2e-3)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_updated_frequencies(made: list[PaperTable], number: int) -> None:
    printed, ours = both(made[number - 1], "after [Hz]")
    assert ours == pytest.approx(printed, rel=3e-3)


@pytest.mark.parametrize(
    ("number", "model", "factor"),
    [(1, "ANSYS", 0.7498), (1, "MATLAB", 0.757), (3, "ANSYS", 0.782), (4, "ANSYS", 4.77)],
)
def test_factors(made: list[PaperTable], number: int, model: str, factor: float) -> None:
    rows = made[number - 1].factors.set_index("model")
    assert rows.loc[model, "factor, ours"] == pytest.approx(factor, abs=2e-3 if factor < 1 else 0.01)


def test_the_printed_column_of_table_4_belongs_to_another_factor(made: list[PaperTable]) -> None:
    rows = made[3].table.dropna(subset=["after [Hz]"])
    assert rows["after at 4.304, ours"].to_numpy() == pytest.approx(rows["after [Hz]"].to_numpy(), rel=2e-3)
    assert len(rows) == 7


def test_omitted_modes_are_explained(made: list[PaperTable]) -> None:
    text = " ".join(made[2].notes)
    assert "FE mode 8" in text
    assert "FE mode 12" in text
    assert 8 in made[2].table["mode"].tolist()
    assert 12 not in made[2].table["mode"].tolist()


@pytest.mark.parametrize(
    ("number", "model", "low", "high"),
    [
        (1, "ANSYS", 0.7490, 0.7500),
        (2, "MATLAB", 2.148, 2.163),
        (3, "ANSYS", 0.7815, 0.7825),
        (4, "ANSYS", 4.303, 4.305),
    ],
)
def test_the_factor_of_a_printed_column_is_worked_out_from_it(
    made: list[PaperTable], number: int, model: str, low: float, high: float
) -> None:
    rows = made[number - 1].factors.set_index("model")
    assert low < rows.loc[model, "factor of the printed column"] < high


def test_the_wet_table_says_what_a_synthetic_mac_is_worth(made: list[PaperTable]) -> None:
    assert any("54-78 %" in note and "synthetic" in note for note in made[3].notes)


def test_errata_are_true_of_the_printed_numbers() -> None:
    table = {t.number: t for t in TABLES}
    ansys = table[2].models[0]
    test = np.array(table[2].test)
    before = np.array(ansys.before, dtype=float)
    assert 100 * (before / test - 1) == pytest.approx([47.63, 48.01, 46.90], abs=0.006)
    assert ansys.before_error == table[1].models[0].before_error
    after = np.array(ansys.after, dtype=float)
    assert 100 * (after / test - 1)[2] == pytest.approx(-0.18, abs=0.006)
    first = table[1].models[0]
    assert 100 * (float(first.after[0] or 0) / 24.47 - 1) == pytest.approx(0.12, abs=0.004)
    plate = table[4].models[0]
    assert float(plate.before[0] or 0) / np.sqrt(4.40) == pytest.approx(9.18, abs=0.006)
    ratio = np.array(table[4].test[:7]) / np.array(plate.before[:7], dtype=float)
    assert ratio.mean() ** -2 == pytest.approx(4.40, abs=0.005)


def test_markdown_has_our_value_beside_the_printed_one(made: list[PaperTable]) -> None:
    lines = render(made, "md").splitlines()
    head = next(line for line in lines if line.startswith("| model"))
    row = next(line for line in lines if line.startswith("| ANSYS | 1 |"))
    assert head.count("|") == row.count("|")
    assert "| 24.50 | 24.50 |" in row
    assert "47.63 is meant" in render(made, "md")


def test_csv_can_be_read_back(made: list[PaperTable]) -> None:
    blocks = [b for b in render([made[0]], "csv").split("\n\n") if b.strip()]
    rows = list(csv.DictReader(io.StringIO(blocks[0])))
    assert float(rows[0]["before [Hz]"]) == 28.30
    assert {len(r) for r in rows} == {len(made[0].table.columns) + 2}


def test_latex_is_balanced_and_escaped(made: list[PaperTable]) -> None:
    text = render(made, "latex")
    for name in ("table", "tabular"):
        assert text.count(f"\\begin{{{name}}}") == text.count(f"\\end{{{name}}}") > 0
    assert text.count("%") == text.count(r"\%")
    rows = [line for line in text.splitlines() if line.startswith("ANSYS & 1 &")]
    assert rows


def test_what_does_not_exist_is_refused(made: list[PaperTable]) -> None:
    with pytest.raises(InputError, match="paper 'C'"):
        tables("C")
    with pytest.raises(InputError, match="format 'html'"):
        render(made, "html")  # type: ignore[arg-type]


@pytest.mark.long
def test_the_update_becomes_a_record_of_the_contract() -> None:
    table = TABLES[0]
    walked = walk(table, table.models[1], open_test(table, sample_folder()))
    record = json.loads(json.dumps(to_json(walked.result), allow_nan=False))
    assert not departures(record, UpdateDocument)
    needed = {"name", "study", "value", "unit", "factor", "sigma", "at_bound"}
    assert needed <= set(record["parameters"][0])
    pair = {"study", "test_mode", "model_mode", "mac", "test_hz", "before_hz", "after_hz"}
    assert pair <= set(record["pairs"][0])
    assert record["parameters"][0]["value"] == pytest.approx(210e9 * record["parameters"][0]["factor"])
    assert record["correlations"] == [[1.0]]
    assert record["converged"] is True
    assert record["undetermined"] == []


@pytest.mark.long
def test_the_figures_lay_the_updated_model_over_the_test(walks: tuple[Walk, ...]) -> None:
    figures = figures_a(walks)
    assert list(figures) == ["a_fig_3", "a_fig_4", "a_fig_5", "a_fig_6"]
    for name in ("a_fig_3", "a_fig_5"):
        panel = figures[name].axes[0]
        measured, before, updated = (np.log(np.asarray(line.get_ydata(), float)) for line in panel.lines)
        assert np.mean((updated - measured) ** 2) < 0.25 * np.mean((before - measured) ** 2)
        # with the identified damping the highest peak is as high as measured, as the test's own modes allow
        assert updated.max() == pytest.approx(measured.max(), abs=np.log(1.6))
