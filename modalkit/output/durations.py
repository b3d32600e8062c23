"""Durations as text: one rule for the terminal and the app."""

from __future__ import annotations

MINUTE, HOUR = 60, 3600  # in seconds


def duration(seconds: float) -> str:
    """Return a duration [s]: ``40 s``, ``3 min 20 s``, ``1 h 12 min``."""
    whole = max(round(seconds), 0)
    if whole < MINUTE:
        return f"{whole} s"
    if whole < HOUR:
        return _two(whole // MINUTE, "min", whole % MINUTE, "s")
    minutes = round(whole / MINUTE)
    return _two(minutes // MINUTE, "h", minutes % MINUTE, "min")


def _two(large: int, unit: str, small: int, smaller: str) -> str:
    return f"{large} {unit} {small} {smaller}" if small else f"{large} {unit}"
