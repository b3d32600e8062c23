"""Files of Nastran's OUTPUT4, as text and in binary, and of OUTPUT2, read as a model with its node table."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import undetectable
from corpus_matrices import chain
from family import Case, Family, written
from nastran_cases import output2, write_op4

from updating.models.imported import read_imported

NODES = b"node,x,y,z,direction,row\n" + b"".join(b"%d,0.%d,0,0,3,%d\n" % (n + 1, n, n) for n in range(1, 5))


def _read(path: Path) -> tuple[Any, Sequence[str]]:
    found = read_imported(path, path, path.with_name("nodes.csv"))
    return [found.stiffness, found.mass], ()


def _case(name: str, content: bytes, matrices: Sequence[np.ndarray]) -> Case:
    files = {name: content, "nodes.csv": NODES}
    if "text" in name:
        judge = undetectable.text(free=lambda number, line: b"1P" in line)
        return Case(name, files, 64, lambda one, two: judge(_parted(one), _parted(two)))
    spans = _values(content, matrices)
    judge = undetectable.payload(spans, len(content), lambda one, two: False)
    return Case(name, files, 64, judge, spans=spans)


WIDTH = 23
"""Characters of a number in a text of OUTPUT4."""


def _parted(text: bytes) -> bytes:
    """Return a text with blanks between its numbers, which touch where they are negative."""
    field = re.compile(rb".{%d}" % WIDTH)
    return re.sub(rb"(?m)^[ -]\d\..*$", lambda line: field.sub(rb"\g<0> ", line[0]), text)


def _values(content: bytes, matrices: Sequence[np.ndarray]) -> list[tuple[int, int]]:
    """Return where the entries of matrices stand in a file, one after the other."""
    found, at = list[tuple[int, int]](), 0
    for matrix in matrices:
        for value in matrix.T[matrix.T != 0]:
            at = content.index(value.astype("<f8").tobytes(), at)
            found.append((at, at + 8))
            at += 8
    return found


def nastran_families() -> list[Family]:
    """Return the family of files with a stiffness and a mass."""
    k, m = (matrix.toarray() for matrix in chain())
    layouts = ("dense text", "sparse text", "wide sparse text", "sparse binary", "wide sparse binary")
    cases = [
        _case(
            f"{layout}.op4",
            written("a.op4", lambda path, of=layout: write_op4(path, of, KAA=k, MAA=m)),
            (k, m),
        )
        for layout in layouts
    ]
    return [Family("Nastran", [*cases, _case("a.op2", output2({"KAA": k, "MAA": m}), (k, m))], _read)]
