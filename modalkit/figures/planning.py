"""What a test separates: from what severity on, and by how many sigma."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import InputError
from acquisition.arrays import FloatArray
from modalkit.figures.style import (
    BLUE,
    FAINT,
    GREEN,
    GRID,
    INK,
    MARGIN,
    MUTED,
    ORANGE,
    PROBABILITY,
    SMALL,
    TEXT,
    WIDTH,
    caption,
    caption_height,
    heading,
    new_figure,
    place,
    shortened,
    text_width,
    tidy,
)
from modalkit.planning import DesignForecast, Forecast
from modalkit.planning.family import Family
from modalkit.planning.separability import CLASS, NONE, SEEN

_ROW = 0.3
_WORDS = 3.7
_LEAST, _MOST = 0.01, 10.0
_FULL = 10.0
_MANY = 24


def planning_figure(found: Forecast) -> Figure:
    """Draw thresholds of every effect, now and once the first advice is followed, and the separations.

    Parameters
    ----------
    found : Forecast
        What was found.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If the test has no effects to separate.
    """
    now = found.now
    if len(now.names) < 2:
        raise InputError("the forecast has fewer than two effects to draw")
    pairs = list(now.shown_pairs.values())
    title = f"{sum(v >= SEEN for v in pairs)} of {len(pairs)} pairs of effects are separated by this test"
    best = found.advice[0] if found.advice and found.advice[0].worth > 0 else None
    note = f"forecast by {found.bench.basis}, including tolerances and all uncertainties"
    if best is not None:
        note += f"; green: {best.change.key} changed as advised"
    top = caption_height(title, note) + 0.45
    plain = {one.curve.family.name: _plain(one.curve.family) for one in now.found} | {NONE: NONE}
    left = MARGIN + 0.2 + max(text_width(text, SMALL) for text in plain.values()) / 72
    tall = _ROW * len(now.names)
    rows = _compared(now)
    names = [NONE, *rows]
    above = max(text_width(plain[n], SMALL) for n in names) / 72 + 0.2
    cell = min(0.5, (WIDTH - left - MARGIN) / len(names))
    matrix_top = top + tall + 1.05 + above
    figure = new_figure(matrix_top + _ROW * len(rows) + 0.35 if rows else top + tall + 0.75)
    caption(figure, title, note)
    heading(figure, MARGIN, top - 0.18, "From what severity on")
    _thresholds(
        place(figure, left, top, WIDTH - left - MARGIN - _WORDS, tall, name="thresholds"),
        now,
        None if best is None else best.after,
        plain,
    )
    if rows:
        which = "each effect" if len(rows) == len(now.names) else "each effect that is not surely named"
        what = f"Sigma between {which}, as strong as 1 above, and all that another can do"
        heading(figure, MARGIN, top + tall + 0.85, what)
        axes = place(figure, left, matrix_top, cell * len(names), _ROW * len(rows), name="separations")
        _separations(axes, now, names, plain)
    return figure


def _plain(family: Family) -> str:
    """Return a family's name with the effect in words, the names of the user's own model as they are."""
    return family.name.replace(family.cause, family.cause.replace("_", " "), 1)


def _compared(now: DesignForecast) -> list[str]:
    """Return the effects whose separations are drawn: all, of many those that are seen and not surely named."""
    if len(now.names) <= _MANY:
        return list(now.names)
    hard = [name for name, one in now.outcomes.items() if one.kind in ("place", "edge", "class")]
    return sorted(hard, key=lambda name: now.limits[name].sigma)[:_MANY]


def _thresholds(
    axes: Axes, now: DesignForecast, after: DesignForecast | None, plain: Mapping[str, str]
) -> None:
    """Draw a bar from the severity that is detected to the one that is separated, over the one asked about."""
    tidy(axes, x="severity over the one that is asked about (right) [-]", grid="x")
    axes.set_xscale("log")
    rows = np.arange(len(now.names))
    seen, known_test = _over_clear(now, "seen"), _over_clear(now, "separated")
    axes.hlines(rows, seen, known_test, color=FAINT, linewidth=5.0, zorder=2)
    axes.scatter(seen, rows, s=42, facecolor="white", edgecolor=BLUE, linewidth=1.4, zorder=3, label="seen")
    never = known_test >= _MOST
    axes.scatter(
        known_test[~never], rows[~never], s=46, color=BLUE, zorder=4, label="separated from all others"
    )
    axes.scatter(known_test[never], rows[never], s=46, marker=">", color=BLUE, zorder=4, clip_on=False)
    if after is not None:
        then = _over_clear(after, "separated")
        axes.scatter(
            then, rows + 0.28, s=30, marker="|", color=GREEN, linewidth=2.2, zorder=4, label="with the advice"
        )
    for row, one in enumerate(now.found):
        axes.annotate(
            shortened(_asked(one.curve.family), 72 * (_WORDS - 0.15), SMALL), (1, row),
            xycoords=("axes fraction", "data"), xytext=(10, 0), textcoords="offset points", va="center",
            fontsize=SMALL, color=MUTED, annotation_clip=False,
        )  # fmt: skip
    axes.axvline(1.0, color=INK, linewidth=0.8, zorder=1)
    axes.set_xlim(_LEAST * 0.9, _MOST)
    axes.set_yticks(rows, [plain[n] for n in now.names], fontsize=SMALL)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, fontsize=SMALL)


def _asked(family: Family) -> str:
    """Return what is asked about: of one at a place of its own, which its name states, the amount alone."""
    return family.amount(family.clear) if family.at else family.say(family.clear)


def _over_clear(evaluation: DesignForecast, name: str) -> FloatArray:
    """Return severities over those asked about, within the axes [-]."""
    each = [getattr(limit, name) / limit.clear for limit in evaluation.limits.values()]
    shown: FloatArray = np.clip(np.array(each, dtype=float), _LEAST, _MOST)
    return shown


def _separations(axes: Axes, now: DesignForecast, names: list[str], plain: Mapping[str, str]) -> None:
    values = now.matrix.loc[names[1:], names].to_numpy(float)
    axes.pcolormesh(
        np.clip(values, 0, _FULL),
        cmap=PROBABILITY,
        vmin=0,
        vmax=1.4 * _FULL,
        edgecolors="white",
        linewidth=1.0,
    )
    axes.invert_yaxis()
    for (i, j), value in np.ndenumerate(values):
        if np.isfinite(value):
            text = f"{value:.1f}" if value < 9.95 else f"{value:.0f}" if value < 1000 else ">999"
            weak = value < CLASS
            colour = ORANGE if weak else "white" if value > 0.7 * _FULL else INK
            axes.text(
                j + 0.5, i + 0.5, text, fontsize=SMALL, ha="center", va="center",
                color=colour, fontweight="bold" if weak else "normal",
            )  # fmt: skip
    axes.set_xticks(np.arange(len(names)) + 0.5, [plain[n] for n in names], rotation=90, fontsize=SMALL)
    axes.xaxis.tick_top()
    axes.set_yticks(np.arange(len(names) - 1) + 0.5, [plain[n] for n in names[1:]], fontsize=SMALL)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.set_facecolor(GRID)
    axes.tick_params(colors=INK, labelsize=min(SMALL, TEXT))
