"""Readers of imported matrices: what is written by others is read as it is, and what is not is refused in one line."""

from __future__ import annotations

import gzip
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from imported_cases import beam_matrices, beam_table, clamp, write_rsa
from scipy import sparse
from scipy.io import hb_write, mmwrite

from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported import read_deck_table, read_imported, read_matrix, read_table
from updating.models.imported.calculix import read_dofs

K, M = (clamp(matrix) for matrix in beam_matrices(6))


def write_triplets(path: Path, matrix: Sparse) -> None:
    upper = sparse.triu(matrix).tocoo()
    order = np.lexsort((upper.row, upper.col))
    rows = zip(upper.row[order] + 1, upper.col[order] + 1, upper.data[order], strict=True)
    path.write_text("".join(f"{i} {j} {v:20.13e}\n" for i, j, v in rows), encoding="ascii")


def squeezed(path: Path) -> None:
    plain = io.BytesIO()
    mmwrite(plain, K, precision=17)
    path.write_bytes(gzip.compress(plain.getvalue()))


def stored_whole(path: Path) -> None:
    """Both triangles under a header that says symmetric, as some exporters do."""
    plain = io.BytesIO()
    mmwrite(plain, K, symmetry="general", precision=17)
    text = plain.getvalue().replace(b"general", b"symmetric", 1)
    path.write_bytes(gzip.compress(text) if path.suffix == ".gz" else text)


def edited_triplets(path: Path, edit: Callable[[str], str]) -> None:
    write_triplets(path, K)
    path.write_text(edit(path.read_text()))


WRITERS = {
    "k.mtx": lambda path: mmwrite(path, K, symmetry="symmetric", precision=17),
    "general.mtx": lambda path: mmwrite(path, K, symmetry="general", precision=17),
    "dense.mtx": lambda path: mmwrite(path, K.toarray(), precision=17),
    "k.mtx.gz": squeezed,
    "k.rsa": lambda path: write_rsa(path, K),
    "k.rua": lambda path: hb_write(path, sparse.csc_matrix(K)),
    "k.npz": lambda path: sparse.save_npz(path, K),
    "coo.npz": lambda path: sparse.save_npz(path, sparse.coo_matrix(K)),
    "plain.npz": lambda path: np.savez(path, K=K.toarray()),
    "k.sti": lambda path: write_triplets(path, K),
    "k.npy": lambda path: np.save(path, K.toarray()),
    "dia.npz": lambda path: sparse.save_npz(path, sparse.dia_array(K)),
    "stored whole.mtx": stored_whole,
    "stored whole.mtx.gz": stored_whole,
    "fortran.sti": lambda path: edited_triplets(path, lambda text: text.replace("e", "D")),
    "comments.sti": lambda path: edited_triplets(path, lambda text: "** of a beam\n\n# K\n" + text),
    "commas.sti": lambda path: edited_triplets(path, lambda text: ",".join(text.split(" "))),
}


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_gives_the_same_matrix(tmp_path: Path, name: str) -> None:
    WRITERS[name](tmp_path / name)
    found = read_matrix(tmp_path / name)
    assert isinstance(found, Sparse)
    np.testing.assert_allclose(found.toarray(), K.toarray(), rtol=1e-12, atol=1e-6)


def archive(**arrays: np.ndarray) -> bytes:
    plain = io.BytesIO()
    np.savez(plain, **arrays)  # type: ignore[arg-type]
    return plain.getvalue()


def complex_sparse() -> bytes:
    plain = io.BytesIO()
    sparse.save_npz(plain, sparse.csr_array(K.toarray() * (1 + 0.01j)))
    return plain.getvalue()


