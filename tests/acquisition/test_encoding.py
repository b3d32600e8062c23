"""Text in another encoding, and tables with other separators: what is wrong, and what to type."""

from __future__ import annotations

from pathlib import Path

import pytest

from acquisition import InputError, StudyError, read_layout, read_modes
from modalkit.study.read import read_study

STUDY = '[test]\nmodes = "modes.csv"\ntitle = "Brücke"\n'


@pytest.mark.parametrize(("read", "error"), [(read_study, StudyError), (read_layout, InputError)])
def test_latin_1_is_named_with_its_line_and_what_to_type(tmp_path: Path, read, error) -> None:
    path = tmp_path / "study.toml"
    path.write_bytes(STUDY.encode("latin-1"))
    with pytest.raises(error) as raised:
        read(path)
    message = str(raised.value)
    assert "line 3 holds 'ü' in another encoding, probably Latin-1" in message
    assert "iconv -f WINDOWS-1252 -t UTF-8 study.toml > study_utf8.toml" in message
    assert "binary" not in message


def test_utf_16_is_named(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_bytes(STUDY.encode("utf-16"))
    with pytest.raises(StudyError, match=r"written in UTF-16; .* iconv -f UTF-16LE"):
        read_study(path)


def test_what_is_no_text_is_still_called_binary(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_bytes(b"\x89PNG\r\n\x1a\n\0\0\0\x0d\xff\xfe\xfd")
    with pytest.raises(StudyError, match="binary data"):
        read_study(path)
    with pytest.raises(InputError, match="binary data"):
        read_layout(path)
    table = path.rename(tmp_path / "modes.csv")
    with pytest.raises(InputError, match="binary data"):
        read_modes(table)


def test_a_table_in_latin_1_is_named(tmp_path: Path) -> None:
    path = tmp_path / "modes.csv"
    path.write_bytes("frequency,Größe\n10,0.1\n".encode("latin-1"))
    with pytest.raises(InputError, match="line 1 holds 'ö' in another encoding"):
        read_modes(path)


@pytest.mark.parametrize("mark", [";", "\t"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_a_table_with_other_separators_and_decimal_commas_is_read(
    tmp_path: Path, mark: str, decimal: str
) -> None:
    path = tmp_path / "modes.csv"
    rows = ("frequency", "sigma", "damping", "1+Z"), ("10.5", "0.1", "0.4 %", "1e-2"), ("x", "", "", "0.25")
    path.write_text("\n".join(mark.join(row).replace(".", decimal) for row in rows), encoding="utf-8")
    modes = read_modes(path)
    assert modes.frequency[0] == 10.5 and modes.shapes is not None and modes.shapes[0, 0] == 1e-2
    assert modes.damping is not None and modes.damping[0] == pytest.approx(0.004)
    assert modes.geometry.at([1])[0, 0] == 0.25


def test_a_table_with_points_and_commas_in_its_numbers_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "modes.csv"
    path.write_text("frequency;sigma\n1,234;0.1\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"'0\.1' has a decimal point and '1,234' a decimal comma"):
        read_modes(path)


def test_a_table_without_a_frequency_names_what_it_has(tmp_path: Path) -> None:
    path = tmp_path / "modes.csv"
    path.write_text("hertz\n10\n", encoding="utf-8")
    with pytest.raises(InputError, match="no column 'frequency' among hertz; begin the table with"):
        read_modes(path)
