"""MATLAB files: what scipy writes is read to the last bit, what is damaged is refused in one line."""

from __future__ import annotations

import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from acquisition import Dof, FrfSet, InputError, ModalData, layout_from, read_mat, read_test

LINES = np.linspace(0.0, 100.0, 51)
H = np.random.default_rng(1).standard_normal((51, 2, 3)) + 1j * np.random.default_rng(2).standard_normal(
    (51, 2, 3)
)
FRFS = {
    "frequency": "f", "frfs": "test.H", "unit": "g/N", "responses": ["1+Z", "2-Z"], "references": ["3+Z", "4+Z", "5-X"],
}  # fmt: skip
MODES = {
    "frequency": "fn", "damping": "zeta", "damping_unit": "percent", "shapes": "Phi", "dofs": ["1+Z", "2-Z"],
}  # fmt: skip
SHAPES = np.array([[1.0, 0.5, 2.0], [0.3j, -1.0, 4.0]])


def layout(table: dict[str, Any], **more: Any) -> Any:
    return layout_from({"mat": table} | more)


def saved(folder: Path, name: str = "test.mat", *, compressed: bool = True, **values: Any) -> Path:
    savemat(folder / name, values, do_compression=compressed)
    return folder / name


def frf_file(folder: Path, *, compressed: bool = True) -> Path:
    test = {"H": H, "note": "a beam", "cells": np.array([1, "two"], dtype=object)}
    return saved(folder, compressed=compressed, f=LINES, test=test, other="text", a=np.eye(40))


def mode_file(folder: Path) -> Path:
    return saved(folder, fn=np.array([[10.0], [20.0], [31.5]]), zeta=np.array([1, 2, 3]), Phi=SHAPES)


@pytest.mark.parametrize("compressed", [True, False])
def test_frfs_of_a_structure(tmp_path: Path, compressed: bool) -> None:
    nodes = {"1": [0.0, 0.0, 0.0], "2": [0.1, 0.0, 0.0]}
    frfs = read_mat(frf_file(tmp_path, compressed=compressed), layout(FRFS, nodes=nodes, decay=2.0))
    assert isinstance(frfs, FrfSet)
    assert np.array_equal(frfs.frequency, LINES) and frfs.decay == 2.0 and frfs.geometry.nodes == (1, 2)
    assert frfs.responses == (Dof(1, 3),) * 3 + (Dof(2, -3),) * 3
    assert frfs.references == (Dof(3, 3), Dof(4, 3), Dof(5, -1)) * 2
    np.testing.assert_array_equal(frfs.values, 9.80665 * H.reshape(51, 6).T)


@pytest.mark.parametrize("samples", [100, 101, 51])
def test_a_sampling_rate_makes_the_lines_where_there_is_no_axis(tmp_path: Path, samples: int) -> None:
    """Lines are the rate over the number of samples apart; of a spectrum up to the rate, the second half is no FRF."""
    table = {**FRFS, "frfs": "H"}
    del table["frequency"]
    path = saved(tmp_path, fs=1000.0, H=H)
    frfs = read_mat(path, layout(table, rate="fs", samples=samples))
    half = samples // 2 + 1
    np.testing.assert_allclose(frfs.frequency, np.arange(half) * 1000.0 / samples, rtol=1e-12)
    np.testing.assert_array_equal(frfs.values, 9.80665 * H[:half].reshape(half, 6).T)
    with pytest.raises(InputError, match=r"51 lines and no frequency, .*: 100 or 101 if .*, 51 if"):
        read_mat(path, layout(table, rate="fs"))
    with pytest.raises(InputError, match="samples = 90 has 46 lines"):
        read_mat(path, layout(table, rate="fs", samples=90))
    stated = read_mat(path, layout(table, rate="1 kHz", samples=samples))
    np.testing.assert_array_equal(stated.frequency, frfs.frequency)
    for more in (
        {},
        {"rate": 1000.0, "mat": {**table, "frequency": "f"}},
        {"rate": 1000.0, "mat": {"frequency": "fn"}},
    ):
        with pytest.raises(InputError, match="needs frequency, of the lines or of the modes"):
            layout_from({"mat": table} | more)


def test_earlier_names_of_the_rate_are_refused_with_the_one_there_is() -> None:
    with pytest.raises(InputError, match="the key is rate, not rate_variable; write rate = 'fs'"):
        layout_from({"rate_variable": "fs"})
    with pytest.raises(InputError, match=r"\[mat\] has no rate; write rate = 'fs' above it"):
        layout({"frfs": "H", "rate": "fs"})


