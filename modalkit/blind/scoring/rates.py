"""How often: every question with its count, total, share and interval."""

from __future__ import annotations

import pandas as pd

from modalkit.blind.scoring.intervals import share

Questions = dict[str, tuple[pd.Series, pd.Series]]


def rate_table(questions: Questions) -> pd.DataFrame:
    """Return one row per question.

    Parameters
    ----------
    questions : mapping of str to (hit, among)
        Both by trial, bool, or ``hit`` a credit between 0 and 1.

    Returns
    -------
    pandas.DataFrame
        ``count``, ``total``, ``rate``, ``low95``, ``high95`` by question.
    """
    rows = {question: share(hit, among) for question, (hit, among) in questions.items()}
    table = pd.DataFrame.from_dict(
        rows, orient="index", columns=["count", "total", "rate", "low95", "high95"]
    )
    table.index.name = "question"
    return table


def rates(trials: pd.DataFrame) -> pd.DataFrame:
    """Return how often answers are right, committed, false, and given at all.

    Parameters
    ----------
    trials : pandas.DataFrame
        As :func:`modalkit.blind.scoring.trials.trial_table` returns them.
    """
    return rate_table(_about_known(trials) | _about_silence(trials) | _about_outside(trials))


def asked(trials: pd.DataFrame) -> pd.Series:
    """Return the trials to which the library has an answer that the data can give: plain effects, pairs, and none."""
    return (trials["sort"].isin(["effect", "pair"]) & trials["visible"]) | (trials["sort"] == "none")


def unknowable(trials: pd.DataFrame) -> pd.Series:
    """Return the trials whose effect the diagnosis cannot know and the data show."""
    return trials["sort"].isin(["outside", "left out"]) & trials["visible"]


def _about_known(trials: pd.DataFrame) -> Questions:
    with_answer, kind = asked(trials), trials["verdict"] == "class"
    seen = with_answer & (trials["sort"] != "none")
    answers = trials["verdict"].isin(["named", "class"])
    return {
        "most probable answer is the truth": (trials["top"], with_answer),
        "answer is true (named, in the class, or none)": (trials["right"], with_answer),
        "a class counted by its share": (trials["credit"], with_answer),
        "most probable answer is the truth, one effect": (trials["top"], seen & (trials["sort"] == "effect")),
        "most probable answer is the truth, a pair": (trials["top"], seen & (trials["sort"] == "pair")),
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
    questions: Questions = {}
    for sort, words in (
        ("outside", "effect outside the library"),
        ("left out", "effect left out of the library"),
    ):
        these = unknowable(trials) & (trials["sort"] == sort)
        questions |= {
            f"{words}: unknown or an honest equivalent": (trials["right"], these),
            f"{words}: unknown": (trials["verdict"] == "unknown", these),
            f"{words}: wrong name": (trials["commits"] & ~trials["holds"], these),
            f"{words}: wrong class": (
                (trials["verdict"] == "class") & ~trials["commits"] & ~trials["holds"],
                these,
            ),
            f"{words}: called none": (trials["verdict"] == "none", these),
        }
    return questions


def group_table(trials: pd.DataFrame) -> pd.DataFrame:
    """Return how often right by level, kind of structure, baseline, and absolute level of the FRFs.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.

    Returns
    -------
    pandas.DataFrame
        ``group``, ``value``, and for each of ``top`` (most probable answer), ``right`` (up to the class),
        ``credit`` (class by its share) and ``commits`` its share and interval, of the trials that
        :func:`asked` returns; levels that hold faint effects count those that the data show.
    """
    kept = trials[asked(trials)]
    rows = []
    for group in ("level", "kind", "baseline", "calibrated"):
        for value in sorted(kept[group].unique(), key=str):
            some = kept[kept[group] == value]
            row = {"group": group, "value": str(value), "total": len(some)}
            for column in ("top", "right", "credit", "commits"):
                part = share(some[column])
                row |= {
                    column: part["rate"],
                    f"{column} low95": part["low95"],
                    f"{column} high95": part["high95"],
                }
            rows.append(row)
    return pd.DataFrame(rows)


def effect_table(trials: pd.DataFrame) -> pd.DataFrame:
    """Return what became of each hidden effect.

    Parameters
    ----------
    trials : pandas.DataFrame
        One row per trial.

    Returns
    -------
    pandas.DataFrame
        By effect, all of its trials: counts of what is said, ``top``, ``right`` and ``credit`` with the share
        of ``right`` among the ``visible`` ones and its interval, and the mean size of a class.
    """
    answered = trials["verdict"].isin(["named", "class"])
    marks = pd.DataFrame(
        {
            "trials": 1,
            "visible": trials["visible"],
            "top": trials["top"],
            "right": trials["right"],
            "credit": trials["credit"],
            "named right": trials["commits"] & trials["holds"],
            "class with it": answered & ~trials["commits"] & trials["holds"],
            "wrong": answered & ~trials["holds"],
            "unknown": trials["verdict"] == "unknown",
            "none": trials["verdict"] == "none",
            "failed": trials["verdict"] == "failed",
        }
    )
    table = marks.groupby([trials["sort"], trials["effect"]]).sum()
    table = table.astype({name: int for name in table.columns if name != "credit"})
    due = trials[trials["visible"] | (trials["sort"] == "none")]
    shares = {key: share(some["right"]) for key, some in due.groupby(["sort", "effect"])}
    for name in ("rate", "low95", "high95"):
        table[name] = pd.Series({key: row[name] for key, row in shares.items()}, dtype=float)
    sizes = trials["sets"].where(answered).groupby([trials["sort"], trials["effect"]]).mean()
    return table.assign(**{"mean class size": sizes}).reset_index()
