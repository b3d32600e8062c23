"""Quantities as text: one rule for each kind, for every output.

Command line, summary, report, figures, tables of text and warnings all format what they computed here:

==================  ======================================================================  ========================
what                rule                                                                    example
==================  ======================================================================  ========================
a number            three significant digits; an exponent below 0.001 and from a million    ``12.5``, ``9350``
an estimate         value, unit and 95 % interval; a unit that keeps the largest of the     ``12.5 g (11.9 to 13.1)``
                    three at one or more, where there is a smaller one (g, mm, ms, us)
an error, a gap     per cent with two significant digits, from 10 % on three                ``0.29 %``, ``14.9 %``
a gap of all data   standard deviations with two significant digits                         ``2.3 sigma``
an uncertainty      of a value, relative: per cent with two significant digits              ``3.6 %``, ``120 %``
a forecast          two significant digits, from 100 on three                               ``23``, ``123``
a probability       per cent with a decimal below 10 and above 99, whole between;           ``3.4 %``, ``84 %``,
                    never a false 0 or 100                                                  ``> 99.9 %``
a p-value           two digits, one below 0.001; below 1e-15 only that                      ``p = 0.012``,
                                                                                            ``p < 1e-15``
a frequency         four significant digits, at most two decimals                           ``123.4 Hz``
a place             whole millimetres                                                       ``x = 120, y = 35 mm``
==================  ======================================================================  ========================

What was stated, and limits of bands and lines, are echoed as they are (``:g``), a column of a table has fixed decimals
under the unit in its heading, and a report of a fit gives values with six digits, to be computed with.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

MISSING = "–"
"""What stands for a number that is not finite."""

SMALLER = {"kg": (("g", 1e-3),), "m": (("mm", 1e-3),), "s": (("ms", 1e-3), ("us", 1e-6))}
"""Per unit the smaller ones with their size in it, the largest first."""

UNSPOKEN = frozenset({"", "-", "node"})
"""Units that are not written: of ratios and of numbers of nodes."""

EXPONENTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""How the characters of an exponent are raised."""

SMALLEST_P = 1e-15
"""Below it a p-value is not written out [-]: no distribution of noise is known that far into its tail, some 8 sigma."""


def number(value: float) -> str:
    """Return a number with three significant digits."""
    if not math.isfinite(value):
        return MISSING
    short = float(f"{value:.3g}") + 0.0
    return f"{value:.2e}" if short and not 1e-3 <= abs(short) < 1e6 else f"{short:.10g}"


def decimals(sigma: float) -> int | None:
    """Return how many decimals of a value its standard deviation determines; None where it determines none.

    The last decimal is that of the first digit of sigma, or of the second where the first is 1 or 2: rounding moves the
    value by a fifth of sigma at most.
    """
    if not math.isfinite(sigma) or sigma <= 0:
        return None
    mantissa, exponent = f"{sigma:.1e}".split("e")
    return max(-int(exponent) + (float(mantissa) < 3.0), 0)


def quantity(value: float, unit: str = "-") -> str:
    """Return a value [unit] in the unit that suits it: ``12.5 g``."""
    factor, handy = _handy(unit, value)
    return f"{number(value / factor)}{handy}"


def raised(text: str) -> str:
    """Return a text with the exponents of its units raised, for what is drawn: ``kg/m^3`` as ``kg/m³``."""
    return re.sub(r"\^(-?\d+)", lambda found: found[1].translate(EXPONENTS), text)


def estimate(value: float, unit: str, low: float, high: float, *, level: str = "") -> str:
    """Return a value with its interval [unit]: ``12.5 g (11.9 to 13.1)``, with its level ``(95 %: 11.9 to 13.1)``."""
    factor, handy = _handy(unit, value, low, high)
    interval = f"{number(low / factor)} to {number(high / factor)}"
    return f"{number(value / factor)}{handy} ({f'{level}: ' if level else ''}{interval})"


def _handy(unit: str, *values: float) -> tuple[float, str]:
    """Return the size of the unit to write values in, and how it is written behind them."""
    size = max(map(abs, values))
    chosen, factor = unit, 1.0
    for smaller, its_size in SMALLER.get(unit, ()):
        if 0 < size < factor:
            chosen, factor = smaller, its_size
    return factor, "" if chosen in UNSPOKEN else f" {chosen}"


def percent(value: float) -> str:
    """Return an error or a gap [%]."""
    return f"{_two_digits(value)} %" if math.isfinite(value) else MISSING


def sigmas(value: float) -> str:
    """Return a misfit [standard deviations]."""
    return f"{_two_digits(value, until=math.inf)} sigma" if math.isfinite(value) else MISSING


def uncertainty(value: float) -> str:
    """Return a relative standard deviation [-] in per cent."""
    return f"{_two_digits(100 * value, until=math.inf)} %" if math.isfinite(value) else MISSING


def severity(value: float) -> str:
    """Return the size of an effect in a forecast."""
    return _two_digits(value, until=100.0)


def _two_digits(value: float, *, until: float = 10.0) -> str:
    """Return two significant digits, from some size on three."""
    rounded = float(f"{value:.{2 if abs(value) < until else 3}g}") + 0.0
    return f"{rounded:.6g}" if rounded == 0 or 1e-3 <= abs(rounded) < 1e6 else f"{rounded:.3g}"


def closed(value: float, low: float, high: float) -> str:
    """Return a share with its interval [%], whole: ``85 % (80 to 90)``."""
    return f"{value:.0f} % ({low:.0f} to {high:.0f})"


def probability(value: float) -> str:
    """Return a probability [-] in per cent."""
    if not math.isfinite(value):
        return MISSING
    rounded = round(100 * value, 1)
    if rounded >= 100:
        return "> 99.9 %"
    if rounded <= 0:
        return "< 0.1 %"
    return f"{rounded:g} %" if rounded < 10 or rounded > 99 else f"{rounded:.0f} %"


def bare_p(value: float) -> str:
    """Return a p-value [-] without the letter, for a column that has it in its heading."""
    if value < SMALLEST_P:
        return f"< {SMALLEST_P:.0e}"
    return f"{value:.2g}" if value >= 1e-3 else f"{value:.0e}"


def p_value(value: float) -> str:
    """Return a p-value [-]: ``p = 0.012``."""
    return f"p {bare_p(value)}" if value < SMALLEST_P else f"p = {bare_p(value)}"


def hertz(value: float) -> str:
    """Return a frequency [Hz]."""
    return f"{bare_hertz(value)} Hz"


def bare_hertz(value: float) -> str:
    """Return a frequency [Hz] without its unit, for a list or a range that has it at its end."""
    return f"{value:.{2 if value < 99.995 else 1 if value < 999.95 else 0}f}"


def place(at: Sequence[float], *, plate: bool = False) -> str:
    """Return a place [m] in millimetres; on a beam, y and z are zero and left out.

    Parameters
    ----------
    at : (1 to 3,) sequence
        Coordinates [m].
    plate : bool
        Whether y counts though it is zero.
    """
    named = [
        f"{axis} = {1000 * v + 0.0:.0f}"
        for axis, v in zip("xyz", at, strict=False)
        if axis == "x" or v or (plate and axis == "y")
    ]
    return ", ".join(named) + " mm"
