"""The score of a blind run: how often it was right, whether probabilities come true, stated against true."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from acquisition import InputError
from acquisition.arrays import FloatArray
from acquisition.display import counted
from modalkit.blind.scoring.calibration import CAME_TRUE, ERROR, STATED
from modalkit.blind.scoring.closing import comparable
from modalkit.blind.scoring.open_set import AREA, detection, roc_curve
from modalkit.blind.scoring.rates import TRUE_OF_SHOWN, effect_group, headline
from modalkit.blind.scoring.score import Score
from modalkit.blind.scoring.table import ALL, Rate
from modalkit.blind.scoring.wording import percent
from modalkit.views.chart import Axis, Chart, Series, Sheet

SORTS = {
    "effect": ("in the library", "blue"),
    "none": ("none hidden", "green"),
    "left out": ("left out", "orange"),
    "outside": ("not in the library", "red"),
}
"""Kinds of what is hidden: what a key states of them, and their colours."""

WHOLE, EDGE = 100.0, 102.0
"""All of something, and where an axis ends on which it is to be seen [%]."""


def rates_sheet(score: Score) -> Sheet:
    """Return the first numbers of a score, and how often it is right effect by effect.

    Parameters
    ----------
    score : Score
        Of a blind run; effects of which nothing was asked are left out, and so are pairs, of which there are many.

    Raises
    ------
    InputError
        If nothing was asked at all.
    """
    asked = headline(score.rates)
    if not asked:
        raise InputError("the blind run has no rates to draw; run more trials")
    name, first = next(iter(asked.items()))
    charts = [_rates("rates", "Over all trials", list(asked), list(asked.values()), {"": ("", "blue")}, {})]
    if some := _by_effect(score):
        names = [effect.replace("_", " ") for _, effect, _ in some]
        sorts = {i: sort for i, (sort, _, _) in enumerate(some)}
        charts.append(_rates("effects", "Effect by effect", names, [row for *_, row in some], SORTS, sorts))
    return Sheet(
        f"{name[0].upper()}{name[1:]} in {_count(first)} blind trials",
        "Bars are 95 % intervals. Effects fainter than three standard deviations are left out. Effect by "
        "effect, an answer is right if it names the effect, gives a class that holds it, or is unknown where "
        "the library lacks the effect.",
        charts,
    )


def _by_effect(score: Score) -> list[tuple[str, str, Rate]]:
    """Return sort, effect and how often right, the best first, of what was asked of single effects."""
    pairs = score.trials[["sort", "effect"]].drop_duplicates().itertuples(index=False)
    found = [
        (sort, effect, score.rates[TRUE_OF_SHOWN, effect_group(sort, effect)])
        for sort, effect in pairs
        if " + " not in effect
    ]
    return sorted((one for one in found if one[2].total), key=lambda one: (one[0], -one[2].rate, one[1]))


def _count(row: Rate) -> str:
    return f"{row.count:.0f} of {row.total}"


def _rates(
    name: str, title: str, names: Sequence[str], table: Sequence[Rate], sorts: Mapping[str, tuple[str, str]],
    sort_of: Mapping[int, str],
) -> Chart:  # fmt: skip
    """Return rates as dots with their intervals, a row each."""
    rows = list(range(len(table)))
    rate, low, high = 100 * np.array([(row.rate, row.low, row.high) for row in table]).T
    series = [
        Series("", "bands", (), rows, "pale", {"low": [0.0] * len(rows), "high": [WHOLE] * len(rows)}),
        Series("", "bands", (), rows, "band", {"low": low, "high": high}),
    ]
    for sort, (words, colour) in sorts.items():
        if own := [i for i in rows if sort_of.get(i, "") == sort]:
            series.append(Series(words, "points", rate[own], own, colour))
    notes = [f"{percent(row.rate)} %   {_count(row)}" for row in table]
    return Chart(
        name, title, "", Axis("share of the trials asked [%]", range=(0.0, WHOLE)), Axis(names=tuple(names)), series,
        more={"row": 22, "notes": notes},
    )  # fmt: skip


def reliability_sheet(score: Score) -> Sheet:
    """Return how often a probability comes true, and how well the fit detects what is outside the library.

    Parameters
    ----------
    score : Score
        Of a blind run.

    Raises
    ------
    InputError
        If there are no probabilities.
    """
    bins = score.rates.of(CAME_TRUE)
    if not bins:
        raise InputError(
            "the blind run has no probabilities to compare with the truth; hide effects of the library"
        )
    stated = [100 * row.rate for row in score.rates.of(STATED)]
    rate, low, high = 100 * np.array([(row.rate, row.low, row.high) for row in bins]).T
    total = np.array([row.total for row in bins])
    text = [
        f"stated {p:.1f} %\ncame true {r:.1f} %, {_count(row)}"
        for p, r, row in zip(stated, rate, bins, strict=True)
    ]
    more = {"bottom": low, "top": high, "sizes": 3 + 7 * np.sqrt(total / total.max()), "text": text}
    reliability = Chart(
        "reliability", "Reliability", "", Axis("probability stated for the first set [%]", range=(0.0, EDGE)),
        Axis("came true [%]", range=(0.0, EDGE)),
        [_even(), Series("dots as large as their bins", "points", stated, rate, "blue", more)],
    )  # fmt: skip
    roc, area = roc_curve(*detection(score.trials).T), score.rates[AREA, ALL]
    series = [_even()]
    if not roc.empty and np.isfinite(area.rate):
        across, up = _steps(
            *(100 * np.append(0.0, roc[column].to_numpy(float)) for column in ("false", "found"))
        )
        words = f"area {area.rate:.2f} ({area.low:.2f} to {area.high:.2f})"
        series.append(Series(words, "line", across, up, "blue", {"width": 2.0}))
    detected = Chart(
        "roc", "Unknown separated from known by the fit", "",
        Axis("known effects called unknown [%]", range=(0.0, EDGE)),
        Axis("unknowable ones found [%]", range=(0.0, EDGE)), series,
    )  # fmt: skip
    return Sheet(
        _calibrated(score.rates.of(ERROR)),
        "Left: effects of the library that the data show, and none. Right: an effect counts as unknown if the best "
        "row fits badly; along the curve the limit moves.",
        [reliability, detected],
    )


def _calibrated(errors: Sequence[Rate]) -> str:
    row = next((row for row in errors if row.total), None)
    if row is None:
        return "Stated probabilities and how often they came true"
    value, low, high = (f"{100 * x:.1f}" for x in (row.rate, row.low, row.high))
    return f"Probabilities are off by {value} percentage points on average ({low} to {high})"


def _even(low: float = 0.0) -> Series:
    """Return the line on which one is as large as the other."""
    return Series("", "line", (low, WHOLE), (low, WHOLE), "faint")


def _steps(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a curve that keeps its height up to the next place."""
    return np.repeat(x, 2)[1:], np.repeat(y, 2)[:-1]


