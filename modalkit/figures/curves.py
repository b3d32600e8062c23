"""FRFs of a test with those of models laid over them, as the papers show them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition.arrays import ComplexArray, FloatArray
from modalkit.figures.style import (
    BLUE,
    INK,
    MARGIN,
    ORANGE,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    heading,
    new_figure,
    place,
    tidy,
)

LOOKS = {
    "measured": {"color": INK, "linewidth": 2.0, "zorder": 3},
    "before": {"color": ORANGE, "linewidth": 1.1, "zorder": 2, "linestyle": (0, (4, 2))},
    "updated": {"color": BLUE, "linewidth": 1.3, "zorder": 4},
}
"""How a curve is drawn, by the part it plays."""


@dataclass(frozen=True, eq=False)
class Curve:
    """One FRF.

    Parameters
    ----------
    part : {"measured", "before", "updated"}
        The part it plays.
    label : str
        What the key calls it.
    values : (n_lines,) complex array
        The FRF [``unit`` of the panel].
    """

    part: str
    label: str
    values: ComplexArray


@dataclass(frozen=True, eq=False)
class Panel:
    """FRFs of one pair of points on the same lines.

    Parameters
    ----------
    title : str
        Which points.
    frequency : (n_lines,) array
        Lines [Hz].
    curves : tuple of Curve
        Measured one first.
    unit : str
        Unit of the FRFs.
    highest : float
        Phases are shown in the 360 degrees below this [deg].
    """

    title: str
    frequency: FloatArray
    curves: tuple[Curve, ...]
    unit: str
    highest: float = 225.0


def curves_figure(title: str, note: str, panels: Sequence[Panel]) -> Figure:
    """Draw magnitude and phase of FRFs, one panel under the other.

    Parameters
    ----------
    title, note : str
        What the figure states, and what stands behind it.
    panels : sequence of Panel
        Pairs of points.

    Returns
    -------
    Figure
    """
    head = caption_height(title, note) + 0.55
    tall, low, block = 2.4, 0.8, 4.25
    figure = new_figure(head + block * len(panels) - 0.15)
    caption(figure, title, note)
    left, width = MARGIN + 0.75, WIDTH - 2 * MARGIN - 0.75
    for i, panel in enumerate(panels):
        top = head + i * block
        heading(figure, MARGIN, top - 0.12, panel.title)
        size = place(figure, left, top, width, tall, name=f"magnitude {i}")
        turn = place(figure, left, top + tall + 0.12, width, low, name=f"phase {i}")
        _draw(size, turn, panel)
        if i == 0:
            size.legend(
                loc="lower right", bbox_to_anchor=(1.0, 1.02), ncols=3, frameon=False, fontsize=SMALL,
                handlelength=2.0, borderpad=0.0, borderaxespad=0.0,
            )  # fmt: skip
    return figure


def _draw(size: Axes, turn: Axes, panel: Panel) -> None:
    tidy(size, y=f"|H| [{panel.unit}]")
    tidy(turn, x="frequency [Hz]", y="phase [°]")
    size.set_yscale("log")
    for curve in panel.curves:
        evaluation = LOOKS[curve.part]
        magnitude = np.where(np.abs(curve.values) > 0, np.abs(curve.values), np.nan)
        size.plot(panel.frequency, magnitude, label=curve.label, **evaluation)  # type: ignore[arg-type]
        angle = panel.highest - np.mod(panel.highest - np.degrees(np.angle(curve.values)), 360.0)
        jump = np.append(np.abs(np.diff(angle)) > 180, False)
        turn.plot(panel.frequency, np.where(jump, np.nan, angle), **evaluation)  # type: ignore[arg-type]
    measured = np.abs(panel.curves[0].values)
    measured = measured[measured > 0]
    size.set_ylim(float(np.percentile(measured, 0.3)) / 3, float(measured.max()) * 4)
    turn.set_ylim(panel.highest - 365, panel.highest + 5)
    turn.set_yticks([t for t in (-180, 0, 180) if panel.highest - 360 <= t <= panel.highest])
    for axes in (size, turn):
        axes.set_xlim(float(panel.frequency[0]), float(panel.frequency[-1]))
    size.tick_params(labelbottom=False)
