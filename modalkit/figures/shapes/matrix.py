"""Correlation of mode shapes as a matrix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure

from acquisition import InputError, ModalData
from acquisition.arrays import FloatArray
from acquisition.quantities import hertz
from identification import auto_mac
from modalkit.figures.style import (
    INK,
    MARGIN,
    MUTED,
    PROBABILITY,
    SMALL,
    caption,
    caption_height,
    new_figure,
    place,
    text_width,
)
from modalkit.views.charts.matrix import alike

WRITTEN = 14
"""Up to so many rows or columns the values are written into the cells."""


def mac_figure(
    matrix: FloatArray,
    rows: Sequence[str],
    columns: Sequence[str],
    *,
    title: str = "MAC",
    note: str = "",
    row_name: str = "test",
    column_name: str = "model",
) -> Figure:
    """Draw a matrix of correlations between 0 and 1.

    Parameters
    ----------
    matrix : (n_rows, n_columns) array
        Correlations; nan is left white [-].
    rows, columns : sequence of str
        Names of the modes.
    title, note : str
        What it shows, as a sentence, and what stands behind it.
    row_name, column_name : str
        What rows and columns are.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If the labels do not fit the matrix.
    """
    values = np.asarray(matrix, dtype=float)
    if values.ndim != 2 or values.shape != (len(rows), len(columns)) or values.size == 0:
        raise InputError(
            f"a matrix of shape {values.shape} with {len(rows)} row and {len(columns)} column labels; "
            "give one label each"
        )
    left = MARGIN + 0.45 + max(text_width(name, SMALL) for name in rows) / 72
    below = 0.55 + max(text_width(name, SMALL) for name in columns) / 72
    cell = min(0.62, max(0.16, 8.5 / max(values.shape)))
    wide, tall = cell * values.shape[1], cell * values.shape[0]
    width = max(left + wide + 1.25, 7.0)
    top = caption_height(title, note, width=width) + 0.12
    figure = new_figure(top + tall + below + 0.2, width=width)
    caption(figure, title, note)
    axes = place(figure, left, top, wide, tall, name="matrix")
    image = _cells(axes, values)
    axes.set_xticks(np.arange(len(columns)) + 0.5, columns, rotation=90, fontsize=SMALL, color=INK)
    axes.set_yticks(np.arange(len(rows)) + 0.5, rows, fontsize=SMALL, color=INK)
    axes.tick_params(length=0)
    axes.set_xlabel(column_name, fontsize=11, color=INK)
    axes.set_ylabel(row_name, fontsize=11, color=INK)
    _scale(place(figure, left + wide + 0.25, top, 0.12, min(tall, 2.4), name="scale"), figure, image)
    return figure


def _cells(axes: Axes, values: FloatArray) -> QuadMesh:
    """Colour the cells, the first row at the top, and write the values into them where they are few."""
    image = axes.pcolormesh(values, cmap=PROBABILITY, vmin=0, vmax=1, edgecolors="white", linewidth=1.0)
    axes.invert_yaxis()
    for spine in axes.spines.values():
        spine.set_visible(False)
    if max(values.shape) <= WRITTEN:
        for (i, j), value in np.ndenumerate(values):
            text = "" if not np.isfinite(value) or value < 0.005 else f"{100 * value:.0f}"
            colour = "white" if value > 0.5 else MUTED
            axes.text(j + 0.5, i + 0.5, text, fontsize=SMALL, color=colour, ha="center", va="center")
    return image


def _scale(bar: Axes, figure: Figure, image: QuadMesh) -> None:
    """Draw what the colours mean."""
    scale = figure.colorbar(image, cax=bar, ticks=[0, 0.5, 1])
    scale.outline.set_visible(False)
    bar.tick_params(labelsize=SMALL, length=0, labelcolor=MUTED)
    bar.set_yticklabels(["0", "50", "100 %"])


def auto_mac_figure(modal: ModalData) -> Figure:
    """Draw how alike the shapes of one set of modes are.

    Parameters
    ----------
    modal : ModalData
        Modes with shapes.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there are no shapes.
    """
    if modal.shapes is None or not len(modal):
        raise InputError("these modes have no shapes to compare; identify them from FRFs at several points")
    matrix = np.asarray(auto_mac(modal.shapes), dtype=float)
    names = [f"{i + 1}: {hertz(f)}" for i, f in enumerate(modal.frequency)]
    count = len(modal.dofs)
    note = f"auto-MAC, shapes at {count} degree{'s' if count != 1 else ''} of freedom"
    return mac_figure(
        matrix, names, names, title=alike(matrix), note=note, row_name="mode", column_name="mode"
    )
