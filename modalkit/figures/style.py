"""One hand for all figures: palette, sizes, and the few strokes that every panel shares."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from matplotlib.typing import ColorType

from acquisition.quantities import raised

WIDTH = 12.0
"""Width of a figure [in]; 1200 px at 100 dots per inch."""

INK = "#1c2430"
"""Text and axes."""
MUTED = "#667080"
"""Colour of secondary text."""
FAINT = "#a9b2bd"
"""What was, and what lost."""
GRID = "#e4e8ec"
"""Grid lines and noise bands."""
PALE, BAND = "#eef1f4", "#d5dbe1"
"""The band of the tolerances, and that of the noise."""
BLUE = "#0b6fb8"
"""The model, the fit, the answer."""
ORANGE = "#d9590a"
"""What is rejected, what is left, where the cause sits. Distinguished from blue by every kind of colour vision."""
GREEN = "#128a66"
"""A third series, where one is needed."""

NAMED = {
    "ink": INK, "muted": MUTED, "faint": FAINT, "pale": PALE, "band": BAND, "blue": BLUE, "orange": ORANGE,
    "green": GREEN, "red": "#c0263a", "clamp": MUTED,
}  # fmt: skip
"""Colours by the names that charts use."""

PROBABILITY = LinearSegmentedColormap.from_list("probability", ["#f3f6f9", "#9fc8e6", BLUE, "#073a66"])
"""White is 0, dark blue is 1."""

SIGNED = LinearSegmentedColormap.from_list("signed", ["#07497a", "#5fa5d3", "#f6f6f4", "#f0a067", "#a63c02"])
"""Blue is negative, orange positive."""

BREAKS = re.compile(r"(?<!\d) | (?![^\W\d]|%)")
"""Spaces at which a line may be broken: not those between a number and its unit."""

SMALL, TEXT, HEAD, TITLE = 10.0, 11.0, 12.5, 17.0
"""Font sizes [pt]."""


def new_figure(height: float, *, width: float = WIDTH) -> Figure:
    """Return an empty white figure that belongs to no window.

    Parameters
    ----------
    height, width : float
        Size [in].
    """
    return Figure(figsize=(width, height), dpi=100, facecolor="white")


def tidy(axes: Axes, *, x: str = "", y: str = "", grid: str = "both") -> Axes:
    """Give a panel thin axes, a thin grid behind the data, and its labels.

    Parameters
    ----------
    axes : Axes
        The panel.
    x, y : str
        Labels with their units.
    grid : {"both", "x", "y", ""}
        Which grid lines.
    """
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(FAINT)
        axes.spines[side].set_linewidth(0.8)
    axes.set_axisbelow(True)
    axes.grid(visible=False)
    if grid:
        axes.grid(visible=True, axis=grid, color=GRID, linewidth=0.8)  # type: ignore[arg-type]
    axes.tick_params(colors=FAINT, labelcolor=INK, labelsize=SMALL, width=0.8, length=3)
    axes.tick_params(which="minor", color=FAINT, width=0.6, length=1.5)
    axes.set_xlabel(raised(x), fontsize=TEXT, color=INK)
    axes.set_ylabel(raised(y), fontsize=TEXT, color=INK)
    return axes


def ink_on(colour: ColorType) -> str:
    """Return black or white for text on a cell: which has the greater contrast, 4.5 or more (WCAG 2.2)."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)]
    luminance = float(np.dot([0.2126, 0.7152, 0.0722], linear))
    return "black" if (luminance + 0.05) ** 2 > 1.05 * 0.05 else "white"


def bare(axes: Axes) -> Axes:
    """Take everything but the data from a panel."""
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)
    return axes


def head(axes: Axes, text: str, *, pad: float = 8.0) -> None:
    """Put a heading over the left end of a panel."""
    axes.set_title(text, loc="left", fontsize=HEAD, fontweight="bold", color=INK, pad=pad)


MARGIN = 0.35
"""White edge left and right [in]."""


def caption_height(title: str, note: str = "", *, width: float = WIDTH) -> float:
    """Return the height that :func:`caption` takes [in]."""
    return _lines(title, note, width)[-1][0] + 0.12


def caption(figure: Figure, title: str, note: str = "") -> None:
    """Write title and note at the top, broken into lines that fit.

    Parameters
    ----------
    figure : Figure
        The figure, at least as high as :func:`caption_height` requires.
    title, note : str
        The answer as a sentence, and what stands behind it.
    """
    width, height = figure.get_size_inches()
    for down, line, is_title in _lines(title, note, width):
        figure.text(
            MARGIN / width,
            1 - down / height,
            line,
            fontsize=TITLE if is_title else TEXT,
            fontweight="bold" if is_title else "normal",
            color=INK if is_title else MUTED,
            va="baseline",
            parse_math=False,
        )


