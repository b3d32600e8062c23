"""Records in HDF5 files: as most programs write them, packed, and of the newer layout with checksums."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import undetectable
from corpus_recorders import COLUMNS, FORCE, MOTION
from family import Case, Family, written

from acquisition.columns import read_columns

NAMES = ("hits/force", "hits/acc")
LAYOUT = ('rate = "fs"\n' + COLUMNS.format(*NAMES)).encode()
RATE = np.array(1000.0)


def _file(path: Path, *, newer: bool = False, **options: Any) -> None:
    with h5py.File(path, "w", libver="latest" if newer else "earliest") as file:
        file.create_dataset("fs", data=RATE)
        for name, values in zip(NAMES, (FORCE, MOTION), strict=True):
            found = file.create_dataset(name, data=values, **options)
            found.attrs["units"] = "N" if name == NAMES[0] else "g"


def _spans(content: bytes) -> list[tuple[int, int]]:
    """Return where the bytes of arrays stand in a file that does not pack them."""
    found = ((content.find(raw), len(raw)) for raw in (part.tobytes() for part in (RATE, FORCE, MOTION)))
    return [(at, at + size) for at, size in found if at >= 0]


def _case(name: str, content: bytes) -> Case:
    spans = _spans(content)
    judge = undetectable.payload(spans, len(content), lambda one, two: False)
    return Case(name, {name: content, f"{name}.toml": LAYOUT}, 96, judge, spans=spans)


def _read(path: Path) -> tuple[Any, Sequence[str]]:
    return read_columns(path, path.with_name(f"{path.name}.toml")), ()


def hdf5_families() -> list[Family]:
    """Return the family of HDF5 files."""
    packed = {"chunks": (8,), "compression": "gzip", "shuffle": True, "fletcher32": True}
    files = {
        "plain.h5": {},
        "packed.h5": packed,
        "newer.h5": {"newer": True},
    }
    return [
        Family(
            "HDF5",
            [
                _case(name, written("a.h5", functools.partial(_file, **options)))
                for name, options in files.items()
            ],
            _read,
        )
    ]
