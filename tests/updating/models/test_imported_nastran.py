"""Matrices of OUTPUT4 and OUTPUT2: all layouts, the choice of a matrix, and damage found before it is followed."""

from __future__ import annotations

import re
import struct
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from imported_cases import beam_matrices, beam_table, clamp, spec_of
from labelled_cases import places, punched
from nastran_cases import LAYOUTS, output2, write_op4
from scipy import sparse

from acquisition.errors import StudyError
from updating.models import build_structure
from updating.models.imported import read_imported, read_matrix

ELEMENTS = 6
K, M = (clamp(matrix) for matrix in beam_matrices(ELEMENTS))


def node_table(path: Path) -> Path:
    table = beam_table(ELEMENTS, clamped=True)
    lines = [
        f"{n}, {x}, {y}, {z}, {d}, {'' if r < 0 else r + 1}"
        for n, (x, y, z), d, r in zip(
            table.node.tolist(),
            table.places.tolist(),
            table.direction.tolist(),
            table.row.tolist(),
            strict=True,
        )
    ]
    path.write_text("\n".join(["node, x, y, z, direction, row", *lines]) + "\n")
    return path


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_of_output4_gives_the_same_matrices(tmp_path: Path, layout: str) -> None:
    path = write_op4(tmp_path / "model.op4", layout, KAA=K, MAA=M)
    for kind, matrix in (("stiffness", K), ("mass", M)):
        np.testing.assert_allclose(read_matrix(path, kind).toarray(), matrix.toarray(), rtol=1e-15)


@pytest.mark.parametrize(
    ("order", "word", "label"), [("<", 4, True), (">", 4, True), ("<", 8, True), ("<", 4, False)]
)
def test_every_layout_of_output2_gives_the_same_matrices(
    tmp_path: Path, order: str, word: int, label: bool
) -> None:
    path = tmp_path / "model.op2"
    path.write_bytes(output2({"KAA": K, "MAA": M}, order=order, word=word, label=label))
    for kind, matrix in (("stiffness", K), ("mass", M)):
        np.testing.assert_array_equal(read_matrix(path, kind).toarray(), matrix.toarray())


def test_columns_without_entries_and_single_precision_are_read(tmp_path: Path) -> None:
    gaps = np.diag([4.0, 0.0, 3.0, 0.0])
    (tmp_path / "k.op2").write_bytes(output2({"KAA": gaps}))
    assert read_matrix(tmp_path / "k.op2").toarray().tolist() == gaps.tolist()
    header = struct.pack("<6i8si", 24, 2, 2, 6, 1, 0, b"", 0)[:20] + b"KAA     " + struct.pack("<i", 24)
    columns = [struct.pack("<4ifi", 16, j, j, 1, value, 16) for j, value in ((1, 2.5), (2, 0.5), (3, 1.0))]
    (tmp_path / "k.op4").write_bytes(header + b"".join(columns))
    assert read_matrix(tmp_path / "k.op4").toarray().tolist() == [[2.5, 0.0], [0.0, 0.5]]


def test_a_model_of_one_file_has_the_modes_of_its_matrices(tmp_path: Path) -> None:
    """Damping matrix, loads and a pair of another set are in the same file."""
    path = write_op4(
        tmp_path / "model.op4",
        "sparse binary",
        PA=np.ones((12, 1)),
        K4AA=0.01 * K,
        KAA=K,
        MAA=M,
        KLAM=np.ones((2, 3)),
    )
    imported = read_imported(path, path, node_table(tmp_path / "nodes.csv"), stiffness_parts=[path])
    expected = (
        np.sort(np.sqrt(np.linalg.eigvals(np.linalg.solve(M.toarray(), K.toarray())).real))[:3] / 2 / np.pi
    )
    assert build_structure(spec_of(imported)).eigen(3)[0] == pytest.approx(
        (2 * np.pi * expected) ** 2, rel=1e-6
    )
    assert abs(imported.stiffness_parts[0] - imported.stiffness).max() == 0


def test_several_pairs_are_listed_with_the_key_to_write(tmp_path: Path) -> None:
    path = write_op4(tmp_path / "model.op4", "dense text", KGG=2 * K, KAA=K, MGG=2 * M, MAA=M)
    nodes = node_table(tmp_path / "nodes.csv")
    with pytest.raises(
        StudyError,
        match=r'needed as stiffness; the file has KGG, KAA, MGG, MAA: write stiffness_name = "..."',
    ):
        read_imported(path, path, nodes)
    imported = read_imported(path, path, nodes, names=("kaa", "MAA"))
    np.testing.assert_allclose(imported.stiffness.toarray(), K.toarray(), rtol=1e-15)
    with pytest.raises(
        StudyError, match=r"no matrix 'KFF' in it; the file has KGG, .*: correct stiffness_name"
    ):
        read_imported(path, path, nodes, names=("KFF", "MAA"))


def test_a_name_for_a_file_without_names_is_refused(tmp_path: Path) -> None:
    sparse.save_npz(tmp_path / "k.npz", K)
    with pytest.raises(
        StudyError, match=r"stiffness_name = 'KAA' is for .*; a matrix in this format has no name"
    ):
        read_matrix(tmp_path / "k.npz", name="KAA")


def test_matrices_that_cannot_be_are_refused(tmp_path: Path) -> None:
    complex_one = write_op4(tmp_path / "complex.op4", "dense binary", KAA=K * (1 + 0.02j))
    with pytest.raises(StudyError, match="KAA is complex"):
        read_matrix(complex_one)
    (tmp_path / "twice.op2").write_bytes(
        output2({"KAA": K, "MAA": M})[:-12] + output2({"KAA": K}, label=False)
    )
    with pytest.raises(StudyError, match="KAA is 2 times in it"):
        read_matrix(tmp_path / "twice.op2")
    endless = write_op4(tmp_path / "endless.op4", "dense binary", KAA=np.diag([1.0, np.inf]))
    with pytest.raises(StudyError, match="an entry of KAA is not finite"):
        read_matrix(endless)


