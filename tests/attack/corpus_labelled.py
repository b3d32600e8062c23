"""Matrices that name nodes and directions: text of Abaqus, punches of Nastran, and their tables of nodes."""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import undetectable
from family import Case, Family, written
from imported_cases import beam_matrices
from labelled_cases import ELEMENTS, abaqus, places, punched

from updating.models.imported import read_imported

STIFFNESS, MASS, PUNCH, NODES = "job_STIF2.mtx", "job_MASS2.mtx", "se.pch", "nodes.csv"


def _read_abaqus(path: Path) -> tuple[Any, Sequence[str]]:
    found = read_imported(*(path.with_name(name) for name in (STIFFNESS, MASS, NODES)))
    return [found.stiffness, found.mass, found.nodes], ()


def _read_punch(path: Path) -> tuple[Any, Sequence[str]]:
    punch = path.with_name(PUNCH)
    found = read_imported(punch, punch, path.with_name(NODES))
    return [found.stiffness, found.mass, found.nodes], ()


def _once(content: bytes) -> bool:
    """Tell whether no two lines state one entry."""
    labels = [tuple(line.replace(b",", b" ").split()[:4]) for line in undetectable.lines_of(content)]
    return len(set(labels)) == len(labels)


def _abaqus_judge(original: bytes, mutant: bytes) -> bool:
    """Judge lines that nothing counts; each entry stands once."""
    return undetectable.text(rows=True)(original, mutant) and _once(mutant)


def _entries(content: bytes) -> list[bytes] | None:
    """Return the entries of a punch, each on a line with its matrix and column; None where one has none, or two."""
    header, column, found = b"", b"", list[bytes]()
    for line in content.splitlines():
        if line.startswith(b"DMIG "):
            header, column = line, b""
            found.append(_parted(line, 8))
        elif line.startswith(b"DMIG*"):
            column = line
        elif line.startswith(b"* ") and column:
            found.append(_parted(header, 8) + b" " + _parted(column, 16) + b" " + _parted(line, 16))
        elif line[:1] not in b"$":
            column = b""
    return found if len(set(found)) == len(found) else None


def _parted(line: bytes, width: int) -> bytes:
    """Return a line with a blank behind each of its fields, which touch where numbers are negative."""
    return b" ".join([line[:8], *(line[at : at + width] for at in range(8, 72, width))])


def _punch_judge(original: bytes, mutant: bytes) -> bool:
    """Judge entries that nothing counts, each of a column of a matrix."""
    entries = [_entries(content) for content in (original, mutant)]
    if entries[0] is None or entries[1] is None:
        return False
    known = set(entries[0])
    return all(
        any(undetectable.number_for_number(one, two) for one in entries[0])
        for two in entries[1]
        if two not in known
    )


def _nodes_judge(original: bytes, mutant: bytes) -> bool:
    """Judge a table of nodes whose names of sets, below the heading, are words for the user alone."""
    return undetectable.cells(*(_SETS.sub(rb"\1", content) for content in (original, mutant)))


_SETS = re.compile(rb"(?<=\n)((?:[^,\n]*,){3}[^,\n]*),.*")
"""A line of a table of nodes below the first, and what is in front of its names of sets."""


def _other_exponents(content: bytes) -> bytes:
    """Return a punch with E in place of D before exponents, where there is one."""
    return re.sub(rb"(?<=\d)D(?=[+-]\d)", b"E", content)


def labelled_families() -> list[Family]:
    """Return the families of Abaqus' matrices and of Nastran's punches."""
    k, m = beam_matrices(ELEMENTS)
    nodes = written("a.csv", places)
    jobs = {
        STIFFNESS: written("a.mtx", functools.partial(abaqus, matrix=k, held=(0, 1))),
        MASS: written("a.mtx", functools.partial(abaqus, matrix=m)),
        NODES: nodes,
    }
    files = {PUNCH: written("a.pch", lambda path: punched(path, KAAX=k, MAAX=m)), NODES: nodes}
    table = functools.partial(
        Case, NODES, head=20, undetectable=_nodes_judge, plainly=undetectable.without_exponents
    )
    return [
        Family(
            "Abaqus",
            [
                Case(name, jobs, 60, _abaqus_judge, plainly=undetectable.without_exponents)
                for name in (STIFFNESS, MASS)
            ]
            + [table(jobs)],
            _read_abaqus,
        ),
        Family(
            "Nastran punch",
            [Case(PUNCH, files, 220, _punch_judge, plainly=_other_exponents), table(files)],
            _read_punch,
        ),
    ]
