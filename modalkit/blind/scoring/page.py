"""The score as tables of words: what the command prints and the docs carry."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.scoring import (
    abstention,
    calibration,
    closing,
    levels,
    open_set,
    places,
    rates,
    severity,
)
from modalkit.blind.scoring.score import Score
from modalkit.blind.scoring.table import ALL, Rate
from modalkit.blind.scoring.wording import count_text, part_text, percent, share_text, value_text

Cell = tuple[str, Callable[[Rate], str]]
"""A question, and how its answer is written."""


@dataclass(frozen=True, eq=False)
class Section:
    """A table of words.

    Parameters
    ----------
    title, note : str
        What it shows, and how to read it.
    table : pandas.DataFrame
        Strings; the first column names the row.
    """

    title: str
    note: str
    table: pd.DataFrame


def sections(score: Score) -> tuple[Section, ...]:
    """Return the score as tables of words, what matters first.

    Parameters
    ----------
    score : Score
        Of a blind run.

    Returns
    -------
    tuple of Section
        Those with an answer.
    """
    return tuple(section for make in _MAKERS if len((section := make(score)).table))


def _words(rows: Iterable[dict[str, Any]]) -> pd.DataFrame:
    return pd.DataFrame(list(rows)).astype(str)


def _shares(label: str, rows: Iterable[tuple[str, Rate]]) -> pd.DataFrame:
    """Return label, share with interval and count of every row of which something was asked."""
    return _words(
        {label: name, "share (95 %)": share_text(row), "count": count_text(row)}
        for name, row in rows
        if row.total
    )


def _grid(score: Score, label: str, groups: Iterable[str], columns: Mapping[str, Cell]) -> pd.DataFrame:
    """Return a row for each group, a column for each question."""
    return _words(
        {label: group}
        | {name: text(score.rates[question, group]) for name, (question, text) in columns.items()}
        for group in groups
    )


def _groups(score: Score, question: str) -> list[str]:
    """Return the groups that a question was asked of."""
    return [row.group for row in score.rates.of(question) if row.total]


def _count(row: Rate) -> str:
    return str(row.count)


def _total(row: Rate) -> str:
    return str(row.total)


def _per_cent(row: Rate) -> str:
    return "-" if np.isnan(row.rate) else f"{row.rate:.0f} %"


def _headline(score: Score) -> Section:
    n, trials = len(score.trials), score.trials
    seen, none = int(trials["visible"].sum()), int((trials["sort"] == "none").sum())
    hidden = f"{seen} effects that the data show, {n - seen - none} faint ones, {none} without any"
    note = f"{n} trials, seed {score.seed}: {hidden}"
    return Section(
        "What matters first", note, _shares("of the trials that ask it", rates.headline(score.rates).items())
    )


def _by_group(score: Score) -> Section:
    columns = {
        "trials": (rates.TOP, _total),
        "most probable": (rates.TOP, share_text),
        "up to the class": (rates.RIGHT, share_text),
        "class by its share": (rates.CREDIT, share_text),
    }
    groups = [row.group for row in score.rates.of(rates.TOP) if row.group != ALL]
    note = (
        "visible effects of the library, and none; a class by its share: the chance that one picked from it blindly "
        "is right"
    )
    title = "By severity, structure, baseline and absolute level"
    return Section(title, note, _grid(score, "", groups, columns))


def _by_effect(score: Score) -> Section:
    known = score.trials[score.trials["sort"].isin(["effect", "none"])]
    groups = [str(effect) for (_, effect), _ in known.groupby(["sort", "effect"])]
    columns: dict[str, Cell] = {
        "right (95 %)": (rates.TRUE_OF_SHOWN, share_text),
        "trials": ("effect: visible", _total),
    }
    columns |= {
        name: (f"effect: {name}", _count)
        for name in ("named right", "class with it", "wrong", "unknown", "none", "failed")
    }
    table = _grid(score, "hidden", groups, columns)
    table = table.assign(**{"taken for": [_others(score, group) for group in groups]})
    note = "counts of all trials; right: of those that the data show, up to the class"
    return Section("Effect by effect", note, table)


def _others(score: Score, effect: str, most: int = 2) -> str:
    """Return the answers most often given in its place, in shares of trials."""
    false = score.answers[(score.answers["hidden"] == effect) & ~score.answers["true"].astype(bool)]
    shares = false.groupby("answer")["share"].sum().sort_values(ascending=False)
    return ", ".join(f"{name} {value:.1f}" for name, value in shares.head(most).items() if value >= 0.5)


def _pairs(score: Score) -> Section:
    rows = [
        {"two effects at once": question.partition(": ")[2], "count": count_text(row)}
        for question in rates.pair_questions(score.trials)
        if (row := score.rates[question, ALL]).count
    ]
    return Section("Pairs", "visible pairs; one of the two alone is not a right answer", _words(rows))


def _unknowable(score: Score) -> Section:
    columns = {"honest (95 %)": (open_set.HONEST, share_text)}
    columns |= {name: (open_set.answer(name), _count) for name in open_set.ANSWERS}
    area = score.rates[open_set.AREA, ALL]
    note = (
        "1 - p of fit of the best row separates unknown from known effects with an area under the ROC of "
        f"{value_text(area)}, {area.total} trials; 0.5 is chance"
        if np.isfinite(area.rate)
        else ""
    )
    table = _grid(score, "hidden", _groups(score, open_set.HONEST), columns)
    return Section("Effects that the diagnosis cannot know", note, table)


def _taken_for(score: Score) -> Section:
    outside = score.answers[score.answers["sort"].isin(["outside", "left out"])]
    wrong = outside[~outside["true"].astype(bool) & ~outside["answer"].isin(["unknown", "none", "failed"])]
    shares = (
        wrong.groupby(["hidden", "answer"])["share"].sum().sort_values(ascending=False).head(8).reset_index()
    )
    rows = [
        {"hidden": hidden, "taken for": answer, "trials": f"{value:.1f}"}
        for hidden, answer, value in shares.itertuples(index=False)
        if value >= 0.5
    ]
    return Section("What they are taken for", "classes counted by their share", _words(rows))


def _abstention(score: Score) -> Section:
    parts = (("", abstention.KNOWN), (", unknowable ones too", abstention.BOTH))
    asked = [(f"{t:g}", abstention.answered_from(t), abstention.right_from(t)) for t in abstention.THRESHOLDS]
    rows = []
    for name, answered, right in [
        *asked,
        ("the diagnosis's own rule", abstention.ANSWERED, abstention.RIGHT),
    ]:
        row = {"answer from a probability of": name}
        for which, group in parts:
            row[f"answered{which}"] = part_text(score.rates[answered, group].rate)
            row[f"right{which}"] = share_text(score.rates[right, group])
        rows.append(row)
    area, both = (value_text(score.rates[abstention.AREA, group]) for _, group in parts)
    note = f"area under the curve {area}; with what cannot be known {both}; 1 is perfect"
    return Section("What is answered against how often it is right", note, _words(rows))


def _calibration(score: Score) -> Section:
    measures = (calibration.BRIER, calibration.LOG, calibration.ERROR, calibration.BIAS)
    columns: dict[str, Cell] = {"trials": (calibration.BRIER, _total)}
    columns |= {name: (name, partial(value_text, digits=2)) for name in measures}
    bins = [
        f"{row.group}: {percent(row.rate)} % ({count_text(row)})"
        for row in score.rates.of(calibration.CAME_TRUE)
    ]
    note = "the first set's probability, and how often it is true: " + "; ".join(bins)
    table = _grid(score, "of", _groups(score, calibration.BRIER), columns)
    return Section("Calibration of the probabilities", note, table)


def _cover(score: Score) -> Section:
    columns = {
        "holds the truth (95 %)": (calibration.HOLDS, share_text),
        "count": (calibration.HOLDS, count_text),
        "mean size": (calibration.MEAN_SIZE, value_text),
    }
    sizes = [*(calibration.of_size(n) for n in calibration.SIZES), calibration.OVER]
    groups = _groups(score, calibration.HOLDS)
    table = _grid(score, "set", groups, columns)
    counts = [", ".join(str(score.rates[size, group].count) for size in sizes) for group in groups]
    return Section("The 95 % set", "", table.assign(**{"of size 1, 2, 3, 4, 5, more": counts}))


def _severity(score: Score) -> Section:
    columns: dict[str, Cell] = {
        "median error [%]": (severity.ERROR, partial(value_text, scale=100, digits=2)),
        "bias [%]": (severity.BIAS, lambda row: f"{100 * row.rate:+.1f}"),
        "inside its 95 % interval": (severity.INSIDE, share_text),
        "count": (severity.INSIDE, count_text),
    }
    groups = [row.group for row in score.rates.of(severity.INSIDE)]
    note = "where the answer holds the effect; errors relative to the true value"
    return Section("How strong", note, _grid(score, "parameter", groups, columns))


def _places(score: Score) -> Section:
    median = partial(value_text, scale=100, digits=2)
    columns: dict[str, Cell] = {
        "nearest place, median error [% of span]": (places.NEAREST_ERROR, median),
        "first place": (places.FIRST_ERROR, median),
        "nearest within 5 %": (places.NEAREST, share_text),
        "count": (places.NEAREST, count_text),
        "first within 5 %": (places.FIRST, _count),
        "interval holds it": (places.INSIDE, count_text),
    }
    note = (
        "span: length of a beam, diagonal of a plate; on symmetric structures mirrored places are all offered"
    )
    return Section("Where", note, _grid(score, "effect", _groups(score, places.NEAREST), columns))


def _points(score: Score) -> Section:
    question = severity.SAME_POINTS
    columns = {question: (question, share_text), "count": (question, count_text)}
    table = _grid(score, "parameter", _groups(score, question), columns)
    return Section("Which points", "where the answer holds the effect", table)


def _channels(score: Score) -> Section:
    rows = ((row.group, row) for row in score.rates.of(places.CHANNEL))
    return Section("The channel", "visible effects of the library", _shares("channel", rows))


def _levels(score: Score) -> Section:
    columns = {
        "leading mechanism right": (levels.LEADING, share_text),
        "count": (levels.LEADING, count_text),
        "mechanism certain, right": (levels.CERTAIN, _count),
        "wrong": (levels.WRONG, _count),
        "story certain, right": (levels.STORY, _count),
        "wrong story": (levels.WRONG_STORY, _count),
    }
    note = (
        "effects that the data show; a mechanism is right in channel and, where the effect has one, place: within 5 % "
        "of the span or inside its interval"
    )
    return Section(
        "Mechanism and story", note, _grid(score, "trials", _groups(score, levels.LEADING), columns)
    )


def _closing(score: Score) -> Section:
    columns = {
        "|stated - true| [points of %]": (closing.MISSED, value_text),
        "stated": (closing.STATED, _per_cent),
        "true": (closing.TRUE, _per_cent),
        "above the band": (closing.BEYOND, _per_cent),
        "within 10 points": (closing.MET, share_text),
        "count": (closing.MET, count_text),
        "inside its 95 % interval": (closing.INSIDE, share_text),
    }
    note = "share of the gap that closes: as stated, and with the answer in the rig's own nominal body"
    table = _grid(score, "trials", _groups(score, closing.MET), columns)
    return Section("How far the gap closes", note, table)


def _silence(score: Score) -> Section:
    rows = [
        {"p-value below": row.group, "expected": f"{percent(level)} %", "share (95 %)": share_text(row)}
        | {"count": count_text(row)}
        for level, row in zip(calibration.LEVELS, score.rates.of(calibration.BELOW), strict=True)
        if row.total
    ]
    test = score.rates[calibration.UNIFORM, ALL]
    note = f"Kolmogorov-Smirnov test against a uniform distribution: p = {test.rate:.2g}" if rows else ""
    return Section("The p-value where nothing is hidden", note, _words(rows))


def _every(score: Score) -> Section:
    rows = ((question, score.rates[question, ALL]) for question in rates.questions(score.trials))
    return Section("Every question", "", _shares("of the trials that ask it", rows))


_MAKERS: tuple[Callable[[Score], Section], ...] = (
    _headline,
    _by_group,
    _by_effect,
    _pairs,
    _unknowable,
    _taken_for,
    _abstention,
    _calibration,
    _cover,
    _severity,
    _places,
    _points,
    _channels,
    _levels,
    _closing,
    _silence,
    _every,
)
