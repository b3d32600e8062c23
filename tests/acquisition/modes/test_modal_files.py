"""Tables of modes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acquisition import Dof, InputError, ModalData, read_modes, write_uff


def test_full_table(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text(
        "# a plate\nfrequency, sigma, damping, damping_sigma, 1+Z, 3-Z\n10.5,0.01,0.002,0.0001,1.0,0.5\n20,,,,2,-1\n"
    )
    modal = read_modes(path)
    assert modal.frequency.tolist() == [10.5, 20.0]
    assert modal.frequency_sigma[0] == 0.01 and np.isnan(modal.frequency_sigma[1])
    assert modal.damping[0] == 0.002 and np.isnan(modal.damping[1])
    assert modal.dofs == (Dof(1, 3), Dof(3, 3)) and modal.shapes.tolist() == [[1, 2], [-0.5, 1]]


def test_frequency_alone(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text("sigma,frequency\n0.1,33\n")
    modal = read_modes(path)
    assert len(modal) == 1 and modal.shapes is None and modal.frequency_sigma.tolist() == [0.1]


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("", "table"),
        ("frequency,sigma\n", "no mode"),
        ("10.5,0.01\n20,0.01\n", "no column 'frequency'"),
        ("frequency,sigma\n10.5,abc\n", "'abc'"),
        ("frequency,sigma\n-3,0.1\n", "not positive"),
        ("frequency,sigma\n,0.1\n", "missing"),
        ("frequency,1+Z\n10,\n", "gaps"),
        ("frequency\n10\n11,12,13\n", "table"),
    ],
)
def test_the_error_names_what_is_wrong(tmp_path, text, word):
    path = tmp_path / "modes.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=word):
        read_modes(path)


def test_missing_table_and_universal_file_without_modes(tmp_path, shared_data):
    with pytest.raises(InputError, match="cannot be opened"):
        read_modes(tmp_path / "none.csv")
    with pytest.raises(InputError, match="no modes"):
        read_modes(shared_data("uff/UFFFiles.jl/dataset15.unv"))


def test_universal_file_with_modes(shared_data):
    assert len(read_modes(shared_data("uff/pyuff/uff55_translation.uff"))) == 3


def test_standard_deviations_of_shapes(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text("frequency,1+Z,3-Z,3-Z sigma,1+Z sigma\n10,1,2,0.2,0.1\n20,3,4,0.4,0.3\n")
    modal = read_modes(path)
    assert modal.shape_sigma.tolist() == [[0.1, 0.3], [0.2, 0.4]]
    path.write_text("frequency,1+Z,3-Z,3-Z sigma\n10,1,2,0.2\n")
    with pytest.raises(InputError, match=r"'1\+Z sigma' is missing or belongs to no shape"):
        read_modes(path)


def test_one_mode_twice_in_a_table(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text("frequency,damping,1+Z\n10,0.01,1\n20,0.01,2\n10,0.01,1\n")
    with pytest.raises(InputError, match="modes 1 and 3 are the same"):
        read_modes(path)
    path.write_text("frequency,damping,1+Z\n10,0.01,1\n10,0.01,2\n")
    assert len(read_modes(path)) == 2


def test_broken_mode_of_a_universal_file_is_not_left_out_silently(tmp_path, rng):
    shapes = rng.standard_normal((1, 2)) + 0j
    nothing = np.full(2, np.nan)
    write_uff(
        tmp_path / "a.uff",
        modal=ModalData(
            frequency=np.array([5.0, 7.0]), frequency_sigma=nothing, dofs=(Dof(1, 3),), shapes=shapes
        ),
    )
    data = (tmp_path / "a.uff").read_bytes()
    (tmp_path / "b.uff").write_bytes(data[: len(data) - 60])
    with pytest.raises(InputError, match="a mode may be lost"):
        read_modes(tmp_path / "b.uff")


@pytest.mark.parametrize(
    ("heading", "cell"),
    [
        ("damping", "0.006"),
        ("Damping [-]", "0.006"),
        ("damping_percent", "0.6"),
        ("damping [%]", "0.6"),
        ("Damping (%)", "0.6"),
        ("zeta[%]", "0.6"),
        ("damping", "0.6 %"),
        ("damping [%]", "0.6%"),
    ],
)
def test_damping_in_percent_is_understood_where_it_is_stated(tmp_path, heading, cell):
    path = tmp_path / "modes.csv"
    path.write_text(f"frequency,{heading},damping_sigma [%]\n10,{cell},0.01\n20,,\n")
    modal = read_modes(path)
    assert modal.damping[0] == pytest.approx(0.006, rel=1e-12) and np.isnan(modal.damping[1])
    assert modal.damping_sigma[0] == pytest.approx(1e-4, rel=1e-12)
    assert not modal.doubts()


def test_our_own_table_is_read_back(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text("frequency,sigma,damping,damping_sigma\n10.5,0.01,0.002,0.0001\n20,0.02,0.004,0.0002\n")
    modal = read_modes(path)
    modal.table().to_csv(tmp_path / "again.csv")
    again = read_modes(tmp_path / "again.csv")
    for name in ("frequency", "frequency_sigma", "damping", "damping_sigma"):
        np.testing.assert_allclose(getattr(again, name), getattr(modal, name), rtol=1e-12)


def test_ratios_that_nothing_has_are_doubted(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text("frequency,damping\n10,0.6\n20,0.1\n")
    (doubt,) = read_modes(path).doubts()
    assert "60 %" in doubt and "damping_percent" in doubt


def test_a_table_brings_its_points(tmp_path):
    path = tmp_path / "modes.csv"
    path.write_text("frequency,1+Z,3-Z,3+X\nx,0.1,0.3,0.3\nZ,0,0.01,0.01\n10,1,0.5,0\n20,2,-1,1\n")
    modal = read_modes(path)
    assert len(modal) == 2 and modal.geometry.nodes == (1, 3)
    assert modal.geometry.coordinates.tolist() == [[0.1, 0, 0], [0.3, 0, 0.01]]
    assert modal.shapes.real.tolist() == [[1, 2], [-0.5, 1], [0, 1]]


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("frequency,1+Z\nx,0.1\nx,0.2\n10,1\n", "two rows of x"),
        ("frequency,1+Z\nx,\n10,1\n", "lacks a coordinate"),
        ("frequency,1+Z,1+X\nx,0.1,0.2\n10,1,1\n", "node 1 has two places"),
        ("frequency,1+Z\nx,0.1\n", "holds no mode"),
        ("frequency,sigma,1+Z\nx,0.1,0.1\n10,0.1,1\n", "row x of coordinates has an entry in column 'sigma'"),
        ("frequency,damping\n10,6\n", "damping_percent"),
        ("frequency,damping\n10,-0.01\n", "between 0 and 1"),
        ("frequency,damping,damping_percent\n10,0.01,1\n", "both give the damping"),
        ("frequency,dampin\n10,0.01\n", "is 'damping' meant"),
        ("frequency,damping_pct\n10,0.6\n", "is 'damping_percent' meant"),
        ("frequency,sigma\n10,5 %\n", "not a number"),
        ("frequency,sigma\n10,-1\n", "negative"),
        ("frequency\n1e300\n", "beyond"),
        ("frequency,1+Z,2+Z\n10,1e300,1\n", "scale it"),
        ("frequency,sigma\n10,1e300\n", "larger than the frequency"),
    ],
)
def test_what_is_wrong_with_points_and_ratios_is_said(tmp_path, text, word):
    path = tmp_path / "modes.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=word):
        read_modes(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("frequency,sigmo\n10.5,0.1\n", "column 'sigmo' is unknown; is 'sigma' meant"),
        ("frequency,sigma,x+Z\n10.5,0.1,1\n", "column 'x\\+Z' is unknown"),
        ("frequency\n10.5,0.1\n", "more values than the header has names"),
        ("frequency,sigma\n10.5,0.1\n11,0.1,7\n", "not a table of columns separated by commas"),
        ("frequency,sigma\ninf,0.1\n", "'inf' in column 'frequency' is not a number"),
        ("frequency,sigma\n1e999,0.1\n", "is too large"),
        ("frequency,sigma\n1_0,0.1\n", "is not a number"),
        (
            "frequency,sigma\n19.06 Hz,0.1\n",
            "'19.06 Hz' in column 'frequency' is not a number but has a unit, Hz; write 19.06 alone",
        ),
    ],
)
def test_a_damaged_table_of_modes_is_refused_in_one_line(tmp_path, text, message):
    (tmp_path / "modes.csv").write_text(text)
    with pytest.raises(InputError, match=message) as error:
        read_modes(tmp_path / "modes.csv")
    assert "\n" not in str(error.value)


def test_an_unknown_column_is_named_and_can_be_passed_over(tmp_path: Path) -> None:
    """A misspelt heading must not lose its column in silence; one that is meant to be none is said so."""
    path = tmp_path / "modes.csv"
    path.write_text("frequency,sigma,temperature\n10.5,0.1,21.5\n")
    with pytest.raises(InputError) as refused:
        read_modes(path)
    message = str(refused.value)
    assert "'temperature'" in message and "damping_sigma" in message and "scaled" in message
    assert "write 'note temperature' or delete it" in message
    path.write_text("frequency,sigma,note temperature,Note humidity [%]\n10.5,0.1,21.5,60\n")
    assert read_modes(path).frequency.tolist() == [10.5]


def test_a_comma_that_ends_every_line_makes_no_column(tmp_path: Path) -> None:
    """Spreadsheets write it; a column that holds something has to say what."""
    path = tmp_path / "modes.csv"
    path.write_text("frequency,sigma,\n10.5,0.1,\n20,0.1,\n")
    assert read_modes(path).frequency.tolist() == [10.5, 20.0]
    path.write_text("frequency,sigma,\n10.5,0.1,\n20,0.1,3\n")
    with pytest.raises(InputError, match="'Unnamed: 2' is unknown"):
        read_modes(path)


def test_a_heading_that_stands_twice_is_called_so(tmp_path: Path) -> None:
    path = tmp_path / "modes.csv"
    path.write_text("frequency,sigma,sigma\n10.5,0.1,0.2\n")
    with pytest.raises(InputError, match="column 'sigma' is given twice"):
        read_modes(path)
