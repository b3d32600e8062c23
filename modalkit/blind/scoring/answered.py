"""What was answered, as tables of words."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.scoring.abstention import Abstention
from modalkit.blind.scoring.score import Score
from modalkit.blind.scoring.section import Section, share_rows, words
from modalkit.blind.scoring.wording import part_text, percent, share_text, value_text

THRESHOLDS = (0.5, 0.8, 0.9, 0.95, 0.99, 0.999)
"""Probabilities from which one might answer [-]."""


def headline_section(score: Score) -> Section:
    """Return the numbers to read first."""
    n, trials = len(score.trials), score.trials
    seen, none = int(trials["visible"].sum()), int((trials["sort"] == "none").sum())
    hidden = f"{seen} effects that the data show, {n - seen - none} faint ones, {none} without any"
    note = f"{n} trials, seed {score.seed}: {hidden}"
    return Section("What matters first", note, words(share_rows("of the trials that ask it", score.headline)))


def groups_section(score: Score) -> Section:
    """Return how often it is right by severity, structure, baseline and level."""
    rows = [
        {"": f"{row['group']}: {_statement(row['value'])}", "trials": row["total"]}
        | {
            words: f"{percent(row[key])} % ({percent(row[f'{key} low95'])} to {percent(row[f'{key} high95'])})"
            for key, words in (
                ("top", "most probable"),
                ("right", "up to the class"),
                ("credit", "class by its share"),
            )
        }
        for _, row in score.groups.iterrows()
    ]
    note = (
        "visible effects of the library, and none; a class by its share: the chance that one picked from it blindly "
        "is right"
    )
    return Section("By severity, structure, baseline and absolute level", note, words(rows))


def _statement(value: str) -> str:
    return {"True": "yes", "False": "no"}.get(value, value)


def effects_section(score: Score) -> Section:
    """Return what became of each hidden effect."""
    table = score.effects[score.effects["sort"].isin(["effect", "none"])]
    note = "counts of all trials; right: of those that the data show, up to the class"
    return Section("Effect by effect", note, words(_effect(score, row) for _, row in table.iterrows()))


def _effect(score: Score, row: pd.Series) -> dict[str, Any]:
    counts = ("trials", "named right", "class with it", "wrong", "unknown", "none", "failed")
    return (
        {"hidden": row["effect"], "right (95 %)": share_text(row)}
        | {name: int(row[name]) for name in counts}
        | {"taken for": _others(score, str(row["effect"]))}
    )


def _others(score: Score, effect: str, most: int = 2) -> str:
    """Return the answers most often given in its place, in shares of trials."""
    false = score.answers[(score.answers["hidden"] == effect) & ~score.answers["true"].astype(bool)]
    shares = false.groupby("answer")["share"].sum().sort_values(ascending=False)
    return ", ".join(f"{name} {value:.1f}" for name, value in shares.head(most).items() if value >= 0.5)


def pairs_section(score: Score) -> Section:
    """Return what became of two effects at once."""
    among = score.trials[(score.trials["sort"] == "pair") & score.trials["visible"]]
    marks = {
        "the pair named alone": among["commits"] & among["holds"],
        "a class that holds it": among["holds"] & ~among["commits"],
        "another set named": among["commits"] & ~among["holds"],
        "a class without it": (among["verdict"] == "class") & ~among["holds"] & ~among["commits"],
        "unknown": among["verdict"] == "unknown",
        "none": among["verdict"] == "none",
        "failed": among["verdict"] == "failed",
    }
    total = len(among)
    rows = [
        {"two effects at once": k, "count": f"{int(v.sum())} of {total}"} for k, v in marks.items() if v.any()
    ]
    return Section("Pairs", "visible pairs; one of the two alone is no right answer", words(rows))


def unknowable_section(score: Score) -> Section:
    """Return what became of effects that cannot be known."""
    counts = ("unknown", "equivalent", "wrong name", "wrong class", "none", "failed")
    rows = [
        {"hidden": row["effect"], "honest (95 %)": share_text(row)} | {name: row[name] for name in counts}
        for _, row in score.open_set.effects.iterrows()
    ]
    area = score.open_set.area
    note = (
        f"1 - p of fit of the best row tells unknown from known effects with an area under the ROC of "
        f"{value_text(area)}, {area['total']} trials; 0.5 is chance"
        if area["total"] and np.isfinite(area["value"])
        else ""
    )
    return Section("Effects that the diagnosis cannot know", note, words(rows))


def taken_for_section(score: Score) -> Section:
    """Return what they were taken for."""
    outside = score.answers[score.answers["sort"].isin(["outside", "left out"])]
    wrong = outside[~outside["true"].astype(bool) & ~outside["answer"].isin(["unknown", "none", "failed"])]
    shares = (
        wrong.groupby(["hidden", "answer"])["share"].sum().sort_values(ascending=False).head(8).reset_index()
    )
    rows = [
        {"hidden": row["hidden"], "taken for": row["answer"], "trials": f"{row['share']:.1f}"}
        for _, row in shares[shares["share"] >= 0.5].iterrows()
    ]
    return Section("What they are taken for", "classes counted by their share", words(rows))


def abstention_section(score: Score) -> Section:
    """Return what is answered against how often it is right."""
    rows = []
    for t in THRESHOLDS:
        row: dict[str, Any] = {"answer from a probability of": f"{t:g}"}
        for which, part in (("", score.abstention), (", unknowable ones too", score.abstention_outside)):
            row |= _at(part, t, which)
        rows.append(row)
    rule = {"answer from a probability of": "the diagnosis's own rule"}
    for which, part in (("", score.abstention), (", unknowable ones too", score.abstention_outside)):
        rule |= {
            f"answered{which}": part_text(part.rule["answered"]),
            f"right{which}": share_text(part.rule),
        }
    area, both = score.abstention.area, score.abstention_outside.area
    note = (
        f"area under the curve {value_text(area)}; with what cannot be known {value_text(both)}; 1 is perfect"
    )
    return Section("What is answered against how often it is right", note, words([*rows, rule]))


def _at(part: Abstention, threshold: float, which: str) -> dict[str, str]:
    reached = part.curve[part.curve["threshold"] >= threshold]
    if reached.empty:
        return {f"answered{which}": "0 %", f"right{which}": "-"}
    row = reached.iloc[-1]
    right = share_text({"rate": row["right"], "low95": row["low95"], "high95": row["high95"]})
    return {f"answered{which}": part_text(row["answered"]), f"right{which}": right}


def rates_section(score: Score) -> Section:
    """Return every question."""
    return Section("Every question", "", words(share_rows("of the trials that ask it", score.rates)))
