"""Readers of imported matrices: what is written by others is read as it is, and what is not is refused in one line."""

from __future__ import annotations

import gzip
import io
import re
import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from imported_cases import beam_matrices, beam_table, clamp, write_rsa
from scipy import sparse
from scipy.io import hb_write, mmwrite, savemat

from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported import read_imported, read_matrix

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
    path.write_bytes(gzip.compress(text, mtime=0) if path.suffix == ".gz" else text)


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
    "k.mat": lambda path: savemat(path, {"K": sparse.csc_array(K), "order": 3, "made": "by hand"}),
    "packed.mat": lambda path: savemat(path, {"K": K.toarray()}, do_compression=True),
    "packed sparse.mat": lambda path: savemat(path, {"K": sparse.csc_array(K)}, do_compression=True),
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


def test_room_for_more_entries_in_a_mat_is_no_entry(tmp_path: Path) -> None:
    roomy = sparse.csc_array(K)
    roomy.data = np.append(roomy.data, np.full(7, np.nan))
    roomy.indices = np.append(roomy.indices, np.full(7, -1, dtype=roomy.indices.dtype))
    savemat(tmp_path / "k.mat", {"K": roomy})
    np.testing.assert_allclose(read_matrix(tmp_path / "k.mat").toarray(), K.toarray(), rtol=1e-12)


def standing_twice() -> bytes:
    """Return a sparse matrix of MATLAB whose first column has its first row twice."""
    plain = io.BytesIO()
    savemat(plain, {"K": sparse.csc_array(np.array([[2.0, 1.0], [1.0, 2.0]]))})
    rows = [np.array(each, dtype="<i4").tobytes() for each in ([0, 1, 0, 1], [0, 0, 0, 1])]
    return plain.getvalue().replace(rows[0], rows[1], 1)


def matlab(**values: object) -> bytes:
    plain = io.BytesIO()
    savemat(plain, values, do_compression=True)
    return plain.getvalue()


def behind_its_head(content: bytes, element: bytes) -> bytes:
    return content[:128] + element + content[128:]


BROKEN = [
    (
        "k.mat",
        behind_its_head(matlab(K=np.eye(3)), struct.pack("<IId", 9, 8, 1.0)),
        "type 9 among its variables",
    ),
    ("k.mat", b"", "not a MATLAB file of version 5 to 7"),
    ("k.mat", matlab(K=np.eye(3))[:-20], "is damaged"),
    ("k.mat", b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512), "version 7.3"),
    ("k.mat", matlab(K=np.eye(3), M=np.eye(3)), "holds 2 matrices"),
    ("k.mat", standing_twice(), "an entry that is given twice"),
    ("k.mat", matlab(order=3), "holds 0 matrices"),
    ("k.mat", matlab(K=np.eye(3) * 1j), "complex"),
    ("k.mat", matlab(K=np.zeros((2000, 2000))), "decompress to more than"),
    ("k.xyz", b"1", "no reader for .xyz"),
    ("k.mtx", b"1 2 3\n", "not a MatrixMarket file"),
    ("k.mtx", b"%%MatrixMarket matrix coordinate complex general\n1 1 1\n1 1 1.0 2.0\n", "complex"),
    ("k.rsa", b"title\n", "not a Harwell-Boeing file"),
    ("k.npz", b"no archive", "not an .npz archive"),
    ("k.sti", b"", "is empty"),
    ("k.sti", b"1 1 soft\n", "line 1: 'soft' is not a number"),
    ("k.sti", b"0 1 2.0\n", "CalculiX counts from 1"),
    ("k.sti", b"1 1\n2 2\n", "2 numbers on a line"),
    ("k.sti", b"1 1 1.0 0.0\n2 2 1.0 0.0\n", "4 numbers on a line"),
    ("k.sti", b"1 1 1.0\n2 ", "line 2: 1 numbers on a line where 3 should be"),
    ("k.sti", b"1.5 1 1.0\n", "line 1: '1.5' is not a whole number"),
    ("k.sti", b"1 1 1.0\n99999999999 1 1.0\n", "row or column 99999999999 in a matrix of 2 entries"),
    ("k.sti", b" \n\n", "is empty"),
    ("k.mtx", b"%%MatrixMarket matrix coordinate pattern symmetric\n1 1 1\n1 1\n", "pattern"),
    ("k.npz", b"", "not an .npz archive"),
    ("k.npz", archive(format=np.array(b"csr"), data=np.ones(3)), "not an .npz archive"),
    ("k.npz", archive(K=np.ones((2, 2)) * 1j), "complex128"),
    ("k.npz", complex_sparse(), "complex128"),
]


