"""Damaged column text is refused with its line."""

from __future__ import annotations

import pytest

from acquisition import InputError
from acquisition.columns import layout_from, read_columns, read_layout

LAYOUT = layout_from(
    {
        "rate": 1000.0,
        "column": [
            {"name": "hammer", "quantity": "force"},
            {"name": "acc 1", "quantity": "acceleration", "node": 1},
            {"name": "acc 2", "quantity": "acceleration", "unit": "g", "node": 2},
        ],
    }
)

FIRST_ROWS = [
    "1.0,2.0 1,3.0",
    "1.0,2.0",
    "1.0,2.0,3.0e",
    "t,f,a1.0,2.0,3.0",
    "1.0e+00\xac2.0,3.0",
    "1.0l2.0,3.0",
]


@pytest.mark.parametrize("line", FIRST_ROWS)
def test_a_damaged_first_row_is_no_heading(tmp_path, line):
    (tmp_path / "a.csv").write_text(f"hammer,acc 1,acc 2\n{line}\n" + "1.0,2.0,3.0\n" * 5)
    with pytest.raises(InputError, match=r"line 2: .*skip in the layout"):
        read_columns(tmp_path / "a.csv", LAYOUT)


def test_a_quote_inside_a_number_is_a_fault(tmp_path):
    rows = '1.0,"2.0",3.0\n' * 4
    (tmp_path / "a.csv").write_text("hammer,acc 1,acc 2\n" + rows)
    assert read_columns(tmp_path / "a.csv", LAYOUT).points[0].force.shape == (1, 4)
    (tmp_path / "a.csv").write_text("hammer,acc 1,acc 2\n" + rows + '1.0,2"0,3.0\n')
    with pytest.raises(InputError, match="line 6, column 1"):
        read_columns(tmp_path / "a.csv", LAYOUT)
    (tmp_path / "a.csv").write_text("hammer,acc 1,acc 2\n" + rows + '1.0,"2.0,3.0\n')
    with pytest.raises(InputError, match="line 6, column 1"):
        read_columns(tmp_path / "a.csv", LAYOUT)


BEHIND_HEADINGS = ["1.0,{,a,{", "{,a,2.5e-01", "{,{,12"]


@pytest.mark.parametrize("line", BEHIND_HEADINGS)
def test_a_broken_row_behind_the_headings_asked_for_is_no_line_of_words(tmp_path, line):
    (tmp_path / "a.csv").write_text(f"hammer,acc 1,acc 2\n{line}\n" + "1.0,2.0,3.0\n" * 5)
    with pytest.raises(InputError, match=r"line 2: .* contains a number but is not a row of numbers"):
        read_columns(tmp_path / "a.csv", LAYOUT)


@pytest.mark.parametrize("line", ["N,m/s^2,1", "(N),(1),(1)", "recorded in 2024"])
def test_units_and_remarks_behind_the_headings_are_words(tmp_path, line):
    (tmp_path / "a.csv").write_text(f"hammer,acc 1,acc 2\n{line}\n" + "1.0,2.0,3.0\n" * 5)
    assert read_columns(tmp_path / "a.csv", LAYOUT).points[0].force.shape == (1, 5)


def test_numbers_beyond_any_in_si_units_are_refused(tmp_path):
    (tmp_path / "a.csv").write_text("hammer,acc 1,acc 2\n" + "1.0,2.0,1e308\n" * 5)
    with pytest.raises(InputError, match="column 'acc 2' holds numbers that are too large in any unit"):
        read_columns(tmp_path / "a.csv", LAYOUT)


@pytest.mark.usefixtures("no_hang")
def test_a_heading_of_very_many_digits_is_judged_at_once(tmp_path):
    line = "1" * 100_000 + "x" + "1" * 100_000 + "y,1.0"
    (tmp_path / "a.csv").write_text(f"{line}\nhammer,acc 1,acc 2\n" + "1.0,2.0,3.0\n" * 5)
    assert read_columns(tmp_path / "a.csv", LAYOUT).points[0].force.shape == (1, 5)


@pytest.mark.parametrize("line", ["1.0", "1.0,2.0"])
def test_a_cut_row_behind_a_blank_one_is_a_fault(tmp_path, line):
    (tmp_path / "a.csv").write_text("hammer,acc 1,acc 2\n" + "1.0,2.0,3.0\n" * 5 + f"\n{line}")
    with pytest.raises(InputError, match=r"line 8: .*after the last line of numbers"):
        read_columns(tmp_path / "a.csv", LAYOUT)
    (tmp_path / "a.csv").write_text("hammer,acc 1,acc 2\n" + "1.0,2.0,3.0\n" * 5 + "\nend of data\n")
    assert read_columns(tmp_path / "a.csv", LAYOUT).points[0].force.shape == (1, 5)


@pytest.mark.parametrize("content", [b"hammer,acc 1,acc 2\n1,2,3\n\x041,2,3\n", b"1,2,3\n" * 2000 + b"\0"])
def test_control_characters_are_no_text(tmp_path, content):
    (tmp_path / "a.csv").write_bytes(content)
    with pytest.raises(InputError, match="damaged or binary"):
        read_columns(tmp_path / "a.csv", LAYOUT)


def test_damage_where_a_row_has_two_columns(tmp_path):
    columns = [{"index": 0, "quantity": "force"}, {"index": 1, "quantity": "velocity"}]
    layout = layout_from({"rate": 10.0, "column": columns})
    (tmp_path / "a.csv").write_text("Samples,4\n" + "1.0,2.0\n" * 4)
    assert read_columns(tmp_path / "a.csv", layout).points[0].force.shape == (1, 4)
    for row in ("1.0,2.0P+00", "5.5e-010.00x0e+00", "*INCLUDE9469e-01,2.0"):
        (tmp_path / "a.csv").write_text(f"f,a\n{row}\n" + "1.0,2.0\n" * 4)
        with pytest.raises(InputError, match="is almost a line of numbers"):
            read_columns(tmp_path / "a.csv", layout)


DEEP = ["x = " + "[" * 20_000, "x = " + "{a=" * 20_000, "x = " + "9" * 6000]


@pytest.mark.parametrize("text", DEEP)
def test_toml_deeper_than_a_stack_or_longer_than_a_number(tmp_path, text):
    (tmp_path / "layout.toml").write_text(text)
    with pytest.raises(InputError, match="not a TOML file"):
        read_layout(tmp_path / "layout.toml")