def test_a_large_matrix_of_output2_takes_the_room_of_its_entries(tmp_path: Path) -> None:
    path = tmp_path / "k.op2"
    content = output2({"KAA": sparse.eye_array(300).tocsr()})
    path.write_bytes(content.replace(struct.pack("<2i", 300, 300), struct.pack("<2i", 300, 20_000), 1))
    tracemalloc.start()
    with pytest.raises(StudyError, match="the matrix is 20000 x 300; stiffness and mass are square"):
        read_matrix(path)
    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()


def _exponents(text: str, letter: str, first: int = 0) -> str:
    """Return a text whose exponents, from a character on, begin with another letter."""
    return text[:first] + re.sub(r"(?<=\d)E(?=[+-])", letter, text[first:])


@pytest.mark.parametrize("layout", ["dense text", "sparse text", "wide sparse text"])
@pytest.mark.parametrize("letter", ["D", "d", "e"])
@pytest.mark.parametrize("later", [False, True])
def test_exponents_of_fortran_are_read_wherever_they_begin(
    tmp_path: Path, layout: str, letter: str, later: bool
) -> None:
    """The first matrix is all zero, so that no number in front shows the letter."""
    path = write_op4(tmp_path / "model.op4", layout, BAA=0 * K, KAA=K, MAA=M)
    text = path.read_text()
    path.write_text(_exponents(text, letter, text.index("MAA") if later else 0))
    for kind, matrix in (("stiffness", K), ("mass", M)):
        np.testing.assert_array_equal(read_matrix(path, kind).toarray(), matrix.toarray())


def test_a_number_that_lost_its_first_digit_is_refused(tmp_path: Path) -> None:
    """1P writes one digit before the point: what begins with the point was longer."""
    path = write_op4(tmp_path / "a.op4", "dense text", KAA=np.diag([1.25e5, 2.25e5]))
    text = path.read_text()
    assert read_matrix(path).shape == (2, 2)
    path.write_text(text.replace(" 1.25", "  .25", 1))
    with pytest.raises(StudyError, match="no digit before its point, against the format 1P"):
        read_matrix(path)
    path.write_text(text.replace(" 1.25", "  .25", 1).replace("1P,", ""))
    assert read_matrix(path)[0, 0] == 0.25e5


def test_an_exponent_of_three_digits_has_no_letter(tmp_path: Path) -> None:
    path = write_op4(tmp_path / "model.op4", "dense text", KAA=np.diag([2.0, -3.0]))
    path.write_text(re.sub(r"(-3\.0+)E\+00", r"\1-120", path.read_text()))
    np.testing.assert_array_equal(read_matrix(path).toarray(), np.diag([2.0, -3e-120]))
    path.write_text(path.read_text().replace("-120", "+-20"))
    with pytest.raises(StudyError, match="not a whole file of OUTPUT4"):
        read_matrix(path)


def test_rows_beside_nodes_and_directions_are_refused_by_what_they_are(tmp_path: Path) -> None:
    free = beam_matrices(ELEMENTS)
    by_rows = write_op4(tmp_path / "free.op4", "sparse binary", KAA=free[0], MAA=free[1])
    named = punched(tmp_path / "free.pch", KAAX=free[0], MAAX=free[1])
    nodes = places(tmp_path / "nodes.csv")
    for stiffness, mass in ((by_rows, named), (named, by_rows)):
        with pytest.raises(
            StudyError, match=r"free\.pch: its entries are given by node .* those of free\.op4 by row"
        ):
            read_imported(stiffness, mass, nodes)


HUGE = {
    "rows": (0, 8, 16),
    "columns": (0, 0, 8),
    "words of a column": (1, 16, 24),
    "packed length": (2, 0, 11),
}
"""Line and columns of counts in a sparse text."""


@pytest.mark.parametrize(
    ("layout", "count"),
    [
        *((layout, count) for layout in ("sparse text", "wide sparse text") for count in HUGE),
        *(("dense text", count) for count in list(HUGE)[:3]),
    ],
)
def test_a_count_beyond_the_file_is_refused_at_once(tmp_path: Path, layout: str, count: str) -> None:
    path = write_op4(tmp_path / "k.op4", layout, KAA=K)
    lines = path.read_bytes().split(b"\n")
    line, start, end = HUGE[count]
    lines[line] = lines[line][:start] + b"9" * (end - start) + lines[line][end:]
    path.write_bytes(b"\n".join(lines))
    tracemalloc.start()
    begun = time.process_time()
    with pytest.raises(StudyError, match=r"not a whole file of OUTPUT4 \(|row or column 9+ in a matrix of"):
        read_matrix(path)
    taken, (_, peak) = time.process_time() - begun, tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert taken < 0.5 and peak < 1_000_000


@pytest.mark.parametrize("name", ["k.op4", "text.op4", "k.op2"])
def test_a_file_cut_anywhere_is_refused_in_one_line(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    if name == "k.op2":
        path.write_bytes(output2({"KAA": K}))
    else:
        write_op4(path, "dense text" if name == "text.op4" else "sparse binary", KAA=K)
    content = path.read_bytes()
    end = len(content) - 20 if name == "k.op2" else len(content) - 30
    for size in range(0, end, 7):
        path.write_bytes(content[:size])
        with pytest.raises(StudyError) as caught:
            read_matrix(path)
        assert str(path) in str(caught.value) and "\n" not in str(caught.value)
