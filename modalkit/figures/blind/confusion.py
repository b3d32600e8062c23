"""What was hidden against what was answered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from acquisition import InputError
from acquisition.arrays import BoolArray, FloatArray
from modalkit.figures.style import (
    GREEN,
    INK,
    MARGIN,
    MUTED,
    PROBABILITY,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    ink_on,
    new_figure,
    place,
    text_width,
)

LAST = ("the pair", "other pair", "named nothing", "unknown", "none", "failed")
"""Answers that name no single effect, in the order of their columns."""

GROUPS = {
    "effect": "in the library",
    "pair": "two at once",
    "left out": "left out of the library",
    "outside": "not in the library",
    "none": "",
}
"""Kinds of rows, in their order."""


@dataclass(frozen=True, eq=False)
class Counts:
    """The matrix as it is drawn.

    Parameters
    ----------
    groups : list of str
        Kind of each row.
    rows, columns : list of str
        Names.
    trials : (n_rows, n_columns) array
        Shares of trials added up.
    right : (n_rows, n_columns) array of bool
        Which cells are true answers.
    """

    groups: list[str]
    rows: list[str]
    columns: list[str]
    trials: FloatArray
    right: BoolArray


def confusion_figure(answers: pd.DataFrame) -> Figure:
    """Draw what was hidden against what was answered, a class counted by the share of each of its sets.

    Parameters
    ----------
    answers : pandas.DataFrame
        ``sort`` (effect, pair, left out, outside, none), ``hidden``, ``answer``, ``share`` of a trial, ``true``.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there are no answers.
    """
    if answers.empty:
        raise InputError("the blind run has no trials to draw; run at least one")
    counts = gathered(answers)
    right, total = answers.loc[answers["true"].astype(bool), "share"].sum(), answers["share"].sum()
    title = f"{right:.0f} of {total:.0f} blind trials answered correctly, a class counted by its share"
    note = (
        "Rows: hidden effects; columns: answers. Dark: most of the row; green frames: right answers. A class divides "
        "its trial equally among its sets. Faint effects are included; for these, none is the best answer."
    )
    top = caption_height(title, note) + 0.12
    columns = [_plain(name) for name in counts.columns]
    left = MARGIN + 0.2 + max(text_width(_plain(name), SMALL) for name in counts.rows) / 72
    above = max(text_width(name, SMALL) for name in columns) / 72 + 0.15
    cell = min(0.42, (WIDTH - left - MARGIN - 0.75) / len(columns))
    at = _heights(counts.groups)
    tall = cell * (at[-1] + 1.0)
    figure = new_figure(top + above + tall + 0.25)
    caption(figure, title, note)
    axes = place(figure, left, top + above, cell * len(columns), tall, name="confusion")
    _cells(axes, counts, at, cell)
    axes.set_xticks(np.arange(len(columns)) + 0.5, columns, rotation=90, fontsize=SMALL, color=INK)
    axes.xaxis.tick_top()
    axes.set_yticks(at + 0.5, [_plain(name) for name in counts.rows], fontsize=SMALL, color=INK)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    return figure


def _plain(name: str) -> str:
    return name.replace("_", " ")


def gathered(answers: pd.DataFrame) -> Counts:
    """Return rows and columns in their order, all pairs as one row.

    Parameters
    ----------
    answers : pandas.DataFrame
        As for :func:`confusion_figure`.
    """
    table = answers.assign(true=answers["true"].astype(bool))
    pair = table["sort"] == "pair"
    double = table["answer"].str.contains(" + ", regex=False)
    table["row"] = table["hidden"].where(~pair, "pairs")
    table["column"] = (
        table["answer"].where(~double, "other pair").where(~(double & table["true"]), "the pair")
    )
    several = (table["sort"] == "left out") & table["hidden"].str.contains(" + ", regex=False)
    table.loc[several, "row"] = "pairs left out"
    keys = sorted(
        set(zip(table["sort"], table["row"], strict=True)), key=lambda k: (list(GROUPS).index(k[0]), k[1])
    )
    rows = [name for _, name in keys]
    columns = _columns(rows, table["column"].unique().tolist())
    trials, right = np.zeros((len(keys), len(columns))), np.zeros((len(keys), len(columns)), dtype=bool)
    where = (
        [keys.index(key) for key in zip(table["sort"], table["row"], strict=True)],
        [columns.index(name) for name in table["column"]],
    )
    np.add.at(trials, where, table["share"].to_numpy(float))
    np.logical_or.at(right, where, table["true"].to_numpy(bool))
    return Counts([sort for sort, _ in keys], rows, columns, trials, right | _always(keys, columns))


def _columns(rows: Sequence[str], names: Sequence[str]) -> list[str]:
    """Put effects in the order of the rows, then other names, then answers without a single name."""
    place = {name: i for i, name in enumerate(rows)}
    single = [name for name in names if name not in LAST]
    last = [name for name in LAST if name in set(names)]
    return [*sorted(single, key=lambda name: (place.get(name, len(rows)), name)), *last]


def _always(keys: Sequence[tuple[str, str]], columns: Sequence[str]) -> BoolArray:
    """Return the cells that are true whether or not they were answered."""
    own = {"effect": None, "pair": "the pair", "left out": "unknown", "outside": "unknown", "none": "none"}
    cells = [[(own[sort] or row) == column for column in columns] for sort, row in keys]
    return np.array(cells, dtype=bool).reshape(len(keys), len(columns))


def _heights(groups: Sequence[str]) -> FloatArray:
    """Return where each row begins, in cells, with space between two kinds."""
    # space between two kinds of rows, in cells
    step = [0.0, *(1.0 + 0.55 * (a != b) for a, b in pairwise(groups))]
    return np.cumsum(step)


def _cells(axes: Axes, counts: Counts, at: FloatArray, cell: float) -> None:
    total = counts.trials.sum(axis=1)
    size = min(SMALL, 26.0 * cell)
    down = [float(value) for value in at]
    for (i, j), count in np.ndenumerate(counts.trials):
        share = count / total[i]
        colour = PROBABILITY(share)
        axes.add_patch(Rectangle((j + 0.03, down[i] + 0.03), 0.94, 0.94, facecolor=colour, edgecolor="none"))
        if count >= 0.05:
            text = f"{count:.0f}" if abs(count - round(count)) < 0.05 or count >= 10 else f"{count:.1f}"
            axes.text(
                j + 0.5, down[i] + 0.52, text, fontsize=size, color=ink_on(colour), ha="center", va="center"
            )
        if counts.right[i, j]:
            frame = Rectangle(
                (j + 0.06, down[i] + 0.06), 0.88, 0.88, fill=False, edgecolor=GREEN, linewidth=1.5, zorder=4
            )
            axes.add_patch(frame)
    for i, n in enumerate(total):
        axes.text(
            len(counts.columns) + 0.25,
            down[i] + 0.52,
            f"of {n:.0f}",
            fontsize=SMALL,
            color=MUTED,
            ha="left",
            va="center",
        )
    axes.set_xlim(0, len(counts.columns))
    axes.set_ylim(down[-1] + 1.0, 0)
