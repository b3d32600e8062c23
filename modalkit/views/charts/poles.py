"""The stabilisation chart: what became of every pole, and where every mode comes from."""

from __future__ import annotations

import numpy as np

from acquisition.display import counted
from identification import ModalModel
from identification.pole_reasons import Origins
from modalkit.views.chart import Axis, Chart, Series
from modalkit.views.charts.thin import extremes

KINDS = {
    "new": ("new at its order", "cross", "faint", 2.6),
    "short": ("chain too short", "dot", "faint", 2.6),
    "outside": ("outside the band", "up", "muted", 3.0),
    "pruned": ("rejected by the fit", "square", "orange", 3.0),
    "background": ("not determined by the data", "diamond", "orange", 3.0),
    "dropped": ("dropped by hand", "cross", "red", 4.0),
    "mode": ("a mode", "dot", "blue", 2.6),
}
"""What became of a pole: in words, and how it is drawn."""


ORIGINS = {
    "chain": ("mode from the chart", "down", "blue"),
    "refinement": ("mode added by the refinement", "diamond", "orange"),
    "named": ("mode picked by hand", "square", "green"),
}
"""Where a mode comes from, in the row above the orders."""


def poles_chart(model: ModalModel, origins: Origins, name: str = "poles") -> Chart:
    """Return every pole of every order with what became of it, and above them every mode with where it comes from."""
    chart = model.chart
    low, high = model.band
    edge = 0.02 * (high - low)
    near = (chart.frequency >= low - edge) & (chart.frequency <= high + edge)
    order = chart.orders[chart.level]
    kind = np.array([origins.reasons[r].kind for r in origins.chain], dtype=object)
    total = np.abs(model.frfs.values).sum(axis=0)
    keep = extremes(total, 600)  # lines of the curve behind the poles; doubled, it looks alike
    total = total[keep]
    series = [
        Series(
            f"Σ|H| [{model.frfs.unit}]",
            "line",
            model.frfs.frequency[keep],
            np.where(total > 0, total, np.nan),
            "faint",
            {"right": True},
        )
    ]
    for which, (meaning, symbol, colour, radius) in KINDS.items():
        rows = np.flatnonzero(near & (kind == which))
        text = [
            f"{chart.frequency[i]:.3f} Hz, damping {100 * chart.damping[i]:.3f} %, order {order[i]}\n"
            f"{origins.reasons[origins.chain[i]].text}"
            for i in rows
        ]
        more = {"text": text, "symbol": symbol, "size": radius}
        if len(rows):
            series.append(Series(meaning, "points", chart.frequency[rows], order[rows], colour, more))
    top = 1.06 * float(chart.orders.max())
    for which, (meaning, symbol, colour) in ORIGINS.items():
        modes = [r for r, origin in enumerate(origins.modes) if origin == which]
        hz = [float(model.modal.frequency[r]) for r in modes]
        text = [f"mode {r + 1}: {model.modal.frequency[r]:.3f} Hz\n{meaning}" for r in modes]
        more = {"text": text, "symbol": symbol, "size": 5}
        if modes:
            series.append(Series(meaning, "points", hz, [top] * len(hz), colour, more))
    return Chart(
        name,
        poles_title(origins, int(np.sum(near))),
        "All poles of all orders by their outcome; modes are marked at the top, with dotted lines.",
        Axis("frequency [Hz]", range=(low - edge, high + edge)),
        Axis("model order", range=(0.0, 1.04 * top)),
        series,
        360.0,
        more={"modes": [float(f) for f in model.modal.frequency]},
    )


def poles_title(origins: Origins, shown: int) -> str:
    """State how many modes there are and where they come from, and how many stable columns are none."""
    stable = sum(origin == "chain" for origin in origins.modes)
    parts = [f"{counted(len(origins.modes), 'mode')}: {stable} of {counted(shown, 'pole')}"]
    for origin, meaning in (("refinement", "added by the refinement"), ("named", "picked by hand")):
        if count := sum(o == origin for o in origins.modes):
            parts.append(f"{count} {meaning}")
    if len(parts) == 1:
        parts = [f"{counted(stable, 'mode')} of {counted(shown, 'pole')}"]
    left = sum(reason.kind in ("pruned", "background", "dropped") for reason in origins.reasons)
    if left:
        parts.append(f"{counted(left, 'stable column')} not taken")
    return "; ".join(parts)


def rejected_columns(model: ModalModel, origins: Origins) -> list[tuple[float, str]]:
    """Return frequency [Hz] and reason of every stable column in the band that is no mode, rising."""
    low, high = model.band
    found = []
    for chain, reason in enumerate(origins.reasons):
        if reason.kind in ("pruned", "background", "dropped"):
            middle = float(np.median(model.chart.frequency[origins.chain == chain]))
            if low <= middle <= high:
                found.append((middle, reason.text))
    return sorted(found)
