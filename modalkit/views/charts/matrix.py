"""Matrices as cells: MAC, correlations, separations of a test."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.views.chart import Axis, Chart, Series

CONFUSED = 0.3
"""From this MAC on two modes are reported as similar."""


def matrix_chart(
    name: str,
    title: str,
    text: str,
    values: FloatArray,
    rows: Sequence[str],
    columns: Sequence[str],
    *,
    axes: tuple[str, str] = ("", ""),
    written: Sequence[str] | None = None,
    quantity: str = "MAC",
) -> Chart:
    """Return a matrix as cells, rows from above to below.

    Parameters
    ----------
    name, title, text : str
        Of the chart.
    values : (n_rows, n_columns) array
        From -1 to 1 [-].
    rows, columns : sequences of str
        Names.
    axes : (str, str)
        What rows and columns are.
    written : sequence of str, optional
        What stands in each cell, row by row; left out: hundredths.
    quantity : str
        What a cell is, for who points at it.
    """
    i, j = (index.ravel() for index in np.indices(values.shape))
    pairs = list(zip(i.tolist(), j.tolist(), strict=True))
    flat = values.ravel()
    shown = [_hundredths(v) for v in flat] if written is None else list(written)
    exact = [f"{v:.3f}" if np.isfinite(v) else "not known" for v in flat] if written is None else shown
    text_of = [
        f"{axes[0]} {rows[a]}\n{axes[1]} {columns[b]}\n{quantity} {exactly}".strip()
        for (a, b), exactly in zip(pairs, exact, strict=True)
    ]
    cells = Series(
        quantity, "cells", j, i, "blue",
        {
            "low": j - 0.5, "high": j + 0.5, "bottom": i - 0.5, "top": i + 0.5, "value": flat, "written": shown,
            "text": text_of, "unnamed": True,
        },
    )  # fmt: skip
    return Chart(
        name,
        title,
        text,
        Axis(axes[1], names=tuple(columns)),
        Axis(axes[0], names=tuple(rows)),
        [cells],
        more={"cell": 68},  # width of a cell at the most: a matrix of three modes is not to fill the page
    )


def _hundredths(value: float) -> str:
    if not np.isfinite(value) or abs(value) < 0.005:
        return ""
    return f"{100 * value:.0f}".replace("-", "−")


def alike(matrix: FloatArray) -> str:
    """State which modes look most alike."""
    if len(matrix) < 2:
        return "One mode"
    if not np.isfinite(matrix).all():
        return "One degree of freedom: there is no shape to compare"
    apart = matrix - np.eye(len(matrix))
    i, j = np.unravel_index(int(apart.argmax()), apart.shape)
    first, second = sorted((int(i) + 1, int(j) + 1))
    if apart[i, j] < 0.1:
        return "All modes are distinct"
    if apart[i, j] < CONFUSED:
        return f"All modes differ; {first} and {second} are the most similar ({100 * apart[i, j]:.0f} %)"
    return f"Modes {first} and {second} are similar ({100 * apart[i, j]:.0f} %)"
