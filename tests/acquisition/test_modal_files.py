"""Tables of modes."""

from __future__ import annotations

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
def test_what_is_wrong_is_said(tmp_path, text, word):
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
    path.write_text("frequency,1+Z,3-Z,sigma 3-Z,sigma 1+Z\n10,1,2,0.2,0.1\n20,3,4,0.4,0.3\n")
    modal = read_modes(path)
    assert modal.shape_sigma.tolist() == [[0.1, 0.3], [0.2, 0.4]]
    path.write_text("frequency,1+Z,3-Z,sigma 3-Z\n10,1,2,0.2\n")
    with pytest.raises(InputError, match=r"no column 'sigma 1\+Z'"):
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
        tmp_path / "a.uff", modal=ModalData(np.array([5.0, 7.0]), nothing, dofs=(Dof(1, 3),), shapes=shapes)
    )
    data = (tmp_path / "a.uff").read_bytes()
    (tmp_path / "b.uff").write_bytes(data[: len(data) - 60])
    with pytest.raises(InputError, match="a mode may be lost"):
        read_modes(tmp_path / "b.uff")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("frequency,sigmo\n10.5,0.1\n", "column 'sigmo' is none known here, is 'sigma' meant"),
        ("frequency,sigma,x+Z\n10.5,0.1,1\n", "column 'x\\+Z' is none known"),
        ("frequency\n10.5,0.1\n", "more values than the header has names"),
        ("frequency,sigma\n10.5,0.1\n11,0.1,7\n", "no table of comma-separated columns"),
        ("frequency,sigma\ninf,0.1\n", "'inf' in column 'frequency' is no number"),
        ("frequency,sigma\n1e999,0.1\n", "beyond all bounds"),
        ("frequency,sigma\n1_0,0.1\n", "is no number"),
    ],
)
def test_a_damaged_table_of_modes_is_refused_in_one_line(tmp_path, text, said):
    (tmp_path / "modes.csv").write_text(text)
    with pytest.raises(InputError, match=said) as error:
        read_modes(tmp_path / "modes.csv")
    assert "\n" not in str(error.value)
