"""Files of other programs and of our own that hold FRFs or modes: MATLAB's, and JSON of a schema."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import undetectable
from family import Case, Family
from scipy.io import savemat

from acquisition import layout_from, read_mat, read_modes

_LAYOUT = {"frequency": "f", "frfs": "test.H", "responses": ["1+Z", "2-Z"], "references": ["3+Z"]}
_OPTIONAL = (
    "frequency_sigma_hz", "damping_ratio", "damping_sigma", "sigma", "mpc", "scaled", "points_rejected", "hits",
    "window_decay_removed", "warnings",
)  # fmt: skip
"""Keys that a file may leave out."""


def _read_mat(path: Path) -> tuple[Any, Sequence[str]]:
    return read_mat(path, layout_from({"mat": _LAYOUT})), ()


def _mat(*, compressed: bool) -> bytes:
    values = np.arange(32.0).reshape(16, 2, 1) / 7.0
    plain = io.BytesIO()
    named = {"f": 0.5 * np.arange(16.0), "test": {"H": values + 1j * values**2}}
    savemat(plain, named, do_compression=compressed)
    content = plain.getvalue()
    return b"MATLAB 5.0 MAT-file".ljust(116) + content[116:]  # without the date


def _spans(content: bytes) -> list[tuple[int, int]]:
    """Return where numbers stand in binary in a file that is not packed, and the text of its header."""
    values = np.arange(32.0).reshape(16, 2, 1) / 7.0
    found = [(0, 116)]
    for part in (0.5 * np.arange(16.0), values, values**2):
        whole = part.astype("<f8").tobytes(order="F")
        at = content.find(whole)
        if at >= 0:
            found.append((at, at + len(whole)))
    return found


def _modes() -> bytes:
    modes = [
        {
            "frequency_hz": 10.5 * k, "frequency_sigma_hz": 0.01 * k, "damping_ratio": 0.01, "damping_sigma": 0.001,
            "shape": [
                {"node": n, "direction": 3, "re": k / n, "im": 0.25 * k, "sigma": 0.01 * n} for n in (1, 2, 3)
            ],
            "mpc": 0.99, "scaled": True,
        }
        for k in (1, 2, 3)
    ]  # fmt: skip
    document = {"schema": "modalkit.modes/1", "modes": modes, "hits": [], "warnings": []}
    return json.dumps(document, indent=1).encode() + b"\n"


def exchanged_families() -> list[Family]:
    """Return the families of MATLAB files and of modes as JSON."""
    packed, plain = _mat(compressed=True), _mat(compressed=False)
    judges = {
        "packed.mat": undetectable.payload([(0, 116)], len(packed), lambda a, b: False),
        "plain.mat": undetectable.payload(_spans(plain), len(plain), lambda a, b: False),
    }
    mats = [
        Case(name, {name: content}, 192, judges[name])
        for name, content in (("packed.mat", packed), ("plain.mat", plain))
    ]
    modes = Case("modes.json", {"modes.json": _modes()}, 200, undetectable.json_document(_OPTIONAL, "modes"))
    return [
        Family("MATLAB", mats, _read_mat),
        Family("modes as JSON", [modes], lambda path: (read_modes(path), ())),
    ]
