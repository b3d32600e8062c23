"""Universal files: hits, FRFs, modes and nodes, in text and binary."""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import undetectable
from family import Case, Family, written

from acquisition import Dof, FrfSet, Geometry, HammerTest, Hits, ModalData, write_uff
from modalkit.workflow.files import read_files

RNG = np.random.default_rng(13)


@functools.cache
def _hammer(samples: int = 24) -> HammerTest:
    pulse = np.exp(-0.5 * ((np.arange(samples) - 5) / 1.5) ** 2)
    points = tuple(
        Hits(
            Dof(n, 3),
            (Dof(1, 3), Dof(2, -1)),
            np.stack([pulse * 40, pulse * 30]),
            np.round(RNG.standard_normal((2, 2, samples)), 5),
        )
        for n in (1, 2)
    )
    return HammerTest(1024.0, points, "accelerance", 2.0, _geometry())


def _geometry() -> Geometry:
    return Geometry((1, 2, 3), np.array([[0.0, 0.0, 0.0], [0.25, 0.5, 0.0], [0.5, 0.0, 0.125]]))


@functools.cache
def _frfs(lines: int = 16) -> FrfSet:
    values = RNG.standard_normal((2, lines)) + 1j * RNG.standard_normal((2, lines))
    values[:, -1] = 0.0  # a record that ends in zeros hides a shift
    return FrfSet(
        np.arange(lines) * 0.5, np.round(values, 4), (Dof(1, 3), Dof(2, 3)), (Dof(3, 3), Dof(3, 3)),
        "accelerance", coherence=np.full((2, lines), 0.99), averages=np.array([3, 3]), geometry=_geometry(),
    )  # fmt: skip


@functools.cache
def _modal() -> ModalData:
    return ModalData(
        frequency=np.array([12.5, 31.25]), frequency_sigma=np.array([0.01, 0.02]),
        damping=np.array([0.01, 0.02]), damping_sigma=np.array([1e-4, 1e-4]),
        dofs=(Dof(1, 3), Dof(2, 3), Dof(3, 3)), shapes=RNG.standard_normal((3, 2)) + 0j, shape_sigma=None,
        scaled=True, geometry=_geometry(),
    )  # fmt: skip


_TITLES = {b"58": 5, b"58b": 5, b"151": 7, b"55": 5, b"82": 2}
"""Lines of each kind of data set that are titles, behind that of its number."""

_HEADERS = {b"58": 11, b"58b": 11, b"164": 1}
"""Lines of it that hold names beside numbers."""


def _payloads(content: bytes) -> list[tuple[int, int]]:
    """Return where the numbers of the sets 58b stand."""
    spans = []
    for found in re.finditer(rb"\n {0,4}58b[^\n]*", content):
        count = int(found.group()[1:].split()[4])
        start = found.end() + 1
        for _ in range(11):
            start = content.index(b"\n", start) + 1
        spans.append((start, start + count))
    return spans


def _uff(name: str, content: bytes) -> Case:
    judge = undetectable.universal(_TITLES, _HEADERS)
    spans = _payloads(content)
    seen = undetectable.payload(spans, len(content), judge) if spans else judge
    return Case(name, {name: content}, len(content) // 4, seen, spans)


def _read_uff(path: Path) -> tuple[Any, Sequence[str]]:
    content = read_files([path])
    odd = [f"{d.place}: {d.message}" for d in content.datasets if d.message or not d.ok]
    values = [content.tests, content.frfs, content.modal, content.geometry]
    return values, [*content.warnings, *odd]


NODES15 = """    -1
    15
         1         0         0         8  0.00000e+00  0.00000e+00  0.00000e+00
         2         0         0         8  2.50000e-01  5.00000e-01  0.00000e+00
         3         0         0         8  5.00000e-01  0.00000e+00  1.25000e-01
    -1
"""
LINES82 = """    -1
    82
         1         3         0
NONE
         1         2         3
    -1
"""


def uff_families() -> list[Family]:
    def make(form: Any, precision: Any, **what: Any) -> bytes:
        return written("a.uff", lambda path: write_uff(path, form=form, precision=precision, **what))

    text = [
        make("ascii", "double", tests=_hammer()),
        make("ascii", "double", frfs=_frfs()),
        make("ascii", "single", frfs=_frfs()),
    ]
    binary = [
        make("binary", "double", tests=_hammer()),
        make("binary", "double", frfs=_frfs()),
        make("binary", "single", frfs=_frfs()),
    ]
    modes = make("ascii", "double", modal=_modal())
    sets = [modes, modes + LINES82.encode(), (NODES15 + LINES82).encode() + text[1]]
    return [
        Family(name, [_uff(f"{i}.uff", content) for i, content in enumerate(contents)], _read_uff)
        for name, contents in (("UFF ASCII", text), ("UFF binary", binary), ("UFF modes and nodes", sets))
    ]