def closing_sheet(closing: pd.DataFrame, places: pd.DataFrame) -> Sheet:
    """Return the stated shrinkage against the true one, and the errors of place.

    Parameters
    ----------
    closing : pandas.DataFrame
        ``said``, ``low95``, ``high95``, ``true`` [%], ``metric``, ``true_metric``, ``held``.
    places : pandas.DataFrame
        ``nearest`` and ``first`` error [-], ``held``.

    Raises
    ------
    InputError
        If there is neither.
    """
    stated = comparable(closing)
    held = places[places["held"].astype(bool)]
    if stated.empty and held.empty:
        raise InputError(
            "no trial states how far its gap closes, or where the cause is; there is nothing to draw"
        )
    title = "How far the gap closes was not stated"
    if len(stated):
        distance = (stated["said"] - stated["true"]).abs()
        title = f"Stated and true shrinkage differ by {distance.mean():.1f} percentage points on average"
    return Sheet(
        title,
        "Left: share of the gap that closes; true: with the answer in the rig's own nominal body. Right: errors of "
        "place where the answer holds the effect, of the nearest of mirrored places and of the first one.",
        [_closing(stated), _places(held)],
    )


def _closing(stated: pd.DataFrame) -> Chart:
    low = 0.0
    if len(stated):
        low = float(min(stated["true"].quantile(0.02), stated["said"].quantile(0.02)))
        low = max(-100.0, min(0.0 if low < 60 else 50.0, 10 * np.floor(low / 10)))
    series = [_even(low)]
    right = stated["held"].astype(bool).to_numpy()
    for among, colour, words in (
        (right, "blue", "answer holds the effect"),
        (~right, "orange", "answer is false"),
    ):
        some = stated[among]
        x, y, bottom, top = (
            np.clip(some[name].to_numpy(float), low, WHOLE) for name in ("true", "said", "low95", "high95")
        )
        if len(some):
            text = [f"trial {trial}" for trial in some["trial"]]
            series.append(
                Series(words, "points", x, y, colour, {"bottom": bottom, "top": top, "size": 3, "text": text})
            )
    ends = (low, EDGE)
    return Chart(
        "closing", "How far the gap closes", "", Axis("true [%]", range=ends),
        Axis("stated, on data held out [%]", range=ends), series,
    )  # fmt: skip


def _places(held: pd.DataFrame) -> Chart:
    series = []
    for name, words, colour in (
        ("nearest", "nearest of those offered", "blue"),
        ("first", "the first", "orange"),
    ):
        error = np.sort(100 * held[name].to_numpy(float))
        if len(error):
            share = 100 * np.arange(len(error) + 1) / len(error)
            x, y = _steps(np.concatenate([[0.05], np.maximum(error, 0.05)]), share)
            series.append(
                Series(words, "line", np.append(x, WHOLE), np.append(y, WHOLE), colour, {"width": 2.0})
            )
    return Chart(
        "places", f"Where it sits, {counted(len(held), 'trial')}" if len(held) else "No place was stated", "",
        Axis("error of place [% of the span]", log=True, range=(0.1, WHOLE)),
        Axis("trials with less [%]", range=(0.0, EDGE)), series, more={"lines": [5.0]},
    )  # fmt: skip
