"""Errors mode by mode, before and after, in the bands that noise and tolerances fill."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.display import counted
from acquisition.quantities import percent, sigmas
from modalkit.output.words import METRICS
from modalkit.views.chart import Axis, Chart, Series
from modalkit.views.mode_errors import ModeErrors
from updating import Diagnosis


def gap_chart(errors: ModeErrors, name: str = "gap", *, after: str = "after") -> Chart:
    """Return the error of every mode before and after, over the bands of noise and tolerances.

    Parameters
    ----------
    errors : ModeErrors
        Errors of one specimen.
    name : str
        Of the chart.
    after : str
        What the dots are.
    """
    rows = np.arange(len(errors.frequency))
    series = [
        _band("tolerances, 2σ", rows, errors.doubt, "pale", signed=errors.signed),
        _band("noise, 2σ", rows, errors.floor, "band", signed=errors.signed),
    ]
    if errors.after is not None:
        series.append(
            Series("", "links", None, rows, "faint", {"low": errors.before, "high": errors.after, "x": []})
        )
    series.append(_dots("unchanged model", rows, errors, errors.before, hollow=True))
    if errors.after is not None:
        series.append(_dots(after, rows, errors, errors.after))
    return Chart(
        name,
        gap_title(errors, after),
        _text(errors, after),
        Axis(errors.label, zero=not errors.signed),
        Axis(names=errors.names),
        [one for one in series if one is not None],
        more={"zero": True},
    )


def gap_title(errors: ModeErrors, after: str = "after") -> str:
    """State how many modes are outside their bands, before and after; without bands, how far they are off."""
    name = "all data" if errors.channel == "combined" else METRICS[errors.channel]
    quantity = f"{name[:1].upper()}{name[1:]} of {counted(len(errors.frequency), 'mode')}"
    band = errors.doubt if errors.doubt is not None else errors.floor
    if band is None:
        write = sigmas if errors.channel == "combined" else percent
        spans = [_span(v, write) for v in (errors.before, errors.after) if v is not None]
        return f"{quantity}: off by {spans[0]}" + (
            f" before, by {spans[1]} {after}" if len(spans) > 1 else ""
        )
    what = "noise and tolerances" if errors.doubt is not None else "noise"
    counts = [int(np.sum(np.abs(v) > band)) for v in (errors.before, errors.after) if v is not None]
    if len(counts) == 1:
        outside = "none" if not counts[0] else f"{counts[0]}"
        return f"{quantity}: {outside} outside the band of {what} (2σ)"
    return f"{quantity}: {counts[0]} outside the band of {what} (2σ) before, {counts[1] or 'none'} {after}"


def _span(values: FloatArray, write: Callable[[float], str]) -> str:
    """Return the smallest and the largest size."""
    known = np.abs(values[np.isfinite(values)])
    low, high = (write(float(v)) for v in (known.min(), known.max())) if len(known) else ("–", "–")
    return low if low == high else f"{low} to {high}"


def _text(errors: ModeErrors, after: str) -> str:
    bands = [
        name
        for name, band in (("dark band: noise", errors.floor), ("light: with the tolerances", errors.doubt))
        if band is not None
    ]
    dots = f"Rings: the unchanged model{f'; dots: {after}' if errors.after is not None else ''}"
    return f"{'; '.join([dots, *bands])}."


def _band(
    name: str, rows: np.ndarray, half: FloatArray | None, colour: str, *, signed: bool
) -> Series | None:
    if half is None:
        return None
    low = -half if signed else np.zeros_like(half)
    return Series(name, "bands", [], rows, colour, {"low": low, "high": half})


def _dots(
    name: str, rows: np.ndarray, errors: ModeErrors, values: FloatArray, *, hollow: bool = False
) -> Series:
    unit = "σ" if errors.channel == "combined" else "%"
    text = [
        "\n".join([f"mode {mode}", f"{name}: {_signed(v, unit, errors.signed)}", *_bands(errors, i)])
        for i, (mode, v) in enumerate(zip(errors.names, values, strict=True))
    ]
    more = {"text": text, "hollow": hollow, "size": 5}
    return Series(name, "points", values, rows, "ink" if hollow else "blue", more)


def _signed(value: float, unit: str, signed: bool) -> str:
    return f"{value:+.3f} {unit}".replace("-", "−") if signed else f"{value:.3f} {unit}"


def _bands(errors: ModeErrors, i: int) -> list[str]:
    """Return the widths of the bands of a mode in words."""
    known = [("noise", errors.floor), ("noise and tolerances", errors.doubt)]
    return [f"{name} 2σ: ±{band[i]:.3f} %" for name, band in known if band is not None]


def after_words(diagnosis: Diagnosis) -> str:
    """State what the dots of a diagnosis are."""
    return "with the best-fitting (rejected) explanation" if diagnosis.verdict == "unknown" else "after"