@pytest.mark.parametrize(("name", "content", "message"), BROKEN)
def test_a_broken_file_is_refused(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(StudyError, match=message) as error:
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
    with pytest.raises(StudyError, match="unknown units 'furlong'"):
        read_imported(*files, units="furlong")


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


HEAD = b"%%MatrixMarket matrix coordinate real general\n"


def damaged_archive(**changes: Any) -> bytes:
    """Return a compressed matrix as ``save_npz`` writes it, with some of its arrays changed."""
    csr = sparse.csr_array(K)
    parts = {"indptr": csr.indptr, "indices": csr.indices, "data": csr.data, "shape": np.array(csr.shape)}
    return archive(format=np.array(b"csr"), **(parts | changes))


def marked(content: bytes, offset: int, value: int) -> bytes:
    """Set a field of the headers of an archive's members, and of its directory where it stands two bytes further."""
    changed = bytearray(content)
    for mark, shift in ((b"PK\x03\x04", 0), (b"PK\x01\x02", 2)):
        for found in re.finditer(re.escape(mark), content):
            changed[found.start() + offset + shift] = value
    return bytes(changed)


def boeing(*, pointers: str = "1 2 3", indices: str = "1 2", layout: str = "(3I8)") -> bytes:
    """Return a Harwell-Boeing file of a diagonal of two."""
    cards = ["".join(f"{w:>8s}" for w in text.split()) for text in (pointers, indices)]
    head = ["title", f"{3:14d}{1:14d}{1:14d}{1:14d}{0:14d}", f"{'RUA':14s}{2:14d}{2:14d}{2:14d}{0:14d}"]
    head.append(f"{layout:16s}{'(3I8)':16s}{'(2E20.12)':20s}{'':20s}")
    return "\n".join([*head, *cards, f"{2.0:20.12E}{3.0:20.12E}"]).encode() + b"\n"


DAMAGED = [
    (
        "k.mtx",
        HEAD + b"2 2 2\n1 1 2,5\n2 2 1.0\n",
        "line 3: '2,5' holds a comma; write numbers with a decimal point",
    ),
    ("k.mtx", HEAD + b"2 2 2\n1 1 2.1P+11\n2 2 1.0\n", "line 3: '2.1P\\+11' is not a number"),
    ("k.mtx", HEAD + b"2 2 2\n1 1 2.1e+11\n2 2 1.0\0\n", "line 4: '1.0.x00' is not a number"),
    ("k.mtx", HEAD + b"2 2 2\n1 1 2.1e+11\n2 2 1.0e", "line 4: '1.0e' is not a number"),
    ("k.mtx", HEAD + b"2 2 2\n1 1 2.1e+11\n2 2", "line 4: 2 numbers on a line where 3 should be"),
    ("k.mtx", HEAD + b"2 2 2\n1 1 2 .1\n2 2 1.0\n", "line 3: 4 numbers on a line"),
    ("k.mtx", HEAD + b"2 2 2\n1 1 1e999\n2 2 1.0\n", "line 3: '1e999' is beyond any number"),
    ("k.mtx", HEAD + b"2 2 2\n1 1e999 1.0\n2 2 1.0\n", "line 3: '1e999' is not a whole number"),
    ("k.mtx", HEAD + b"2 2 2\n1 3 1.0\n2 2 1.0\n", "column 3 in a matrix of 2 x 2"),
    ("k.mtx", HEAD + b"2 2 3\n1 1 1.0\n2 2 1.0\n", "3 entries announced and 2 there"),
    ("k.mtx", HEAD + b"999999999 999999999 1\n1 1 1.0\n", "row or column 999999999 in a matrix of 1 entries"),
    ("k.mtx", HEAD + b"2 2 99999999999999999999\n1 1 1.0\n", "line 2: the size is not given"),
    ("k.mtx.gz", gzip.compress(HEAD, mtime=0)[:-9], "not a whole .gz"),
    ("k.mtx.gz", gzip.compress(HEAD + b" " * 100_000_000, mtime=0), "decompress to more than"),
    ("k.rsa", boeing(layout="(999999999I8)"), "fills 7999999992 columns"),
    ("k.rua", boeing(pointers="1 9 3"), "pointers do not rise"),
    ("k.rua", boeing(pointers="1 2 9"), "pointers do not rise"),
    ("k.rua", boeing(indices="1 7"), "an index lies beyond its 2 rows"),
    ("k.rua", boeing(indices="1 0"), "an index lies beyond its 2 rows"),
    ("k.rua", boeing() + b"1.0\n", "4 lines behind the header where 3 are announced"),
    ("k.npz", damaged_archive(indptr=np.arange(len(K.indptr)) * 1000), "pointers that do not rise"),
    ("k.npz", damaged_archive(indptr=K.indptr[:-1]), "whole numbers should be"),
    ("k.npz", damaged_archive(indices=K.indices - 1), "an index beyond"),
    ("k.npz", damaged_archive(indices=K.indices * 1000), "an index beyond"),
    ("k.npz", damaged_archive(data=K.data[:-1]), "pointers that do not rise"),
    ("k.npz", damaged_archive(shape=np.array([10**12, 10**12])), "row or column 1000000000000 in a matrix"),
    ("k.npz", damaged_archive(data=K.data * np.inf), "an entry is not finite"),
    ("k.npz", marked(damaged_archive(), 6, 1), "encrypted"),
    ("k.npz", marked(damaged_archive(), 8, 99), "not supported"),
    ("k.npy", b"\x93NUMPY\x01\x00\x50\x00" + b"(" * 80, "header of an array cannot be read"),
    ("k.npz", archive(data=np.eye(2), offsets=np.arange(2), shape=np.array([2, 2])), "without its format"),
    ("k.npz", archive(K=np.ones((4, 2))), "is 4 x 2; stiffness and mass are square"),
    ("k.rsa", boeing().replace(b"2.000000000000E", b"2.000\r0000000E"), "a character among"),
    ("k.rsa", re.sub(rb"E\+0\d", b"E+0\r", boeing(), count=1), "a character among"),
]


@pytest.mark.parametrize(("name", "content", "message"), DAMAGED)
def test_what_would_reach_a_parser_unchecked_is_refused(
    tmp_path: Path, name: str, content: bytes, message: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(StudyError, match=message) as error:
        read_matrix(tmp_path / name)
    assert name in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.usefixtures("no_hang")
def test_a_number_of_very_many_digits_is_refused_at_once(tmp_path: Path) -> None:
    (tmp_path / "k.sti").write_text("1" * 160_000 + "\x1a" + "1" * 40_000)
    with pytest.raises(StudyError, match="is not a number"):
        read_matrix(tmp_path / "k.sti")


@pytest.mark.usefixtures("no_hang")
def test_a_shape_of_very_many_digits_is_refused_at_once(tmp_path: Path) -> None:
    np.save(tmp_path / "k.npy", K.toarray())
    whole = (tmp_path / "k.npy").read_bytes()
    head = whole[10 : 10 + int.from_bytes(whole[8:10], "little")]
    longer = re.sub(rb"\((\d+), (\d+)\)", rb"(\1, \2" + b"1" * 6000 + b")", head).strip() + b" (\n"
    (tmp_path / "k.npy").write_bytes(
        whole[:8] + len(longer).to_bytes(2, "little") + longer + whole[10 + len(head) :]
    )
    with pytest.raises(StudyError, match="header of an array"):
        read_matrix(tmp_path / "k.npy")


def test_an_archive_that_claims_more_bytes_than_it_has_takes_no_memory_for_them(tmp_path: Path) -> None:
    np.savez(tmp_path / "k.npz", K=K.toarray())
    content = bytearray((tmp_path / "k.npz").read_bytes())
    at = content.rfind(b"PK\x01\x02") + 20
    content[at : at + 4] = (500_000_000).to_bytes(4, "little")
    (tmp_path / "k.npz").write_bytes(content)
    tracemalloc.start()
    with pytest.raises(StudyError, match="more bytes than the archive has"):
        read_matrix(tmp_path / "k.npz")
    assert tracemalloc.get_traced_memory()[1] < 10_000_000
    tracemalloc.stop()


def test_a_bomb_is_not_unpacked(tmp_path: Path) -> None:
    path = tmp_path / "k.npz"
    np.savez_compressed(path, K=np.zeros((4000, 4000)))
    tracemalloc.start()
    with pytest.raises(StudyError, match="decompress to more than"):
        read_matrix(path)
    assert tracemalloc.get_traced_memory()[1] < 1e6
    tracemalloc.stop()


def test_exponents_of_fortran_in_a_market_file(tmp_path: Path) -> None:
    (tmp_path / "k.mtx").write_bytes(HEAD + b"2 2 2\n1 1 2.1D+11\n2 2 -1.5d-3\n")
    np.testing.assert_array_equal(read_matrix(tmp_path / "k.mtx").toarray(), np.diag([2.1e11, -1.5e-3]))


def test_a_row_that_stands_twice_in_an_export(tmp_path: Path) -> None:
    (tmp_path / "k.sti").write_text("1 1 2.0\n1 2 -1.0\n2 2 2.0\n1 2 -1.0\n")
    with pytest.raises(StudyError, match="1 entries are given twice"):
        read_matrix(tmp_path / "k.sti")
