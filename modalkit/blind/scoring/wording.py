"""Numbers of the score as an engineer reads them: a share never without its interval and its count."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pandas as pd

Line = Mapping[str, Any] | pd.Series
"""A row of a table, or what says the same."""

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


def share_text(row: Line, prefix: str = "") -> str:
    """Return ``85 % (80 to 89)`` of a row with ``rate``, ``low95`` and ``high95``; ``-`` where nothing was asked."""
    rate, low, high = (float(row[prefix + key]) for key in ("rate", "low95", "high95"))
    return f"{percent(rate)} % ({percent(low)} to {percent(high)})" if math.isfinite(rate) else "-"


def count_text(row: Line, prefix: str = "") -> str:
    """Return ``34 of 40``; a credit that is no whole number has a decimal."""
    count = float(row[prefix + "count"])
    return (
        f"{count:.0f} of {int(row[prefix + 'total'])}"
        if count.is_integer()
        else f"{count:.1f} of {int(row[prefix + 'total'])}"
    )


def value_text(
    row: Line, key: str = "value", prefix: str = "", *, scale: float = 1.0, digits: int = 3
) -> str:
    """Return a value with its interval, ``0.042 (0.031 to 0.055)``, with some significant digits."""
    values = [scale * float(row[name]) for name in (key, f"{prefix}low95", f"{prefix}high95")]
    if not math.isfinite(values[0]):
        return "-"
    middle, low, high = (f"{v:.{digits}g}" if abs(v) >= LEAST else "0" for v in values)
    return f"{middle} ({low} to {high})" if math.isfinite(values[1]) else middle
