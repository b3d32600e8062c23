"""Before and after, mode by mode: the panel that updating and diagnosis share."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from acquisition.arrays import FloatArray
from acquisition.quantities import hertz
from modalkit.figures.style import BAND, BLUE, FAINT, INK, MUTED, PALE, SMALL, tidy


def dumbbells(
    axes: Axes,
    frequency: FloatArray,
    before: FloatArray,
    after: FloatArray | None = None,
    *,
    floor: FloatArray | None = None,
    doubt: FloatArray | None = None,
    signed: bool = True,
    label: str = "model against test [%]",
    indent: float = 0.95,
) -> None:
    """Draw one row per mode: where the error was, where it is now, and the band that noise alone fills.

    Parameters
    ----------
    axes : Axes
        The panel.
    frequency : (n_modes,) array
        Measured frequencies, for the names of the rows [Hz].
    before, after : (n_modes,) arrays
        Errors [%]; ``after`` may be left out.
    floor, doubt : (n_modes,) arrays, optional
        Half the width of the band that noise fills, and of that which noise and the tolerances fill [%].
    signed : bool
        Whether the errors have a sign; if not, the axis starts at 0.
    label : str
        Of the horizontal axis.
    indent : float
        How far left of the panel the key may begin [in].
    """
    rows = np.arange(len(frequency))
    tidy(axes, x=label, grid="x")
    axes.use_sticky_edges = False
    axes.axvline(0, color=MUTED, linewidth=0.9, zorder=1.2)
    for half, colour, name in ((doubt, PALE, "tolerances 2σ"), (floor, BAND, "noise 2σ")):
        if half is not None:
            band = np.nan_to_num(half)
            axes.barh(rows, 2 * band, left=-band, height=0.62, color=colour, label=name, zorder=1.1)
    if after is not None:
        axes.hlines(rows, before, after, color=FAINT, linewidth=2.2, zorder=2)
    _dots(axes, before, "before", size=52, face="white", edge=MUTED, line=1.6, zorder=3)
    if after is not None:
        _dots(axes, after, "after", size=58, face=BLUE, edge="white", line=0.8, zorder=4)
    axes.set_yticks(rows, [f"{i + 1}   {hertz(f)}" for i, f in enumerate(frequency)])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.margins(x=0.06)
    if not signed:
        axes.set_xlim(0)
    key(axes, indent)


def _dots(
    axes: Axes,
    values: FloatArray,
    label: str,
    *,
    size: float,
    face: str,
    edge: str,
    line: float,
    zorder: float,
) -> None:
    """Draw one dot per row."""
    axes.scatter(
        values, np.arange(len(values)), s=size, facecolor=face, edgecolor=edge, linewidth=line, label=label,
        zorder=zorder, clip_on=False,
    )  # fmt: skip


def key(axes: Axes, indent: float) -> None:
    """Put the key on one line between heading and panel, beginning ``indent`` [in] left of the panel."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    width = axes.get_position().width * figure.get_size_inches()[0]
    legend = axes.legend(
        loc="lower left",
        bbox_to_anchor=(-(indent + 0.06) / width, 0.985),
        ncols=4,
        frameon=False,
        fontsize=SMALL,
        handletextpad=0.3,
        columnspacing=1.2,
        handlelength=1.2,
        scatteryoffsets=[0.45],
        borderpad=0.1,
    )
    for text in legend.get_texts():
        text.set_color(INK)
