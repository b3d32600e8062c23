"""What a test separates: from what severity on, and by how many standard deviations."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from modalkit.planning import DesignForecast, Forecast
from modalkit.planning.family import Family
from modalkit.planning.forecast import Advice
from modalkit.planning.separability import NONE, SEEN, SURE
from modalkit.views.chart import Axis, Chart, Series
from modalkit.views.charts.matrix import matrix_chart


def separations_chart(found: Forecast, *, most: int | None = None) -> Chart:
    """Return how many standard deviations each effect is from each other, full colour where it is surely separated.

    Parameters
    ----------
    found : Forecast
        What was found.
    most : int, optional
        Of more effects only those that are seen and not surely named are there, at most so many.
    """
    now = found.now
    names = list(now.names) if most is None or len(now.names) <= most else _hard(now)[:most]
    columns = ["no effect", *names]
    sigma = now.matrix.loc[names, [NONE, *names]].to_numpy(float)
    written = ["" if math.isnan(v) else f"{v:.1f}" if v < 10 else "10+" for v in sigma.ravel()]
    pairs = now.shown_pairs
    count = f"{sum(v >= SEEN for v in pairs.values())} of {len(pairs)} pairs"
    title = f"{count} are {SEEN:g}σ apart or more"
    if pairs:
        least = min(pairs, key=lambda pair: pairs[pair])
        title += f"; {' and '.join(least)} are nearest, {pairs[least]:.1f}σ"
    text = (
        "Separation of each effect (row), at the severity asked about, from the nearest case of another (column), in "
        f"standard deviations; full colour from {SURE:g}σ."
    )
    return matrix_chart(
        "separations", title, text, np.minimum(sigma / SURE, 1.0), names, columns,
        axes=("effect", "against"), written=written, quantity="σ",
    )  # fmt: skip


def _hard(now: DesignForecast) -> list[str]:
    """Return the effects that are seen and not surely named, the least separated first."""
    hard = [name for name, one in now.outcomes.items() if one.kind in ("place", "edge", "class")]
    return sorted(hard, key=lambda name: now.limits[name].sigma)


def thresholds_chart(found: Forecast) -> Chart:
    """Return from what share of the severity asked about each effect is separated, now and as first advised."""
    limits = found.now.limits
    families = {one.curve.family.name: one.curve.family for one in found.now.found}
    names = sorted(limits, key=lambda n: limits[n].separated / limits[n].clear)
    shares = {n: (limits[n].seen / limits[n].clear, limits[n].separated / limits[n].clear) for n in names}
    rows = {n: i for i, n in enumerate(names)}
    series = []
    for k, (meaning, colour, hollow) in enumerate(
        (("seen from", "ink", True), ("separated from all others", "blue", False))
    ):
        known = [n for n in names if math.isfinite(shares[n][k]) and shares[n][k] > 0]
        text = [f"{n}\n{meaning} {100 * shares[n][k]:.3g} % of the severity asked about" for n in known]
        more = {"text": text, "hollow": hollow, "size": 4.5}
        at = [100 * shares[n][k] for n in known]
        series.append(Series(meaning, "points", at, [rows[n] for n in known], colour, more))
    best = found.advice[0] if found.advice and found.advice[0].worth > 0 else None
    if best is not None:
        series.append(_advised(best, rows))
    never = sum(not math.isfinite(shares[n][1]) for n in names)
    early = sum(shares[n][1] <= 1 for n in names)
    return Chart(
        "thresholds",
        f"{early} of {len(names)} effects are separated from all others at the severity asked about, "
        f"{never or 'none'} never",
        "Ring: seen; dot: separated from all others; dotted line: severity asked about, given on the right."
        + ("" if best is None else f" Green: {best.change.key} changed as advised."),
        Axis("severity, relative to that asked about [%]", log=True),
        Axis(names=tuple(names)),
        series,
        more={"lines": [100.0], "row": 22, "notes": [_asked(families[n]) for n in names]},
    )


def _advised(best: Advice, rows: Mapping[str, int]) -> Series:
    """Return from what severity on effects are separated once a test is changed as advised."""
    limits = {n: one for n, one in best.after.limits.items() if n in rows}
    shares = {n: 100 * one.separated / one.clear for n, one in limits.items()}
    known = {n: share for n, share in shares.items() if math.isfinite(share) and share > 0}
    text = [f"{n}\nwith the advice {share:.3g} % of the severity asked about" for n, share in known.items()]
    more = {"text": text, "symbol": "diamond", "size": 3.5}
    return Series("with the advice", "points", list(known.values()), [rows[n] for n in known], "green", more)


def _asked(family: Family) -> str:
    """Return what is asked about: of one at a place of its own, which its name states, the amount alone."""
    return family.amount(family.clear) if family.at else family.say(family.clear)
