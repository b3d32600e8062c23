"""Matrices: MatrixMarket, Harwell-Boeing, archives of numpy, and a job of CalculiX."""

from __future__ import annotations

import functools
import gzip
import io
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import undetectable
from family import Case, Family, written
from mutators import repacked
from scipy import sparse
from scipy.io import mmwrite

from updating.models.imported import read_imported, read_matrix


def chain(elements: int = 4) -> tuple[Any, Any]:
    """Return a chain of springs and masses, clamped at its root, that is no multiple of itself anywhere."""
    stiff = 1e6 * (1 + 0.125 * np.arange(elements + 1))
    k = sparse.diags_array(
        [stiff[:-1] + stiff[1:], -stiff[1:-1], -stiff[1:-1]], offsets=[0, 1, -1], shape=(elements, elements)
    )
    return sparse.csr_array(k), sparse.csr_array(sparse.diags_array(0.5 + 0.25 * np.arange(elements)))


def market(symmetry: str, *, dense: bool = False) -> bytes:
    """Return the stiffness as MatrixMarket."""
    plain = io.BytesIO()
    stiffness = chain(6)[0]
    mmwrite(
        plain,
        stiffness.toarray() if dense else sparse.coo_array(stiffness),
        comment="a chain",
        symmetry=symmetry,
    )
    return plain.getvalue()


def boeing(kind: str = "RSA") -> bytes:
    """Return the stiffness as Harwell-Boeing, with fields that touch and exponents with D."""
    whole = sparse.csc_array(chain(6)[0])
    matrix = sparse.csc_array(sparse.tril(whole)) if kind == "RSA" else whole
    matrix.sort_indices()

    def block(numbers: list[str], each: int) -> list[str]:
        return ["".join(numbers[i : i + each]) for i in range(0, len(numbers), each)]

    parts = [
        block([f"{p + 1:8d}" for p in matrix.indptr], 10),
        block([f"{i + 1:8d}" for i in matrix.indices], 10),
        block([f"{v:25.16E}".replace("E", "D") for v in matrix.data], 3),
    ]
    n = matrix.shape[0]
    head = [
        f"{'a chain':72s}{'CHAIN':8s}",
        "".join(f"{c:14d}" for c in (sum(map(len, parts)), *map(len, parts), 0)),
        f"{kind:14s}{n:14d}{n:14d}{matrix.nnz:14d}{0:14d}",
        f"{'(10I8)':16s}{'(10I8)':16s}{'(1P,3D25.16)':20s}{'':20s}",
    ]
    return ("\n".join([*head, *(line for part in parts for line in part)]) + "\n").encode()


def triplets(matrix: Any) -> bytes:
    """Return a matrix as CalculiX writes it: one triangle, column by column."""
    upper = sparse.coo_array(sparse.triu(matrix))
    order = np.lexsort((upper.row, upper.col))
    rows = zip(upper.row[order] + 1, upper.col[order] + 1, upper.data[order], strict=True)
    return "".join(f"{i} {j} {v:20.13e}\n" for i, j, v in rows).encode()


DECK = b"""** a chain
*NODE, NSET=ALL
1, 0.0, 0.0, 0.0
2, 0.1, 0.0, 0.0
3, 0.2, 0.0, 0.0
4, 0.3, 0.0, 0.0
5, 0.4, 0.0, 0.0
*NSET, NSET=ROOT
1,
*NSET, NSET=REST, GENERATE
2, 5, 1
*BOUNDARY
ROOT, 1, 3
REST, 1, 2
*STEP
*FREQUENCY
3
*END STEP
"""
DOFS = b"".join(b"%d.3\n" % n for n in (2, 3, 4, 5))


def _matrix_family(name: str, cases: dict[str, bytes], judge: undetectable.Judge, head: int) -> Family:
    def read(path: Path) -> tuple[Any, Sequence[str]]:
        return read_matrix(path), ()

    plainly = undetectable.without_exponents if name == "MatrixMarket" else None
    found = [Case(file, {file: content}, head, judge, plainly=plainly) for file, content in cases.items()]
    return Family(name, found, read)


def _market_judge(original: bytes, mutant: bytes) -> bool:
    one, two = (gzip.decompress(c) if c[:2] == b"\x1f\x8b" else c for c in (original, mutant))
    return undetectable.text(free=lambda number, line: line.startswith(b"%") and number > 0)(one, two)


def _archives() -> dict[str, bytes]:
    stiffness = chain(6)[0]
    found = {
        f"{kind}.npz": repacked(
            written("a.npz", functools.partial(sparse.save_npz, matrix=stiffness.asformat(kind)))
        )
        for kind in ("csr", "csc", "coo", "dia", "bsr")
    }
    found["plain.npz"] = repacked(written("a.npz", lambda path: np.savez(path, K=stiffness.toarray())))
    found["plain.npy"] = written("a.npy", lambda path: np.save(path, stiffness.toarray()))
    return found


def matrix_families() -> list[Family]:
    markets = {
        "symmetric.mtx": market("symmetric"),
        "general.mtx": market("general"),
        "dense.mtx": market("general", dense=True),
        "k.mtx.gz": gzip.compress(market("symmetric"), mtime=0),
    }
    k, m = chain()
    job = {"job.sti": triplets(k), "job.mas": triplets(m), "job.dof": DOFS, "job.inp": DECK}

    def read_job(path: Path) -> tuple[Any, Sequence[str]]:
        found = read_imported(*(path.with_name(name) for name in ("job.sti", "job.mas", "job.inp")))
        return [found.stiffness, found.mass, found.nodes], ()

    calculix = [
        Case(
            name,
            job,
            80,
            _without_unused(undetectable.text(free=_comment(name), rows=True, ends=True)),
            plainly=undetectable.without_exponents,
        )
        for name in job
    ]
    return [
        _matrix_family("MatrixMarket", markets, _market_judge, 80),
        _matrix_family(
            "Harwell-Boeing",
            {"k.rsa": boeing(), "k.rua": boeing("RUA")},
            undetectable.text(free=lambda number, line: number == 0),
            4 * 81,
        ),
        _matrix_family("numpy matrices", _archives(), undetectable.archive, 200),
        Family("CalculiX", calculix, read_job),
    ]


_SET = re.compile(rb"^\*NSET,.*NSET=([^,\n]+).*$", re.MULTILINE)


def _without_unused(judge: undetectable.Judge) -> undetectable.Judge:
    """Return a judge of decks to whom the name of a set is free where nothing else in the deck has it."""

    def unnamed(found: re.Match[bytes]) -> bytes:
        return b"" if found.string.count(found[1]) == 1 else found[0]

    return lambda original, mutant: judge(original, _SET.sub(unnamed, mutant))


def _comment(name: str) -> Callable[[int, bytes], bool]:
    """Return which lines are comments: of decks those with two stars, of matrices all that CalculiX does not write."""
    starts = (b"**",) if name.endswith(".inp") else (b"*", b"#", b"%", b"!")
    return lambda number, line: line.strip().startswith(starts)
