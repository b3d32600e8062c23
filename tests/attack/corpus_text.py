"""Text: hits and FRFs in columns, LabVIEW files, their layouts, tables of modes and nodes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import undetectable
from family import Case, Family

from acquisition import read_modes
from acquisition.columns import read_columns, read_frf_columns
from updating.models.imported import read_table

HITS_LAYOUT = b"""time_column = "t"
[[column]]
name = "f"
quantity = "force"
node = 2
[[column]]
name = "a"
quantity = "acceleration"
unit = "g"
[nodes]
1 = [0.0, 0.0, 0.0]
2 = [0.5, 0.0, 0.0]
"""
RATE_LAYOUT = HITS_LAYOUT.replace(b'time_column = "t"', b"rate = 1000.0")
FRF_LAYOUT = b"""frequency_column = 0
[[column]]
index = 1
quantity = "accelerance"
part = "real"
[[column]]
index = 2
quantity = "accelerance"
part = "imag"
"""
LVM_LAYOUT = b"""[[column]]
name = "force"
quantity = "force"
[[column]]
name = "acc"
quantity = "acceleration"
"""


def _table(separator: str = ",", decimal: str = ".", heading: str = "t{0}f{0}a\n", lines: int = 20) -> bytes:
    time = np.arange(lines) * 1e-3
    rows = np.stack([time, 30 * np.exp(-((np.arange(lines) - 4) ** 2) / 4.0), np.sin(time * 900)]).T
    body = "\n".join(separator.join(f"{v:.6e}".replace(".", decimal) for v in row) for row in rows)
    return (heading.format(separator) + body + "\n").encode()


def _untimed(content: bytes) -> bytes:
    return b"\n".join(line.partition(b",")[2] for line in content.split(b"\n"))


def _lvm_words(number: int, line: bytes) -> bool:
    """Tell lines of numbers, and those of a header that say something of them, from all others."""
    known = (b"Chan", b"Samp", b"Y_Un", b"X_Di", b"Delta", b"***", b"Sep", b"Dec")
    return not line.strip().startswith((*(b"%d" % d for d in range(10)), b"-", b",", *known))


def _columns_family(
    read: Callable[[Path, Path], Any], layouts: dict[str, tuple[bytes, bytes]], name: str
) -> Family:
    cases = [
        Case(
            file,
            {file: content, f"{file}.toml": layout},
            content.index(b"\n") + 1,
            undetectable.text(
                free=_lvm_words
                if file.endswith("lvm")
                else lambda number, line, by=file[:3]: number == 0 and by == "frf",
                rows=b"rate" in layout or file.endswith("lvm"),
                outer=b"_column" in layout,
                ends=file in ("rate.csv", "a.lvm"),
                decimal=b"," if file in ("semicolon.csv", "a.lvm") else b".",
            ),
        )
        for file, (content, layout) in layouts.items()
    ]

    def reader(path: Path) -> tuple[Any, Sequence[str]]:
        return read(path, path.with_name(f"{path.name}.toml")), ()

    return Family(name, cases, reader)


LVM = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nMulti_Headings\tYes\n"
    "X_Columns\tOne\n***End_of_Header***\t\n\n"
)
LVM_SEGMENT = (
    "Channels\t2\nSamples\t8\t8\nY_Unit_Label\tg\tNewtons\nX_Dimension\tTime\tTime\n"
    "Delta_X\t1,0E-3\t1,0E-3\n***End_of_Header***\nX_Value\tacc\tforce\tComment\n"
)


def _lvm() -> bytes:
    parts = [LVM]
    for scale in (1.0, 1.5):
        rows = [f"{k * 1e-3:.3f}\t{np.sin(scale * k):.5f}\t{scale * k * k:.5f}" for k in range(8)]
        parts.append(LVM_SEGMENT + "\n".join(rows).replace(".", ",") + "\n\n")
    return "".join(parts).encode()


def _read_layout(path: Path) -> tuple[Any, Sequence[str]]:
    read = read_columns if path.stem == "hits" else read_frf_columns
    return read(path.with_suffix(".csv"), path), ()


def table_families() -> list[Family]:
    hits = {
        "comma.csv": (_table(), HITS_LAYOUT),
        "semicolon.csv": (_table(";", ","), HITS_LAYOUT),
        "tab.txt": (_table("\t"), HITS_LAYOUT),
        "rate.csv": (_untimed(_table()), RATE_LAYOUT),
    }
    frfs = {"frf.csv": (_table(), FRF_LAYOUT), "frf.txt": (_table("  "), FRF_LAYOUT)}
    lvm = {"a.lvm": (_lvm(), LVM_LAYOUT)}
    layouts = [
        Case(name, {name: content, "hits.csv": _table(), "frf.csv": _table()}, 60, undetectable.toml)
        for name, content in (("hits.toml", HITS_LAYOUT), ("frf.toml", FRF_LAYOUT))
    ]
    modes = b"# a beam\nfrequency,sigma,damping,damping_sigma,1+Z,2+Z\n" + b"".join(
        b"%.4f,%.4f,%.5f,%.6f,%.5f,%.5f\n" % (10.0 * k**2, 0.01 * k, 0.01, 0.0005, 1.0 / k, -0.5 * k)
        for k in (1, 2, 3)
    )
    nodes = b"node,x,y,z,direction,row\n" + b"".join(
        b"%d,%.3f,0.0,0.0,3,%s\n" % (k, 0.1 * k, b"%d" % k if k else b"") for k in range(8)
    )
    return [
        _columns_family(read_columns, hits, "hits as text"),
        _columns_family(read_frf_columns, frfs, "FRFs as text"),
        _columns_family(read_columns, lvm, "LabVIEW text"),
        Family("layout", layouts, _read_layout),
        Family(
            "modes table",
            [
                Case(
                    "modes.csv",
                    {"modes.csv": modes},
                    60,
                    undetectable.cells,
                    plainly=undetectable.without_exponents,
                )
            ],
            lambda path: (read_modes(path), ()),
        ),
        Family(
            "node table",
            [
                Case(
                    "nodes.csv",
                    {"nodes.csv": nodes},
                    30,
                    undetectable.cells,
                    plainly=undetectable.without_exponents,
                )
            ],
            lambda path: (read_table(path, 8), ()),
        ),
    ]