BROKEN = [
    ("k.xyz", b"1", "no reader for .xyz"),
    ("k.mtx", b"1 2 3\n", "not a MatrixMarket file"),
    ("k.mtx", b"%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1.0 2.0\n", "complex"),
    ("k.rsa", b"title\n", "not a Harwell-Boeing file"),
    ("k.npz", b"no archive", "not an .npz archive"),
    ("k.sti", b"", "not a matrix of CalculiX|is empty"),
    ("k.sti", b"1 1 soft\n", "not a matrix of CalculiX"),
    ("k.sti", b"0 1 2.0\n", "CalculiX counts from 1"),
    ("k.sti", b"1 1\n2 2\n", "2 numbers on a line"),
    ("k.sti", b"1 1 1.0 0.0\n2 2 1.0 0.0\n", "4 numbers on a line"),
    ("k.sti", b"1 1 1.0\n2 ", "not a matrix of CalculiX"),
    ("k.sti", b"1.5 1 1.0\n", "not a matrix of CalculiX"),
    ("k.sti", b"1 1 1.0\n99999999999 1 1.0\n", "row or column 99999999999 in a matrix of 2 entries"),
    ("k.sti", b" \n\n", "is empty"),
    ("k.mtx", b"%%MatrixMarket matrix coordinate pattern symmetric\n1 1 1\n1 1\n", "pattern"),
    ("k.npz", b"", "not an .npz archive"),
    ("k.npz", archive(format=np.array(b"csr"), data=np.ones(3)), "not an .npz archive"),
    ("k.npz", archive(K=np.ones((2, 2)) * 1j), "complex128"),
    ("k.npz", complex_sparse(), "complex128"),
]


@pytest.mark.parametrize(("name", "content", "said"), BROKEN)
def test_a_broken_file_is_refused(tmp_path: Path, name: str, content: bytes, said: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(StudyError, match=said) as error:
        read_matrix(tmp_path / name)
    assert name in str(error.value)
    assert "\n" not in str(error.value).strip()


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match="no such file"):
        read_matrix(tmp_path / "k.mtx")


def test_a_harwell_boeing_pattern_holds_no_values(tmp_path: Path) -> None:
    write_rsa(tmp_path / "k.rsa", K)
    text = (tmp_path / "k.rsa").read_text().replace("RSA", "PSA", 1)
    (tmp_path / "k.rsa").write_text(text)
    with pytest.raises(StudyError, match=r"PSA.*RSA or RUA"):
        read_matrix(tmp_path / "k.rsa")


def test_a_harwell_boeing_file_cut_short(tmp_path: Path) -> None:
    write_rsa(tmp_path / "k.rsa", K)
    lines = (tmp_path / "k.rsa").read_text().splitlines()
    (tmp_path / "k.rsa").write_text("\n".join(lines[:-3]))
    with pytest.raises(StudyError, match="cut short"):
        read_matrix(tmp_path / "k.rsa")


def test_an_archive_of_two_matrices_is_one_too_many(tmp_path: Path) -> None:
    np.savez(tmp_path / "both.npz", K=K.toarray(), M=M.toarray())
    with pytest.raises(StudyError, match=r"2 matrices \(K, M\)"):
        read_matrix(tmp_path / "both.npz")


TABLE = "node, x, y, z, direction, row\n1, 0, 0, 0, 3,\n2, 0.1, 0, 0, 3, {0}\n2, 0.1, 0, 0, 5, {1}\n"


@pytest.mark.parametrize("rows", [(0, 1), (1, 2)])
def test_rows_are_counted_from_one_or_from_a_zero_that_is_there(
    tmp_path: Path, rows: tuple[int, int]
) -> None:
    (tmp_path / "nodes.csv").write_text(TABLE.format(*rows))
    table = read_table(tmp_path / "nodes.csv", 2)
    assert table.row.tolist() == [-1, 0, 1]
    assert table.direction.tolist() == [3, 3, 5]
    assert table.places[2].tolist() == [0.1, 0.0, 0.0]


