"""The complex mode indicator functions of FRFs."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from acquisition import FrfSet
from identification import cmif
from modalkit.figures.style import (
    BLUE,
    FAINT,
    INK,
    MARGIN,
    MUTED,
    ORANGE,
    WIDTH,
    caption,
    caption_height,
    new_figure,
    place,
    tidy,
)

COLOURS = (INK, ORANGE, BLUE, MUTED, FAINT)
"""Of the first function, the second, and so on."""

TALL = 3.6
"""Height of the panel [in]."""


def cmif_figure(frfs: FrfSet, *, band: tuple[float, float] | None = None, count: int = 4) -> Figure:
    """Draw the complex mode indicator functions.

    Parameters
    ----------
    frfs, band, count
        As of :func:`identification.cmif`.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If no response was measured with every reference.
    """
    table = cmif(frfs, band=band, count=min(count, len(COLOURS)))
    table = table[table.index > 0]
    few = table.shape[1] == 1
    title = "Complex mode indicator function" + ("" if few else "s")
    note = (
        "a peak is a mode; with one reference or response two close modes show as one"
        if few
        else "a peak of the first is a mode; one of the second at the same place is another mode beside it"
    )
    if left_out := table.attrs["left_out"]:
        note += f". Left out, as FRFs lack: {', '.join(left_out)}"
    top = caption_height(title, note) + 0.2
    figure = new_figure(top + TALL + 0.65)
    caption(figure, title, note)
    axes = place(figure, MARGIN + 0.8, top, WIDTH - 2 * MARGIN - 0.8, TALL, name="cmif")
    tidy(axes, x="frequency [Hz]", y=f"CMIF [({frfs.unit})²]")
    for number, (values, colour) in enumerate(zip(table.to_numpy().T, COLOURS, strict=False), start=1):
        axes.plot(table.index, values, color=colour, linewidth=1.4, label=str(number), zorder=9 - number)
    axes.set_yscale("log")
    axes.set_xlim(float(table.index[0]), float(table.index[-1]))
    first = table[1].to_numpy()
    floor = float(np.percentile(table.to_numpy()[:, -1], 1)) if (first > 0).any() else 1e-12
    axes.set_ylim(max(floor / 3, float(first.max()) * 1e-12), float(first.max()) * 3)
    if not few:
        axes.legend(
            frameon=False, loc="lower right", bbox_to_anchor=(1, 1), ncols=table.shape[1]
        )  # off the peaks
    return figure