def test_axes_in_any_order_and_left_out(tmp_path: Path) -> None:
    turned = saved(tmp_path, f=LINES, H=H.transpose(2, 0, 1))
    table = {**FRFS, "frfs": "H", "unit": "", "axes": ["reference", "line", "response"]}
    frfs = read_test(turned, layout=layout(table))[0]
    np.testing.assert_array_equal(frfs.values, H.reshape(51, 6).T)
    one = saved(tmp_path, f=LINES, H=H[:, :, 0])
    table = {**table, "axes": ["line", "response"], "references": ["3+Z"]}
    np.testing.assert_array_equal(read_mat(one, layout(table)).values, H[:, :, 0].T)
    with pytest.raises(InputError, match="several references without an axis"):
        read_mat(one, layout(table | {"references": ["3+Z", "4+Z"]}))
    with pytest.raises(InputError, match=r"shape \(51, 2\), but the layout states"):
        read_mat(one, layout(table | {"axes": ["response", "line"]}))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"fn": [10.0, 20.0], "zeta": [1.2, 0.8]}, 'if it is in %, write damping_unit = "percent"'),
        ({"fn": [10.0, 20.0], "zeta": [0.01, -0.5]}, "damping ratio -0.5 of mode 2"),
        ({"fn": [10.0, 10.0], "zeta": [0.01, 0.01]}, "modes 1 and 2 are the same mode"),
        ({"fn": [0.0, 10.0], "zeta": [0.01, 0.01]}, "not positive"),
    ],
)
def test_modes_that_cannot_be_are_refused_as_in_a_table(
    tmp_path: Path, values: dict[str, list[float]], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        read_mat(saved(tmp_path, **values), layout({"frequency": "fn", "damping": "zeta"}))


def test_modes(tmp_path: Path) -> None:
    modal = read_mat(mode_file(tmp_path), layout(MODES))
    assert isinstance(modal, ModalData)
    assert modal.frequency.tolist() == [10.0, 20.0, 31.5]
    np.testing.assert_allclose(modal.damping, [0.01, 0.02, 0.03])
    assert modal.dofs == (Dof(1, 3), Dof(2, 3))
    np.testing.assert_array_equal(modal.shapes, SHAPES * np.array([[1], [-1]]))
    with pytest.raises(InputError, match="names modes"):
        read_test(tmp_path / "test.mat", layout=layout(MODES))


def test_a_rule_places_the_one_reference_of_each_file(tmp_path: Path) -> None:
    """The hammer roves from file to file: without its rule every file would be hit at the same point."""
    table = {"frequency": "f", "frfs": "test.H", "axes": ["line", "response"], "responses": ["1+Z", "2-Z"]}
    test = {"H": H[:, :, 0]}
    paths = [saved(tmp_path, f"p{n}.mat", f=LINES, test=test) for n in (3, 4)]
    rules = [{"match": "p3*", "node": 3}, {"match": "p4*", "node": 4, "direction": "-x"}]
    plan = layout({**table, "references": ["9+Z"]}, file=rules)
    found = [read_mat(path, plan).references[0] for path in paths]
    assert found == [Dof(3, 3), Dof(4, -1)]
    with pytest.raises(InputError, match="no \\[\\[file\\]\\] rule of layout matches it"):
        read_mat(saved(tmp_path, "q5.mat", f=LINES, test=test), plan)
    modes = layout({"frequency": "fn", "shapes": "Phi", "dofs": ["1+Z", "2-Z"]}, file=rules)
    with pytest.raises(InputError, match="gives the points of FRFs"):
        read_mat(mode_file(tmp_path), modes)


def test_a_mat_file_goes_through_the_front_door(tmp_path: Path) -> None:
    import modalkit as mk

    path = tmp_path / "layout.toml"
    path.write_text('[mat]\nfrequency = "fn"\nshapes = "Phi"\ndofs = ["1+Z", "2-Z"]\n')
    modes = mk.read(mode_file(tmp_path), layout=str(path))
    assert isinstance(modes, mk.Modes) and len(modes) == 3 and mk.mac(modes).shape == (3, 3)
    path.write_text(
        '[mat]\nfrequency = "f"\nfrfs = "test.H"\nresponses = ["1+Z", "2-Z"]\nreferences = ["3+Z", "4+Z", "5-X"]\n'
    )
    assert len(mk.read(frf_file(tmp_path), layout=path).frfs.responses) == 6


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"frfs": "nothing"}, "no variable 'nothing' in it; there are 'f', 'test'"),
        ({"frfs": "test.G"}, "no field 'G' in 'test'; there are 'H', 'note', 'cells'"),
        ({"frfs": "f.G"}, "is not a structure"),
        ({"frfs": "test.note"}, "is text; name one"),
        ({"frfs": "test.cells"}, "is a cell array; name one"),
        ({"frfs": "test"}, "is a structure; name one"),
        ({"frfs": "other"}, "is text"),
        ({"frequency": "a"}, "not a row or column"),
        ({"unit": "kg"}, "not a known unit"),
        ({"axes": ["line", "line"]}, "in order"),
        ({"responses": ["1"]}, "not a degree of freedom"),
        ({"quantity": "force"}, "quantity"),
        ({"frf": "x"}, "unknown key 'frf'"),
        ({"frequency": 3}, "is not a text"),
        ({"responses": "1+Z"}, "not a list of texts"),
    ],
)
def test_what_does_not_fit_is_said(tmp_path: Path, change: dict[str, Any], word: str) -> None:
    with pytest.raises(InputError, match=word.replace("(", r"\(")):
        read_mat(frf_file(tmp_path), layout(FRFS | change))


