"""Numbers of the score as an engineer reads them: a share never without its interval and its count."""

from __future__ import annotations

import math

from modalkit.blind.scoring.table import Rate

LEAST = 1e-4
"""What is smaller is written as 0."""


def percent(value: float) -> str:
    """Return a share as per cent, with a decimal where 0 or 100 would say too much."""
    if not math.isfinite(value):
        return "-"
    return f"{100 * value:.1f}" if 0 < value < 0.0095 or 0.9905 < value < 1 else f"{100 * value:.0f}"


def part_text(value: float) -> str:
    """Return a share without an interval, ``85 %``."""
    return f"{percent(value)} %" if math.isfinite(value) else "-"


def share_text(row: Rate) -> str:
    """Return a share with its interval, ``85 % (80 to 89)``; ``-`` where nothing was asked."""
    if not math.isfinite(row.rate):
        return "-"
    return f"{percent(row.rate)} % ({percent(row.low)} to {percent(row.high)})"


def count_text(row: Rate) -> str:
    """Return ``34 of 40``; a credit that is not a whole number has a decimal."""
    return f"{row.count:.{0 if float(row.count).is_integer() else 1}f} of {row.total}"


def value_text(row: Rate, *, scale: float = 1.0, digits: int = 3) -> str:
    """Return a value with its interval, ``0.042 (0.031 to 0.055)``, with some significant digits."""
    values = [scale * value for value in (row.rate, row.low, row.high)]
    if not math.isfinite(values[0]):
        return "-"
    middle, low, high = (f"{v:.{digits}g}" if abs(v) >= LEAST else "0" for v in values)
    return f"{middle} ({low} to {high})" if math.isfinite(values[1]) else middle
