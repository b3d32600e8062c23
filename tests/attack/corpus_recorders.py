"""Files of recorders and of named arrays, and text as programs write it, with the layouts that read them."""

from __future__ import annotations

import functools
import io
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import undetectable
from family import Case, Family, written
from mutators import repacked
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from acquisition.columns import read_columns, read_frf_columns

COUNT = 24
FORCE = (30 * np.exp(-((np.arange(COUNT) - 4) ** 2) / 4.0)).round(4)
MOTION = np.sin(np.arange(COUNT) * 0.9).round(6)
COLUMNS = """[[column]]
name = "{0}"
quantity = "force"
unit = "N"
[[column]]
name = "{1}"
quantity = "acceleration"
unit = "g"
"""


def _tdms(path: Path) -> None:
    step = {"wf_increment": 1e-3, "unit_string": "N"}
    with TdmsWriter(path) as file:
        file.write_segment(
            [ChannelObject("hit", "force", FORCE, step), ChannelObject("hit", "acc", MOTION, step)]
        )


def _wav(bits: int) -> bytes:
    full, width = 2 ** (bits - 1) - 1, bits // 8
    numbers = np.round(np.stack([FORCE / 30, MOTION], axis=1) * full).ravel()
    body = b"".join(struct.pack("<i", int(v))[:width] for v in numbers)
    parts = b"fmt " + struct.pack("<IHHIIHH", 16, 1, 2, 4096, 4096 * 2 * width, 2 * width, bits)
    parts += b"data" + struct.pack("<I", len(body)) + body
    return b"RIFF" + struct.pack("<I", 4 + len(parts)) + b"WAVE" + parts


def _mat() -> bytes:
    plain = io.BytesIO()
    savemat(plain, {"fs": 1000.0, "force": FORCE, "acc": MOTION})
    return b"MATLAB 5.0 MAT-file".ljust(116) + plain.getvalue()[116:]


def _spans(content: bytes, *parts: np.ndarray) -> list[tuple[int, int]]:
    """Return where the bytes of arrays stand in a file."""
    found = ((content.find(raw), len(raw)) for raw in (part.tobytes() for part in parts))
    return [(at, at + size) for at, size in found if at >= 0]


def _read(path: Path) -> tuple[Any, Sequence[str]]:
    return read_columns(path, path.with_name(f"{path.name}.toml")), ()


def _case(name: str, content: bytes, layout: str, head: int, judge: undetectable.Judge, **more: Any) -> Case:
    return Case(name, {name: content, f"{name}.toml": layout.encode()}, head, judge, **more)


def _binary(name: str, content: bytes, layout: str, head: int, spans: Sequence[tuple[int, int]]) -> Case:
    judge = undetectable.payload(spans, len(content), lambda one, two: False)
    return _case(name, content, layout, head, judge, spans=spans)


def _wav_cases() -> list[Case]:
    layout = COLUMNS.format("Channel 1", "Channel 2").replace("unit", "scale = 30.0\nunit")
    rate = [(24, 28)]
    return [
        _binary(f"{bits}.wav", content, layout, 44, [*rate, (44, len(content))])
        for bits in (16, 24)
        for content in [_wav(bits)]
    ]


INTERLEAVED = (4, 5)
"""Bytes of a TDMS segment whose bits say in which order the samples stand: no other datum repeats them."""


TRAILED = (
    "Header Size:\t 2\nX-Axis size:\t24\n"
    + "".join(
        f"{k + 1}\t {0.25 * k:.6e}\t {f:.5e}\t {a:.5e}\n"
        for k, (f, a) in enumerate(zip(FORCE, MOTION, strict=True))
    )
    + "TagsBegin:\t \t \nOverLoad:\t \tFalse\nTagsEnd:\t \t \n"
)
TRAILED_LAYOUT = """frequency_column = 1
[[column]]
index = 2
quantity = "accelerance"
part = "real"
[[column]]
index = 3
quantity = "accelerance"
part = "imag"
"""


def recorder_families() -> list[Family]:
    """Return the families of recorders' files, named arrays, and text with words behind its numbers."""
    plain, rated = COLUMNS.format("force", "acc"), 'rate = "fs"\n' + COLUMNS.format("force", "acc")
    tdms, mat = written("a.tdms", _tdms), _mat()
    step = np.array(1e-3)
    scalar = np.array(1000.0)
    npz = repacked(written("a.npz", functools.partial(np.savez, fs=1000.0, force=FORCE, acc=MOTION)))

    def read_frfs(path: Path) -> tuple[Any, Sequence[str]]:
        return read_frf_columns(path, path.with_name(f"{path.name}.toml")), ()

    return [
        Family(
            "TDMS",
            [_binary("a.tdms", tdms, plain, 28, [INTERLEAVED, *_spans(tdms, FORCE, MOTION, step)])],
            _read,
        ),
        Family("WAV", _wav_cases(), _read),
        Family("numpy records", [_case("a.npz", npz, rated, 60, undetectable.archive)], _read),
        Family(
            "MATLAB records",
            [_binary("a.mat", mat, rated, 192, [(0, 116), *_spans(mat, FORCE, MOTION, scalar)])],
            _read,
        ),
        Family(
            "text with a trailer",
            [
                _case(
                    "trailed.txt",
                    TRAILED.encode(),
                    TRAILED_LAYOUT,
                    40,
                    undetectable.text(free=_words, rows=True, ends=True),
                )
            ],
            read_frfs,
        ),
    ]


def _words(number: int, line: bytes) -> bool:
    """Tell whether a line is one of words above or below the numbers."""
    return number < 2 or line[:1].isalpha()
