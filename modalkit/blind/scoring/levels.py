"""Both levels of an answer: the mechanism with its place, and the story."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from modalkit.blind.answer import Answer, Stated
from modalkit.blind.outcome import Outcome
from modalkit.blind.scoring.judge import commits, holds
from modalkit.blind.scoring.places import NEAR, true_channels
from modalkit.blind.scoring.table import ALL, Rate, share
from modalkit.blind.trial import Truth

LEADING = "mechanism that leads is right (channel, and place)"
CERTAIN = "mechanism is certain and right"
WRONG = "mechanism is certain and wrong"
STORY, WRONG_STORY = "story is certain and right", "story is certain and wrong"
"""Questions that are asked of effects that the data show."""

_COLUMNS = ["sort", "leading", "certain", "story", "right_story"]


def level_rates(outcomes: Sequence[Outcome], trials: pd.DataFrame) -> Iterator[Rate]:
    """Yield how often mechanism and story are right and wrong, by sort of trial, of effects that the data show.

    Answers that state no levels, as those of earlier versions, are not asked.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.
    trials : pandas.DataFrame
        One row per trial.
    """
    rows = [
        (trials.loc[o.index, "sort"], *_judged(o.answer, o.truth))
        for o in outcomes
        if o.answer is not None and o.answer.has_levels and o.truth.effects and trials.loc[o.index, "visible"]
    ]
    table = pd.DataFrame(rows, columns=_COLUMNS)
    for group, some in [(ALL, table), *table.groupby("sort")]:
        if not len(some):
            continue
        marks = some.drop(columns="sort").astype(bool)
        asked = {
            LEADING: marks["leading"],
            CERTAIN: marks["certain"] & marks["leading"],
            WRONG: marks["certain"] & ~marks["leading"],
            STORY: marks["story"] & marks["right_story"],
            WRONG_STORY: marks["story"] & ~marks["right_story"],
        }
        for question, hit in asked.items():
            yield share(question, str(group), hit)


def _judged(answer: Answer, truth: Truth) -> tuple[bool, bool, bool, bool]:
    leading = answer.mechanism is not None and mechanism_is_right(answer.mechanism, truth)
    return leading, bool(answer.level), commits(answer), holds(answer, truth)


def mechanism_is_right(stated: Stated, truth: Truth) -> bool:
    """Return whether a mechanism is that of what is hidden, of several effects that of one.

    It acts in the same channel. What sits at a place is found near it, or inside the interval; what is all over the
    structure, or at its supports, is not called local. Errors of the measurement need no place.
    """
    if stated.channel not in true_channels(truth):
        return False
    if stated.channel == "measurement":
        return True
    if not truth.places:
        return stated.extent != "local"
    if not stated.locations:
        return len(truth.effects) > 1
    return any(_there(stated, place, truth) for place in truth.places)


def _there(stated: Stated, place: Sequence[float], truth: Truth) -> bool:
    axes = min(len(truth.size), 2)
    span, at = float(np.linalg.norm(truth.size)), np.asarray(place[:axes])
    away = np.linalg.norm(np.array(stated.locations)[:, :axes] - at, axis=1)
    if away.min() <= NEAR * span:
        return True
    if stated.low is None or stated.high is None:
        return False
    return bool((np.array(stated.low[:axes]) <= at).all() and (at <= np.array(stated.high[:axes])).all())
