"""Text as programs write it: notes, unused channels, several time axes, and words behind the numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acquisition import InputError
from acquisition.columns import layout_from, read_columns, read_frf_columns

HAMMER = {"name": "Hammer", "quantity": "force"}
ACCELERATION = {"name": "Acc", "quantity": "acceleration"}
LAYOUT = layout_from({"column": [HAMMER, ACCELERATION]})
FORCE, MOTION = np.array([0.0, 2.5, 1.0, -0.5]), np.array([0.25, -1.0, 3.0, 0.5])
HEAD = (
    "LabVIEW Measurement\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\t{}\n"
    "***End_of_Header***\t\n"
)


def rows(*columns: np.ndarray | list[str]) -> str:
    return "".join("\t".join(map(str, row)) + "\n" for row in zip(*columns, strict=True))


def segment(*, notes: str = "", extra: int = 0, blank: str = "\n", harder: float = 1.0) -> str:
    """Return a segment with hammer and accelerometer, and channels that were not recorded."""
    none = "\t0" * extra
    header = (
        f"Channels\t{2 + extra}\t\t\nSamples\t4\t4{none}\t\nY_Unit_Label\tN\tm/s^2{extra * chr(9)}\n"
        f"X_Dimension\tTime\tTime\nDelta_X\t0.001\t0.001{none.replace('0', '1.0')}\t\n***End_of_Header***\t\t\n"
    )
    names = "X_Value\tHammer\tAcc" + "".join(f"\tUntitled {k}" for k in range(extra)) + "\tComment\n"
    time = [f"{0.001 * k:.3f}" for k in range(4)]
    return notes + header + names + rows(time, harder * FORCE, MOTION, *[[""] * 4] * extra) + blank


def multi() -> str:
    """Return a segment in which every channel has its own time, an unused slow one among them."""
    header = (
        "Channels\t3\t\t\t\t\t\nSamples\t4\t\t4\t\t2\t\nY_Unit_Label\tN\t\tm/s^2\t\tdegC\t\n"
        "X_Dimension\tTime\t\tTime\t\tTime\t\nDelta_X\t0.001\t\t0.001\t\t0.5\t\n***End_of_Header***\t\t\t\t\t\t\n"
        "X_Value\tHammer\tX_Value\tAcc\tX_Value\tTemperature\tComment\n"
    )
    time = [f"{0.001 * k:.3f}" for k in range(4)]
    return header + rows(time, FORCE, time, MOTION, ["0.0", "0.5", "", ""], ["20.5", "20.7", "", ""]) + "\n"


LVM = {
    "plain": HEAD.format("One") + "\n" + segment(),
    "notes": HEAD.format("One") + "\t\n" + segment(notes="Notes\tX values guaranteed valid only for Dev1/ai0\n"),
    "notes of several lines": HEAD.format("One") + "\n" + segment(notes="Notes\t3 hits\nat point 1\nTest_Name\tbeam\n"),
    "unused channels": HEAD.format("One") + "\n" + segment(extra=2),
    "blank row of separators": HEAD.format("One") + "\n" + segment(blank="\t\t\t\n"),
    "several time axes": HEAD.format("Multi") + "\n" + multi(),
}  # fmt: skip


@pytest.mark.parametrize("name", list(LVM))
def test_labview_files_as_they_are_written(tmp_path: Path, name: str) -> None:
    (tmp_path / "a.lvm").write_text(LVM[name])
    test = read_columns(tmp_path / "a.lvm", LAYOUT)
    assert test.rate == pytest.approx(1000.0)
    np.testing.assert_array_equal(test.points[0].force, [FORCE])
    np.testing.assert_array_equal(test.points[0].motion[:, 0], [MOTION])


def test_a_second_segment_may_have_notes(tmp_path: Path) -> None:
    (tmp_path / "a.lvm").write_text(
        HEAD.format("One") + "\n" + segment() + segment(notes="Notes\tharder\n", blank="", harder=2.0)
    )
    assert read_columns(tmp_path / "a.lvm", LAYOUT).points[0].count == 2


@pytest.mark.parametrize(
    ("text", "name", "message"),
    [
        (LVM["unused channels"], "Untitled 1", r"column 'Untitled 1' has no samples.*leave it out of the layout"),
        (LVM["several time axes"], "Temperature", r"'Temperature' has 2 samples and column 'Hammer' 4"),
        (LVM["notes"].replace("Notes\t", "Noted\t"), "Acc", "'Noted.*before the first segment"),
    ],
)  # fmt: skip
def test_channels_that_cannot_be_used_are_named(tmp_path: Path, text: str, name: str, message: str) -> None:
    (tmp_path / "a.lvm").write_text(text)
    unit = {} if name != "Temperature" else {"unit": "m/s2"}
    layout = layout_from({"column": [HAMMER, {"name": name, "quantity": "acceleration", **unit}]})
    with pytest.raises(InputError, match=message):
        read_columns(tmp_path / "a.lvm", layout)


TRAILERS = [
    "End of data\n",
    "TagsBegin:\t \t \t \nOverLoad:\t \tFalse\t \nAverageNumber: []\t \t 3.00000e+000\t \nTagsEnd:\t \t \t \n",
    "# end\n\nTagScalesBegin:\n",
    "\x1a",
]
FRF = layout_from(
    {
        "frequency_column": 1,
        "skip": 2,
        "column": [
            {"index": 2, "quantity": "accelerance", "part": "real"},
            {"index": 3, "quantity": "accelerance", "part": "imag"},
        ],
    }
)
TABLE = "Header Size:\t 2\t \t \nX-Axis size:\t4\t \t \n" + "".join(
    f"{k + 1}\t {0.25 * k:.10e}\t {1.5 * k:.5e}\t {-0.5 * k:.5e}\n" for k in range(4)
)


@pytest.mark.parametrize("trailer", TRAILERS)
def test_words_behind_the_numbers_are_no_rows(tmp_path: Path, trailer: str) -> None:
    (tmp_path / "whole.txt").write_text(TABLE)
    (tmp_path / "foot.txt").write_text(TABLE + trailer)
    whole, foot = (read_frf_columns(tmp_path / name, FRF) for name in ("whole.txt", "foot.txt"))
    np.testing.assert_array_equal(foot.frequency, [0.0, 0.25, 0.5, 0.75])
    np.testing.assert_array_equal(foot.values, whole.values)


@pytest.mark.parametrize(
    "line", ["5\toops\t2.0\t3.0\n", "5\t1.0\tEnd of data\t1.0\n", "5\t1.0\n", "n5\t1.0\n"]
)
def test_a_damaged_last_row_is_no_trailer(tmp_path: Path, line: str) -> None:
    (tmp_path / "a.txt").write_text(TABLE + line)
    with pytest.raises(InputError, match=r"line 7.*: .* (columns|is not a number)"):
        read_frf_columns(tmp_path / "a.txt", FRF)


def test_numbers_behind_a_trailer_are_a_fault(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text(TABLE + "End of data\n" + TABLE.splitlines()[-1] + "\n")
    with pytest.raises(InputError, match="line 7"):
        read_frf_columns(tmp_path / "a.txt", FRF)
