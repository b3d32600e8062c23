"""How the parameters of an update moved, where they stand, and what became of the FRAC."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.display import counted
from modalkit.views.chart import Axis, Chart, Series
from updating.frf_update import FrfUpdate
from updating.update import Update

SHADES = ("blue", "orange", "green", "red", "ink", "muted")
"""Of lines in a panel; a seventh begins a panel of its own."""


def factors_chart(result: Update) -> Chart | None:
    """Return the factors on the nominal values; None where none is one."""
    known = [
        (name, p.factor, p.sigma * p.factor / p.value)
        for name, p in zip(result.names, result.parameters, strict=True)
        if p.factor is not None and p.value
    ]
    if not known:
        return None
    rows = np.arange(len(known))
    factor = np.array([f for _, f, _ in known], dtype=float)
    sigma = np.array([2 * s if np.isfinite(s) else 0.0 for _, _, s in known])
    text = [
        f"{name}\nfactor {f:.4f}" + (f" ± {s:.2g} (1σ)" if np.isfinite(s) else ", not determined by the data")
        for name, f, s in known
    ]
    far = int(np.argmax(np.abs(factor - 1)))
    change = f"{100 * (factor[far] - 1):+.3g} %".replace("-", "−")
    return Chart(
        "factors",
        f"{known[far][0]} moved by {change}"
        if len(known) == 1
        else f"{counted(len(known), 'factor')}; {known[far][0]} moved most, by {change}",
        "Over the nominal values, with two standard deviations. Dotted: 1, where they began.",
        Axis("factor on the nominal value [-]", range=_with_one(factor - sigma, factor + sigma)),
        Axis(names=tuple(name for name, _, _ in known)),
        [
            Series("2σ", "links", [], rows, "faint", {"low": factor - sigma, "high": factor + sigma}),
            Series("after the update", "points", factor, rows, "blue", {"text": text, "size": 5}),
        ],
        more={"lines": [1.0]},
    )


def _with_one(low: FloatArray, high: FloatArray) -> tuple[float, float]:
    """Return the ends of an axis on which all factors stand, and 1, where they began [-]."""
    ends = min(1.0, float(low.min())), max(1.0, float(high.max()))
    edge = 0.05 * max(ends[1] - ends[0], 1e-3)
    return ends[0] - edge, ends[1] + edge


def course_charts(result: Update) -> Iterator[Chart]:
    """Yield how the parameters moved, those of one unit together, six to a panel."""
    if len(result.history) < 2:
        return
    panels: dict[str, list[int]] = {}
    for i, p in enumerate(result.parameters):
        panels.setdefault("-" if p.relative else p.unit, []).append(i)
    number = 0
    steps = np.arange(len(result.history))
    for unit, members in panels.items():
        for k in range(0, len(members), len(SHADES)):
            number += 1
            part = members[k : k + len(SHADES)]
            names = [result.names[i] for i in part]
            lines = [
                Series(name, "line", steps, result.history[name].to_numpy(float), shade)
                for name, shade in zip(names, SHADES, strict=False)
            ]
            what = "factor [-]" if unit == "-" else f"value [{unit}]"
            yield Chart(
                f"course-{number}",
                f"{counted(len(names), 'parameter')} over {counted(result.iterations, 'iteration')}",
                f"{', '.join(names)}.",
                Axis("iteration"),
                Axis(what),
                lines,
                220.0,
            )


def frac_chart(result: FrfUpdate) -> Chart:
    """Return FRAC of every FRF before and after."""
    names = tuple(f"{r}/{f}" for r, f in zip(result.frac["response"], result.frac["force"], strict=True))
    rows = np.arange(len(names))
    before, after = (result.frac[name].to_numpy(float) for name in ("before", "after"))
    return Chart(
        "frac",
        f"{counted(len(names), 'FRF')}: mean FRAC {before.mean():.2f} before, {after.mean():.2f} after",
        "Rings: before the update; dots: after.",
        Axis("FRAC [-]", range=(0.0, 1.02)),
        Axis("response/force", names=names),
        [
            Series("", "links", [], rows, "faint", {"low": before, "high": after}),
            Series("before", "points", before, rows, "ink", {"hollow": True, "size": 4.5}),
            Series("after", "points", after, rows, "blue", {"size": 4.5}),
        ],
        more={"row": 20},
    )
