"""Where: stated places against hidden ones, and the channel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.answer import Answer
from modalkit.blind.outcome import Outcome
from modalkit.blind.scoring.intervals import median
from modalkit.blind.scoring.judge import holds, label, sort_of
from modalkit.blind.scoring.severity import true_row
from modalkit.blind.scoring.table import ALL, Rate, measured, share
from modalkit.blind.trial import Truth

NEAR = 0.05
"""A place this close, as a share of the span, counts as found [-]."""

_CHANNELS: Mapping[str, tuple[str, ...]] = {
    "stiffness": (
        *(
            "E",
            "thickness",
            "section_scale",
            "taper",
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

_OUTSIDE: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("tip_spring", "cable", "breathing_crack", "loose_end"), ("stiffness",)),
    **dict.fromkeys(("initial_curvature", "thermal_prestress", "cavity", "skew_clamp"), ("stiffness",)),
    **dict.fromkeys(("rib", "step", "taper"), ("stiffness", "mass")),
    "dashpot": ("damping",),
    "density_gradient": ("mass",),
    **dict.fromkeys(("oblique_hits", "cross_axis"), ("measurement",)),
}
"""Channels of what the rig has under names of its own, and of what acts in two."""

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
    offered = np.array([place[:axes] for place in answer.locations], dtype=float)
    span = float(np.linalg.norm(truth.size))
    distance = np.linalg.norm(true[:, None] - offered[None], axis=2) / span
    start = [outcome.index, label(truth.effects), sort_of(truth)]
    near, first = float(distance.min(axis=1).mean()), float(distance[:, : len(true)].min(axis=1).mean())
    return [*start, near, first, len(offered), _covered(outcome), holds(answer, truth)]


def _covered(outcome: Outcome) -> bool | None:
    """Return whether every interval of a coordinate holds the true one."""
    own = true_row(outcome)
    if own is None:
        return None
    inside = [
        bool(e.low <= outcome.truth.parameters[name] <= e.high)
        for name, e in own.parameters.items()
        if name.split(".")[-1] in ("x", "y")
        and name in outcome.truth.parameters
        and np.isfinite(e.low + e.high)
    ]
    return all(inside) if inside else None


NEAREST, FIRST = "nearest place within 5 % of the span", "first place within 5 % of the span"
NEAREST_ERROR, FIRST_ERROR = "median error of the nearest place", "median error of the first place"
INSIDE = "place inside its 95 % intervals"
CHANNEL = "channel is right"


def place_errors(places: pd.DataFrame, rng: np.random.Generator) -> Iterator[Rate]:
    """Yield errors of place, as a share of the span: by effect, of all held by the answer, of what the library lacks.

    Parameters
    ----------
    places : pandas.DataFrame
        As :func:`place_table` returns it.
    rng : numpy.random.Generator
        For the intervals.
    """
    held = places[places["held"].astype(bool)]
    outside = places[~places["held"].astype(bool) & places["sort"].isin(["outside", "left out"])]
    groups = [
        ("all held by the answer", held),
        ("outside or left out, not named", outside),
        *held.groupby("effect"),
    ]
    for group, some in ((str(name), some) for name, some in groups if len(some)):
        for within, error, column in ((NEAREST, NEAREST_ERROR, "nearest"), (FIRST, FIRST_ERROR, "first")):
            values = some[column].to_numpy(float)
            yield share(within, group, values <= NEAR)
            yield measured(error, group, values, rng, statistic=median)
        yield share(INSIDE, group, some["covered"].dropna().astype(bool))


def channel_rates(outcomes: Sequence[Outcome], trials: pd.DataFrame) -> Iterator[Rate]:
    """Yield whether the channel is right, by true channel (of a pair: either one), for visible effects of the library.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Opened trials.
    trials : pandas.DataFrame
        One row per trial.
    """
    rows = []
    for outcome in outcomes:
        trial = trials.loc[outcome.index]
        if trial["sort"] not in ("effect", "pair") or not trial["visible"] or outcome.answer is None:
            continue
        own = sorted({_CHANNEL[name] for name in outcome.truth.effects if name in _CHANNEL})
        rows.append((" + ".join(own), outcome.answer.channel in channels(outcome.truth)))
    table = pd.DataFrame(rows, columns=["channel", "right"])
    for group, some in [(ALL, table), *table.groupby("channel")]:
        if len(some):
            yield share(CHANNEL, str(group), some["right"])


def channels_of(name: str) -> set[str]:
    """Return the channels in which an effect acts, of the library or of the rig; none of one that is not known."""
    return {*_OUTSIDE.get(name, ()), *filter(None, [_CHANNEL.get(name)])}


def channels(truth: Truth) -> set[str]:
    """Return the channels that are right: those of every accepted answer."""
    return {_CHANNEL[name] for names in truth.accepted for name in names if name in _CHANNEL}


def true_channels(truth: Truth) -> set[str]:
    """Return the channels in which what is hidden acts, those of every accepted answer among them."""
    return channels(truth).union(*map(channels_of, truth.effects))