WRONG_TABLES = [
    ("node,x,y,z,row\n1,0,0,0,1\n", "no column direction"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,3\n", r"row 3 \(counted from 1\) lies beyond the 2 rows"),
    ("node,x,y,z,direction,row\n1,0,0,0,7,1\n", "direction 7"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,1\n2,1,0,0,3,1\n", "belongs to two"),
    ("node,x,y,z,direction,row\n1,0,zero,0,3,1\n", "zero"),
    ("node,x,y,z,direction,row\n1,0,,0,3,1\n", "missing or not finite"),
    ("node,x,y,z,direction,row\n1,0,0,0,,1\n", "line 2: node or direction"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,-1\n", "leave it empty"),
    ("node,x,y,z,direction,row\n", "no line has a row"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,\n", "no line has a row"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,1.5\n", r"row 1\.5 is no whole number"),
    ("node,x,y,z,direction,row\n1,0,0,0,3.5,1\n", r"direction 3\.5 is no whole number"),
    ("node,x,y,z,direction,row\n1.5,0,0,0,3,1\n", r"node 1\.5 is no whole number"),
    ("node,x,y,z,direction,row\n1,0,0,0,1,1\n1,0.2,0,0,3,2\n", "node 1 stands at two places"),
    ("node,x,y,z,direction,row\n1,0,0,0,3,1,7\n2,0,0,0,3,2,7\n", "more values than the header has names"),
    ("node;x;y;z;direction;row\n1;0;0;0;3;1\n", "separated by commas"),
    ("", "not a CSV table"),
]


@pytest.mark.parametrize(("text", "said"), WRONG_TABLES)
def test_a_wrong_node_table_is_refused(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "nodes.csv").write_text(text)
    with pytest.raises(StudyError, match=said):
        read_table(tmp_path / "nodes.csv", 2)


DECK = """** a plate
*HEADING
nonsense
*NODE, NSET=LOWER
1, 0.0, 0.0, 0.0
 2, 1.0D-1, 0.0
*INCLUDE, INPUT=more.inp
*NSET, NSET=Held
LOWER
*BOUNDARY
held, 1, 2
3, 3
"""


def deck(folder: Path, text: str = DECK) -> Path:
    (folder / "job.inp").write_text(text)
    (folder / "more.inp").write_text("*NODE\n3, 0.2, 0.1, 0.05\n*NSET, NSET=ODD, GENERATE\n1, 3, 2\n")
    (folder / "job.dof").write_text("1.3\n2.3\n2.3\n3.1\n3.2\n9.1\n")
    return folder / "job.inp"


def test_a_deck_and_its_dof_file_make_a_node_table(tmp_path: Path) -> None:
    path = deck(tmp_path)
    table = read_deck_table(path, tmp_path / "job.dof", 6)
    moving = table.row >= 0
    assert table.node[moving].tolist() == [1, 2, 2, 3, 3]  # node 9 is one of ccx's own making
    assert table.row[moving].tolist() == [0, 1, 2, 3, 4]
    held = set(zip(table.node[~moving].tolist(), table.direction[~moving].tolist(), strict=True))
    assert held == {(1, 1), (1, 2), (2, 1), (2, 2), (3, 3)}
    assert table.places[table.node == 3][0].tolist() == [0.2, 0.1, 0.05]
    assert table.places[table.node == 2][0].tolist() == [0.1, 0.0, 0.0]


WRONG_DECKS = [
    ("*ELEMENT\n1, 2, 3\n", "no \\*NODE card"),
    (DECK + "*NGEN, NSET=A\n", "line 13.*NGEN"),
    (DECK + "*TRANSFORM, NSET=A\n1, 0, 0, 0, 1, 0\n", "no \\*NSET A"),
    (DECK.replace("*NODE, NSET=LOWER", "*NODE, SYSTEM=C"), "is not followed"),
    (DECK + "nobody, 1\n", "no \\*NSET nobody"),
    (DECK.replace("1, 0.0, 0.0, 0.0", "1, here"), "is no node"),
    (DECK.replace("*INCLUDE, INPUT=more.inp", "*INCLUDE, INPUT=less.inp"), "cannot be read"),
    (DECK.replace(" 2, 1.0D-1, 0.0\n", ""), "node 2 stands in no"),
]


@pytest.mark.parametrize(("text", "said"), WRONG_DECKS)
def test_a_deck_that_cannot_be_followed_is_refused(tmp_path: Path, text: str, said: str) -> None:
    path = deck(tmp_path, text)
    with pytest.raises(StudyError, match=said):
        read_deck_table(path, tmp_path / "job.dof", 6)


def test_supports_along_turned_axes_hold_no_row(tmp_path: Path) -> None:
    """The rows of a node under *TRANSFORM are along x, y, z still; only where all three are held is it at rest."""
    turned = (
        DECK + "*NSET, NSET=TURN\n2, 3\n*TRANSFORM, NSET=TURN\n0, 1, 0, 0, 0, 1\n*BOUNDARY\n2, 1\n3, 1, 3\n"
    )
    path = deck(tmp_path, turned.replace("held, 1, 2", "1, 1, 2"))
    table = read_deck_table(path, tmp_path / "job.dof", 6)
    held = set(zip(table.node[table.row < 0].tolist(), table.direction[table.row < 0].tolist(), strict=True))
    assert held == {(1, 1), (1, 2), (3, 1), (3, 2), (3, 3)}


@pytest.mark.parametrize(
    ("units", "length", "force"), [("mm-t-s", 1e-3, 1.0), ("in-lbf-s", 0.0254, 4.4482216)]
)
def test_matrices_in_other_units_are_taken_to_si(
    tmp_path: Path, units: str, length: float, force: float
) -> None:
    """A beam with rows of rotation, written as its makers' units have it: K / (F / L), F and F L; places / L."""
    table = beam_table(6, clamped=True)
    turning = np.isin(np.arange(12), table.row[(table.direction == 5) & (table.row >= 0)])
    per = np.where(turning, 1.0, 1 / length)
    scale = sparse.diags_array(1 / per) / np.sqrt(force * length)
    for name, matrix in (("k", K), ("m", M)):
        sparse.save_npz(tmp_path / f"{name}.npz", sparse.csr_array(scale @ matrix @ scale))
    if units == "mm-t-s":  # 12 EI / h^3 of a free element, in N/mm
        assert (scale @ K @ scale).toarray()[0, 0] == pytest.approx(K.toarray()[0, 0] / 1000)
    lines = ["node,x,y,z,direction,row"]
    for n, (x, y, z), d, r in zip(table.node, table.places / length, table.direction, table.row, strict=True):
        lines.append(f"{n},{float(x)!r},{float(y)!r},{float(z)!r},{d},{'' if r < 0 else r + 1}")
    (tmp_path / "nodes.csv").write_text("\n".join(lines))
    files = (tmp_path / "k.npz", tmp_path / "m.npz", tmp_path / "nodes.csv")
    found = read_imported(*files, stiffness_parts=files[:1], units=units)
    np.testing.assert_allclose(found.stiffness.toarray(), K.toarray(), rtol=1e-7, atol=1e-3)
    np.testing.assert_allclose(found.stiffness_parts[0].toarray(), K.toarray(), rtol=1e-7, atol=1e-3)
    np.testing.assert_allclose(found.mass.toarray(), M.toarray(), rtol=1e-7, atol=1e-12)
    np.testing.assert_allclose(found.nodes.places, table.places, atol=1e-12)
    with pytest.raises(StudyError, match="no units 'furlong'"):
        read_imported(*files, units="furlong")


def test_a_dof_file_of_another_run(tmp_path: Path) -> None:
    path = deck(tmp_path)
    with pytest.raises(StudyError, match="6 degrees of freedom where the matrices have 5"):
        read_deck_table(path, tmp_path / "job.dof", 5)
    (tmp_path / "bad.dof").write_text("1;3\n")
    with pytest.raises(StudyError, match=r"not a list of node.direction"):
        read_dofs(tmp_path / "bad.dof")
    with pytest.raises(StudyError, match=r"beside the .sti"):
        read_dofs(tmp_path / "none.dof")


def test_a_whole_structure_is_read(tmp_path: Path) -> None:
    sparse.save_npz(tmp_path / "k.npz", K)
    mmwrite(tmp_path / "m.mtx", M)
    table = beam_table(6, clamped=True)
    lines = ["node,x,y,z,direction,row"]
    for n, (x, y, z), d, r in zip(table.node, table.places, table.direction, table.row, strict=True):
        lines.append(
            f"{n},{x!r},{y!r},{z!r},{d},{'' if r < 0 else r + 1}".replace("np.float64(", "").replace(")", "")
        )
    (tmp_path / "nodes.csv").write_text("\n".join(lines))
    found = read_imported(tmp_path / "k.npz", tmp_path / "m.mtx", tmp_path / "nodes.csv")
    assert found.order == 12
    assert found.nodes.row.tolist() == table.row.tolist()
    assert found.source == "k.npz, m.mtx"
