"""What a test holds: hits, FRFs with the fit, the chart of the poles, indicator functions, how alike the modes are."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from acquisition import FrfSet, HitVerdict, InputError, ModalData
from acquisition.arrays import FloatArray
from acquisition.display import counted
from acquisition.quantities import hertz, percent
from identification import ModalModel, auto_mac, cmif, mvmif
from modalkit.views.chart import Axis, Chart, Choices, Series
from modalkit.views.charts.frf import Curve, frf_names, magnitude
from modalkit.views.charts.frfs import ends
from modalkit.views.charts.matrix import alike, matrix_chart
from modalkit.views.charts.thin import common_lines


def hits_chart(hits: Sequence[HitVerdict], name: str = "hits") -> Chart:
    """Return the peak force of every hit in the order of the test, those left out as crosses with the reason."""
    series = []
    for used, symbol, colour, meaning in ((True, "dot", "blue", "used"), (False, "cross", "red", "left out")):
        rows = [i for i, hit in enumerate(hits) if hit.used is used]
        text = [
            "\n".join([f"{hits[i].point}, hit {hits[i].hit}: {meaning}",
                       f"{hits[i].peak:.4g} N, {hertz(hits[i].band20)} "
                       "(-20 dB)".replace("-", "−"), *hits[i].reasons])
            for i in rows
        ]  # fmt: skip
        peaks = [hits[i].peak for i in rows]
        more = {"text": text, "symbol": symbol, "size": 4}
        if rows:
            series.append(Series(meaning, "points", [i + 1 for i in rows], peaks, colour, more))
    left = sum(not hit.used for hit in hits)
    title = f"{counted(len(hits), 'hit')}, " + (f"{left} left out" if left else "all used")
    return Chart(
        name,
        title,
        "Peak of the force of every hit, in the order of the points.",
        Axis("hit"),
        Axis("peak [N]", zero=True),
        series,
        240.0,
    )


def frfs_chart(model: ModalModel, name: str = "frf", *, tests: int = 1) -> Chart:
    """Return magnitude of every FRF with its fit and what that leaves, one shown at a time, the worst first."""
    frfs, fitted = model.frfs, model.synthesise().values
    keep, count = common_lines(frfs, 3, tests=tests)
    names = frf_names(frfs)
    left = np.sum(np.abs(frfs.values - fitted) ** 2, axis=1) / np.maximum(
        np.sum(np.abs(frfs.values) ** 2, axis=1), 1e-300
    )
    items = []
    for i in np.argsort(-left, kind="stable")[:count].tolist():
        curves = [
            Curve("measured", "measured", frfs.frequency, frfs.values[i]),
            Curve("remainder", "residual of the fit", frfs.frequency, frfs.values[i] - fitted[i]),
            Curve("fit", "fit", frfs.frequency, fitted[i]),
        ]
        name_of = f"{names[i]}, {percent(100 * float(np.sqrt(left[i])))} left"
        items.append((name_of, [magnitude(curve, keep) for curve in curves]))
    misfit = np.sqrt(np.sum(np.abs(frfs.values - fitted) ** 2) / np.sum(np.abs(frfs.values) ** 2))
    rest = (
        f" {len(names) - count} FRFs with a smaller misfit are not in this file."
        if count < len(names)
        else ""
    )
    return Chart(
        name,
        f"{counted(len(names), 'FRF')}, {counted(len(model), 'mode')}: the fit leaves {percent(100 * misfit)} r.m.s.",
        f"Magnitude, the fit and its residual, the worst first. Dotted: the modes.{rest}",
        Axis("frequency [Hz]", range=ends(frfs)),
        Axis(f"|H| [{frfs.unit}]", log=True),
        choices=Choices("FRF", items, frfs.frequency[keep]),
        more={"modes": [float(f) for f in model.modal.frequency]},
    )


def thin_indicators(frfs: FrfSet) -> tuple[pd.DataFrame, pd.DataFrame] | None:
    """Return CMIF and MvMIF on common lines; None where no response was measured with every reference."""
    try:
        tables = cmif(frfs), mvmif(frfs)
    except InputError:
        return None
    kept = common_lines(frfs, 40)[0]
    return tables[0].iloc[kept], tables[1].iloc[kept]


def cmif_chart(frfs: FrfSet, table: pd.DataFrame, name: str = "cmif") -> Chart:
    """Return the complex mode indicator functions of FRFs.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    table : pandas.DataFrame
        As of :func:`identification.cmif`.
    name : str
        Of the chart.
    """
    what = (
        "A peak is a mode; with one reference or response two close modes show as one."
        if table.shape[1] == 1
        else "A peak of the first curve is a mode; a peak of the second at the same frequency is a second mode there."
    )
    return _indicator_chart(
        frfs, table, (name, "CMIF", what), Axis(f"CMIF [({frfs.unit})²]", log=True), _positive
    )


def mvmif_chart(frfs: FrfSet, table: pd.DataFrame, name: str = "mvmif") -> Chart:
    """Return the multivariate mode indicator functions of FRFs.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    table : pandas.DataFrame
        As of :func:`identification.mvmif`.
    name : str
        Of the chart.
    """
    what = (
        "A minimum is a mode; with one reference or response two close modes show as one."
        if table.shape[1] == 1
        else "A minimum of the first curve is a mode; one of the second at the same frequency is a second mode there."
    )
    return _indicator_chart(
        frfs, table, (name, "MvMIF", what), Axis("MvMIF [-]", range=(0.0, 1.05)), np.asarray
    )


def _indicator_chart(
    frfs: FrfSet,
    table: pd.DataFrame,
    named: tuple[str, str, str],
    axis: Axis,
    shown: Callable[[FloatArray], FloatArray],
) -> Chart:
    """Return mode indicator functions over the lines; ``named`` are the chart, its word and its text."""
    name, word, what = named
    table = table[table.index > 0]
    shades = ("ink", "orange", "blue", "muted")
    lines = table.index.to_numpy(float)
    series = [
        Series(f"{word} {k}", "line", lines, shown(table[k].to_numpy(float)), colour)
        for k, colour in zip(table.columns, shades, strict=False)
    ]
    count = min(table.shape[1], len(shades))
    left = table.attrs["left_out"]
    return Chart(
        name,
        f"{word}: {counted(count, 'mode indicator function')} of {counted(len(frfs.responses), 'FRF')}",
        what + (f" Left out, because FRFs are missing: {', '.join(left)}." if left else ""),
        Axis("frequency [Hz]", range=(float(lines[0]), float(lines[-1]))),
        axis,
        series,
        240.0,
    )


def _positive(values: FloatArray) -> FloatArray:
    """Return values that a logarithm has, none twelve decades below the largest."""
    return np.asarray(np.where(values > 1e-12 * np.nanmax(values, initial=0.0), values, np.nan))


def auto_mac_chart(modal: ModalData, name: str = "auto-mac") -> Chart | None:
    """Return how alike the shapes of the modes are; None without shapes."""
    if modal.shapes is None or not len(modal):
        return None
    matrix = np.asarray(auto_mac(modal.shapes), dtype=float)
    names = [f"{i + 1}: {hertz(f)}" for i, f in enumerate(modal.frequency)]
    text = f"Auto-MAC, shapes at {counted(len(modal.dofs), 'degree')} of freedom, in hundredths."
    return matrix_chart(name, alike(matrix), text, matrix, names, names, axes=("mode", "mode"))