def _lines(title: str, note: str, width: float) -> list[tuple[float, str, bool]]:
    """Break title and note into lines, each with its distance from the top [in]."""
    room = 72 * (width - 2 * MARGIN)
    down, lines = 0.16, []
    for text, size, is_title in ((title, TITLE, True), (note, TEXT, False)):
        for line in broken(text, room, size, weight="bold" if is_title else "normal"):
            down += 1.35 * size / 72
            lines.append((down, line, is_title))
        down += 0.06
    return lines


def place(figure: Figure, left: float, top: float, width: float, height: float, *, name: str = "") -> Axes:
    """Add a panel, its left and top edge counted from the figure's top left corner [in]."""
    across, down = figure.get_size_inches()
    box = (left / across, 1 - (top + height) / down, width / across, height / down)
    return figure.add_axes(box, label=name)


def heading(figure: Figure, left: float, base: float, text: str) -> None:
    """Write the heading of a panel, its left end and base line counted from the top left corner [in]."""
    across, down = figure.get_size_inches()
    figure.text(left / across, 1 - base / down, text, fontsize=HEAD, fontweight="bold", color=INK)


def text_width(text: str, size: float, *, weight: str = "normal") -> float:
    """Return the width of a line of text [pt]."""
    if not text.strip():
        return 0.0
    font = FontProperties(size=size, weight=weight)
    return float(text_to_path.get_text_width_height_descent(text, font, ismath=False)[0])


def broken(text: str, room: float, size: float, *, weight: str = "normal") -> list[str]:
    """Break a text into lines no wider than ``room`` [pt], never between a number and the word or sign after it."""
    lines: list[str] = []
    for word in filter(None, BREAKS.split(text)):
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and text_width(longer, size, weight=weight) <= room:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def shortened(text: str, room: float, size: float, *, weight: str = "normal") -> str:
    """Cut a text to ``room`` [pt], with an ellipsis where something was cut."""
    if text_width(text, size, weight=weight) <= room:
        return text
    kept = text
    while kept and text_width(kept + "…", size, weight=weight) > room:
        kept = kept[:-1]
    return kept.rstrip() + "…"


def grouped(places: Sequence[float], spacing: float) -> list[list[int]]:
    """Gather the indices of places that stand too close together to be labelled apart.

    Parameters
    ----------
    places : sequence of float, rising
        Where the labels would stand.
    spacing : float
        Least distance between the middles of two groups, in the same unit.
    """
    groups: list[list[int]] = []
    for i, place in enumerate(places):
        if groups and place - sum(places[j] for j in groups[-1]) / len(groups[-1]) < spacing:
            groups[-1].append(i)
        else:
            groups.append([i])
    return groups


def numbers(group: Sequence[int]) -> str:
    """Name the modes of a group, counted from 1: ``3`` or ``3–5``."""
    return f"{group[0] + 1}" if len(group) == 1 else f"{group[0] + 1}–{group[-1] + 1}"


def key(axes: Axes, indent: float, above: float = 0.0) -> None:
    """Put the key over a panel, where there are names, in as many lines as it needs.

    Parameters
    ----------
    axes : Axes
        The panel.
    indent : float
        How far left of the panel it begins [in].
    above : float
        How far over the panel it ends [in].
    """
    handles, labels = axes.get_legend_handles_labels()
    if not handles:
        return
    figure = axes.get_figure(root=True)
    assert figure is not None
    box, (across, down) = axes.get_position(), figure.get_size_inches()
    wide, tall = box.width * across, box.height * down
    names = list(dict.fromkeys(labels))
    legend = axes.legend(
        [handles[labels.index(name)] for name in names], names, loc="lower left", frameon=False, fontsize=SMALL,
        ncols=-(-len(names) // key_lines(names, wide + indent)), handletextpad=0.4, columnspacing=1.2, handlelength=1.4,
        bbox_to_anchor=(-(indent + 0.06) / wide, 1 + (above + 0.02) / tall), borderpad=0.1, borderaxespad=0.0,
        scatteryoffsets=[0.45],
    )  # fmt: skip
    for text in legend.get_texts():
        text.set_color(INK)


def key_lines(names: Sequence[str], room: float) -> int:
    """Return how many lines a key of these names needs in some width [in]."""
    gap = 0.17  # between two names; their signs take a quarter of an inch
    wide = [text_width(name, SMALL) / 72 + 0.25 + gap for name in names]
    return 1 if sum(wide) <= room + gap else -(-len(names) // max(1, int((room + gap) / max(wide))))