def test_other_versions_are_refused_with_what_to_do(tmp_path: Path) -> None:
    path = tmp_path / "new.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + b"\x89HDF\r\n\x1a\n" + bytes(600))
    with pytest.raises(InputError, match=r"7\.3 \(HDF5\).*-v7"):
        read_mat(path, layout(MODES))
    savemat(path, {"fn": LINES}, format="4")
    with pytest.raises(InputError, match="not a MATLAB file of version 5"):
        read_mat(path, layout(MODES))
    for content in (b"", b"MATLAB 5.0", bytes(128)):
        path.write_bytes(content)
        with pytest.raises(InputError, match="not a MATLAB file"):
            read_mat(path, layout(MODES))
    with pytest.raises(InputError, match="cannot be opened"):
        read_mat(tmp_path / "none.mat", layout(MODES))
    with pytest.raises(InputError, match=r"\[mat\]"):
        read_test(path)


def test_a_variable_that_stands_twice_is_not_chosen_from(tmp_path: Path) -> None:
    """Nor are a thousand bombs of one name unpacked one after the other."""
    whole = saved(tmp_path, fn=[10.0, 20.0]).read_bytes()
    other = saved(tmp_path, fn=[11.0, 21.0]).read_bytes()
    (tmp_path / "test.mat").write_bytes(whole + other[128:])
    with pytest.raises(InputError, match="holds 'fn' twice"):
        read_mat(tmp_path / "test.mat", layout({"frequency": "fn"}))


@pytest.mark.long
def test_a_bomb_takes_no_more_than_its_share(tmp_path: Path) -> None:
    path = saved(tmp_path, fn=np.zeros(20_000_000), other=np.zeros(20_000_000))
    assert path.stat().st_size < 1_000_000
    tracemalloc.start()
    with pytest.raises(InputError, match="decompress to more than"):
        read_mat(path, layout({"frequency": "fn"}))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 40e6


@pytest.mark.parametrize("compressed", [True, False])
def test_damaged_files_are_refused_or_read(tmp_path: Path, compressed: bool) -> None:
    """Bytes turned, cut out, put in: an error of ours or numbers, never another one."""
    whole, plan = frf_file(tmp_path, compressed=compressed).read_bytes(), layout(FRFS)
    rng, path, refused = np.random.default_rng(5), tmp_path / "mutant.mat", 0
    for _ in range(600):
        data = bytearray(whole)
        at = int(rng.integers(0, len(data) if rng.random() < 0.5 else 700))
        kind = rng.integers(0, 4)
        if kind == 0:
            data[at] ^= 1 << int(rng.integers(0, 8))
        elif kind == 1:
            del data[at : at + int(rng.integers(1, 40))]
        elif kind == 2:
            data[at:at] = rng.bytes(int(rng.integers(1, 20)))
        else:
            data[at : at + 4] = rng.choice(
                [b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\0\0\0\0", b"\0\0\0\x80"]
            )
        path.write_bytes(data)
        try:
            found = read_mat(path, plan)
        except InputError as error:
            refused += 1
            assert "\n" not in str(error)
        else:
            assert isinstance(found, FrfSet)
    assert refused > 100
