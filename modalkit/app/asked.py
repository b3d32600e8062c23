"""What a warning asks for: the key of the study that would answer it, with the value that it proposes."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

KEYS = {
    "exponential_window": ("test.exponential_window", "Decay of the window", "1/s"),
    "frf_window": ("test.frf_window", "Window of the FRFs", ""),
    "calibration": ("test.calibration", "Calibration, relative", ""),
    "repeatability": ("test.repeatability", "Repeatability, relative", ""),
    "position_sigma": ("test.position_sigma", "Sigma of positions", "m"),
    "shape_sigma": ("test.shape_sigma", "Sigma of shapes, relative", ""),
    "match_tolerance": ("test.match_tolerance", "Distance to nodes allowed", "m"),
    "units": ("model.units", "Units of the model's files", ""),
}
"""By the word that a warning has: where the key stands, its label, its unit."""

NUMBER = r"[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?"
DECAY = re.compile(rf"decays at ({NUMBER}) 1/s")
"""How a warning states the decay that it found."""

HIT = re.compile(r"--leave (\w+[+-][A-Z]+):(\d+)")
"""How a warning names a hit that is better left out."""


@dataclass(frozen=True)
class Asked:
    """A key that a warning asks for.

    Parameters
    ----------
    path, label, unit : str
        Where it stands, what it is called, its unit.
    proposed : str
        The value that the warning proposes; "" for none.
    """

    path: str
    label: str
    unit: str
    proposed: str


def asked_by(warning: str) -> list[Asked]:
    """Return the keys that a warning asks for; none where it only informs."""
    found = []
    for key, (path, label, unit) in KEYS.items():
        value = re.search(rf'\b{key} = (?:"([\w-]+)"|({NUMBER}))', warning)
        if value is not None or re.search(rf"\b(?:state|give|add|by|in) [^.;]*\b{key}\b", warning):
            found.append(Asked(path, label, unit, _proposed(key, warning, value)))
    return found


def _proposed(key: str, warning: str, value: re.Match[str] | None) -> str:
    if value is not None:
        return value[1] or value[2]
    decay = DECAY.search(warning) if key == "exponential_window" else None
    return "" if decay is None else decay[1]


def asks(warnings: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Return by warning what it asks for: ``keys``, and a ``hit`` to leave out as (point, number) or None."""
    found = {}
    for warning in warnings:
        keys, hit = asked_by(warning), HIT.search(warning)
        if keys or hit:
            found[str(warning)] = {
                "keys": [asdict(one) for one in keys],
                "hit": None if hit is None else (hit[1], int(hit[2])),
            }
    return found
