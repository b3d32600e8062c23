"""How often: what is asked of all trials, of groups of them, and of each hidden effect."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from modalkit.blind.scoring.table import ALL, Rate, Rates, number, share

Questions = dict[str, tuple[pd.Series, pd.Series]]
"""Question to whether it is so, or the credit between 0 and 1, and the trials that are asked; both by trial."""

TOP = "most probable answer is the truth"
RIGHT = "answer is true (named, in the class, or none)"
CREDIT = "a class counted by its share"
GIVEN = "commits to one answer, trials without effect among them"
OUTSIDE, LEFT_OUT = "effect outside the library", "effect left out of the library"

TRUE_OF_SHOWN = "effect: true answer where the data show it"
SETS = "effect: mean number of sets in an answer"

HEADLINE = {
    TOP: (TOP, ALL),
    "true up to the class it gives": (RIGHT, ALL),
    "commits to one answer": ("commits to one answer", ALL),
    "right when it commits": ("right when it commits, effect of the library", ALL),
    "false alarm where nothing is hidden": ("false alarm on none", ALL),
    "outside the library: unknown, or an honest equivalent": (
        f"{OUTSIDE}: unknown or an honest equivalent",
        ALL,
    ),
    "outside the library: given a wrong name": (f"{OUTSIDE}: wrong name", ALL),
    "left out of the library: unknown, or an honest equivalent": (
        f"{LEFT_OUT}: unknown or an honest equivalent",
        ALL,
    ),
    "left out of the library: given a wrong name": (f"{LEFT_OUT}: wrong name", ALL),
    "set of 95 % holds the truth": ("set holds the truth", "smallest that holds 95 %, visible effects"),
    "parameter inside its 95 % interval": ("parameter inside its 95 % interval", ALL),
    "place within 5 % of the span": ("nearest place within 5 % of the span", "all held by the answer"),
}
"""The numbers to read first: how they are called, and the question and group that they are."""


def headline(rates: Rates) -> dict[str, Rate]:
    """Return the numbers to read first by name; those that nothing was asked of are left out."""
    found = {name: rates.get(*key) for name, key in HEADLINE.items()}
    return {name: row for name, row in found.items() if row is not None and row.total}


def asked(trials: pd.DataFrame) -> pd.Series:
    """Return the trials to which the library has an answer that the data can give: plain effects, pairs, and none."""
    return (trials["sort"].isin(["effect", "pair"]) & trials["visible"]) | (trials["sort"] == "none")


def unknowable(trials: pd.DataFrame) -> pd.Series:
    """Return the trials whose effect the diagnosis cannot know and the data show."""
    return trials["sort"].isin(["outside", "left out"]) & trials["visible"]


def questions(trials: pd.DataFrame) -> Questions:
    """Return how often answers are right, committed, false, and given at all.

    Parameters
    ----------
    trials : pandas.DataFrame
        As :func:`modalkit.blind.scoring.trials.trial_table` returns them.
    """
    return _about_known(trials) | _about_silence(trials) | _about_outside(trials)


def _about_known(trials: pd.DataFrame) -> Questions:
    with_answer, kind = asked(trials), trials["verdict"] == "class"
    seen = with_answer & (trials["sort"] != "none")
    answers = trials["verdict"].isin(["named", "class"])
    return {
        TOP: (trials["top"], with_answer),
        RIGHT: (trials["right"], with_answer),
        CREDIT: (trials["credit"], with_answer),
        f"{TOP}, one effect": (trials["top"], seen & (trials["sort"] == "effect")),
        f"{TOP}, a pair": (trials["top"], seen & (trials["sort"] == "pair")),
        "commits to one answer": (trials["commits"], seen),
        "right when it commits": (trials["holds"], trials["commits"]),
        "right when it commits, effect of the library": (trials["holds"], trials["commits"] & seen),
        "class holds the truth": (trials["holds"], kind & seen),
        "right when it names or gives a class": (trials["holds"], answers & seen),
    }


def _about_silence(trials: pd.DataFrame) -> Questions:
    seen = asked(trials) & (trials["sort"] != "none")
    none = trials["sort"] == "none"
    faint = trials["faint"]
    silent, unknown = trials["verdict"] == "none", trials["verdict"] == "unknown"
    return {
        "visible effect called none": (silent, seen),
        "visible effect called unknown": (unknown, seen),
        "faint effect: true answer or none": (trials["right"] | silent, faint),
        "faint effect called none": (silent, faint),
        "false alarm on none": (~trials["right"], none),
        "false name on none": (trials["commits"], none),
        "diagnosis failed": (trials["verdict"] == "failed", none | True),
    }


def _about_outside(trials: pd.DataFrame) -> Questions:
    asked_of: Questions = {}
    for sort, words in (("outside", OUTSIDE), ("left out", LEFT_OUT)):
        these = unknowable(trials) & (trials["sort"] == sort)
        wrong = ~trials["holds"]
        asked_of |= {
            f"{words}: unknown or an honest equivalent": (trials["right"], these),
            f"{words}: unknown": (trials["verdict"] == "unknown", these),
            f"{words}: wrong name": (trials["commits"] & wrong, these),
            f"{words}: wrong class": ((trials["verdict"] == "class") & ~trials["commits"] & wrong, these),
            f"{words}: called none": (trials["verdict"] == "none", these),
        }
    return asked_of


def pair_questions(trials: pd.DataFrame) -> Questions:
    """Return what became of two effects at once, where the data show both."""
    pairs = (trials["sort"] == "pair") & trials["visible"]
    commits, holds, verdict = trials["commits"], trials["holds"], trials["verdict"]
    marks = {
        "the pair named alone": commits & holds,
        "a class that holds it": holds & ~commits,
        "another set named": commits & ~holds,
        "a class without it": (verdict == "class") & ~holds & ~commits,
        "unknown": verdict == "unknown",
        "none": verdict == "none",
        "failed": verdict == "failed",
    }
    return {f"pair: {name}": (mark, pairs) for name, mark in marks.items()}


def rates(trials: pd.DataFrame) -> Iterator[Rate]:
    """Yield every question, of all trials that ask it."""
    for name, (hit, among) in (questions(trials) | pair_questions(trials)).items():
        yield share(name, ALL, hit, among)


def rates_by_group(trials: pd.DataFrame) -> Iterator[Rate]:
    """Yield how often right by level, kind of structure, baseline, and absolute level of the FRFs.

    Levels that hold faint effects count those that the data show.
    """
    kept = trials[asked(trials)]
    for column in ("level", "kind", "baseline", "calibrated"):
        for value in sorted(kept[column].unique(), key=str):
            some = kept[kept[column] == value]
            group = f"{column}: { {'True': 'yes', 'False': 'no'}.get(str(value), value) }"
            for question, mark in ((TOP, "top"), (RIGHT, "right"), (CREDIT, "credit"), (GIVEN, "commits")):
                yield share(question, group, some[mark])


def effect_group(sort: str, effect: str) -> str:
    """Return the group of the trials of an effect; the same one in the library and left out of it are two."""
    return f"{effect} ({sort})" if sort in ("outside", "left out") else effect


def rates_by_effect(trials: pd.DataFrame) -> Iterator[Rate]:
    """Yield what became of each hidden effect, in all of its trials."""
    for (sort, effect), some in trials.groupby(["sort", "effect"]):
        group = effect_group(str(sort), str(effect))
        for name, mark in _marks(some).items():
            yield share(f"effect: {name}", group, mark)
        yield share(TRUE_OF_SHOWN, group, some["right"], some["visible"] | (some["sort"] == "none"))
        answered = some["verdict"].isin(["named", "class"])
        yield number(SETS, group, some.loc[answered, "sets"].mean(), int(answered.sum()))


def _marks(some: pd.DataFrame) -> dict[str, pd.Series]:
    answered = some["verdict"].isin(["named", "class"])
    return {
        "visible": some["visible"],
        "top": some["top"],
        "right": some["right"],
        "credit": some["credit"],
        "named right": some["commits"] & some["holds"],
        "class with it": answered & ~some["commits"] & some["holds"],
        "wrong": answered & ~some["holds"],
        "unknown": some["verdict"] == "unknown",
        "none": some["verdict"] == "none",
        "failed": some["verdict"] == "failed",
    }
