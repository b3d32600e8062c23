"""Where: places said against places hidden, and the channel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.answer import Answer
from modalkit.blind.outcome import Outcome
from modalkit.blind.scoring.intervals import bootstrap, share
from modalkit.blind.scoring.judge import holds, label, sort_of
from modalkit.blind.scoring.severity import true_row
from modalkit.blind.trial import Truth

NEAR = 0.05
"""A place this close, as a share of the span, counts as found [-]."""

_CHANNELS: Mapping[str, tuple[str, ...]] = {
    "stiffness": (
        *(
            "E",
            "thickness",
            "section_scale",
            "length",
            "clamp_rotation",
            "clamp_translation",
            "local_stiffness",
            "joint",
        ),
        *(
            "shear",
            "orthotropy",
            "axial_load",
            "joint_nonlinearity",
            "ground_spring",
            "suspension",
            "absorber",
        ),
    ),
    "mass": ("density", "sensor_mass", "lumped_mass", "local_mass", "fluid_added_mass"),
    "damping": ("fluid_damping", "damping_patch", "uniform_damping"),
    "measurement": (
        *(
            "exponential_window",
            "calibration_gain",
            "channel_gain",
            "time_delay",
            "polarity",
            "swapped_points",
            "position_error",
            "drift",
        ),
    ),
}
_CHANNEL = {effect: channel for channel, effects in _CHANNELS.items() for effect in effects}

_COLUMNS = ["trial", "effect", "sort", "nearest", "first", "places", "covered", "held"]


def place_table(outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return one row per trial whose effect sits at a place, where the diagnosis gave one.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.

    Returns
    -------
    pandas.DataFrame
        Error of the ``nearest`` of the places offered and of the ``first`` one, as a share of the span (length of a
        beam, diagonal of a plate) [-]; how many ``places`` were offered; whether the intervals of the coordinates
        ``covered`` the truth (None where none is given); whether the answer ``held`` the effect. Effects outside
        the library are among them. Where several places are hidden, the mean over them, and as many
        of those offered count as the first.
    """
    rows = [
        _row(o, o.answer) for o in outcomes if o.answer is not None and o.truth.places and o.answer.locations
    ]
    return pd.DataFrame(rows, columns=_COLUMNS)


def _row(outcome: Outcome, answer: Answer) -> list[Any]:
    truth = outcome.truth
    axes = len(truth.size)
    true = np.array([place[:axes] for place in truth.places], dtype=float)
    statement = np.array([place[:axes] for place in answer.locations], dtype=float)
    span = float(np.linalg.norm(truth.size))
    distance = np.linalg.norm(true[:, None] - statement[None], axis=2) / span
    start = [outcome.index, label(truth.effects), sort_of(truth)]
    near, first = float(distance.min(axis=1).mean()), float(distance[:, : len(true)].min(axis=1).mean())
    return [*start, near, first, len(statement), _covered(outcome), holds(answer, truth)]


def _covered(outcome: Outcome) -> bool | None:
    """Tell whether every interval of a coordinate holds the true one."""
    statement = true_row(outcome)
    if statement is None:
        return None
    inside = [
        bool(e.low <= outcome.truth.parameters[name] <= e.high)
        for name, e in statement.parameters.items()
        if name.split(".")[-1] in ("x", "y")
        and name in outcome.truth.parameters
        and np.isfinite(e.low + e.high)
    ]
    return all(inside) if inside else None


def place_summary(places: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return errors of place by effect, of all that the answer held, and of what the library lacks.

    Parameters
    ----------
    places : pandas.DataFrame
        As :func:`place_table` returns it.
    rng : numpy.random.Generator
        For the intervals.

    Returns
    -------
    pandas.DataFrame
        ``effect``; medians of both errors [-] with intervals; ``count`` of ``total`` whose nearest place is within
        5 % of the span, ``first_count`` those whose first place is; ``covered`` of ``intervals``.
    """
    held = places[places["held"].astype(bool)]
    outside = places[~places["held"].astype(bool) & places["sort"].isin(["outside", "left out"])]
    groups = [
        ("all held by the answer", held),
        ("outside or left out, not named", outside),
        *held.groupby("effect"),
    ]
    return pd.DataFrame([{"effect": name} | _summary(some, rng) for name, some in groups if len(some)])


def _summary(some: pd.DataFrame, rng: np.random.Generator) -> dict[str, Any]:
    row: dict[str, Any] = {}
    for which in ("nearest", "first"):
        middle = bootstrap(some[which].to_numpy(float), rng, statistic=lambda v: np.median(v, axis=1))
        row |= {f"{which}_median": middle["value"]}
        row |= {f"{which}_low95": middle["low95"], f"{which}_high95": middle["high95"]}
    covered = some["covered"].dropna().astype(bool)
    row |= share(some["nearest"] <= NEAR)
    return row | {
        "first_count": int((some["first"] <= NEAR).sum()),
        "covered": int(covered.sum()),
        "intervals": len(covered),
    }


def channel_table(outcomes: Sequence[Outcome], trials: pd.DataFrame) -> pd.DataFrame:
    """Return whether the channel is right, by true channel, for visible effects of the library.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.
    trials : pandas.DataFrame
        One row per trial.

    Returns
    -------
    pandas.DataFrame
        ``channel`` (of a pair: either one), ``count`` of ``total``, ``rate`` and its interval.
    """
    rows = []
    for outcome in outcomes:
        trial = trials.loc[outcome.index]
        if trial["sort"] not in ("effect", "pair") or not trial["visible"] or outcome.answer is None:
            continue
        own = sorted({_CHANNEL[name] for name in outcome.truth.effects if name in _CHANNEL})
        rows.append((" + ".join(own), outcome.answer.channel in channels(outcome.truth)))
    table = pd.DataFrame(rows, columns=["channel", "right"])
    groups = [("all", table), *table.groupby("channel")]
    return pd.DataFrame([{"channel": name} | share(some["right"]) for name, some in groups if len(some)])


def channels(truth: Truth) -> set[str]:
    """Return the channels that are right: those of every accepted answer."""
    return {_CHANNEL[name] for names in truth.accepted for name in names if name in _CHANNEL}
