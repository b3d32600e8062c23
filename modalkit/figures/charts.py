"""Figures that are charts: each is made of its record, which the report and the app draw too."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import FrfSet, InputError, ModalData
from acquisition.arrays import FloatArray
from acquisition.display import counted
from acquisition.quantities import bare_hertz, hertz, percent
from identification import ModalModel, cmif, mvmif, pole_origins
from modalkit.figures.chart import chart_figure, sheet_figure
from modalkit.figures.style import INK, MARGIN, SMALL, WIDTH, broken
from modalkit.planning import Forecast
from modalkit.views.chart import Sheet
from modalkit.views.charts.causes import closing_chart
from modalkit.views.charts.damping import ExpectedDamping, damping_chart
from modalkit.views.charts.frf import test_sheet
from modalkit.views.charts.frfs import overlaid_sheet
from modalkit.views.charts.gap import gap_chart
from modalkit.views.charts.matrix import matrix_chart
from modalkit.views.charts.planning import separations_chart, thresholds_chart
from modalkit.views.charts.poles import poles_chart, rejected_columns
from modalkit.views.charts.test import auto_mac_chart, cmif_chart, mvmif_chart
from modalkit.views.charts.update import Factor, factors_chart
from modalkit.views.mode_errors import ModeErrors
from modalkit.workflow.overlaid import Overlaid
from updating import Diagnosis
from updating.correlation.frfs import CorrelatedFrfs


def frf_figure(frfs: FrfSet, model: ModalModel | None = None, *, count: int = 4) -> Figure:
    """Draw magnitude, phase and coherence of some FRFs, with the fit over them and the modes marked.

    Parameters
    ----------
    frfs : FrfSet
        Measured FRFs.
    model : ModalModel, optional
        The fit; the figure is then limited to its band.
    count : int
        Number of FRFs shown at the most: a drive point if there is one, the others spread over the set.

    Returns
    -------
    Figure
    """
    return sheet_figure(test_sheet(frfs, model, count=count))


def overlay_figure(both: CorrelatedFrfs, *, count: int = 4) -> Figure:
    """Draw magnitude and phase of some FRFs, measured and the model's.

    Parameters
    ----------
    both : CorrelatedFrfs
        The FRFs and their FRAC.
    count : int
        How many at the most: a drive point if there is one, the best, the worst, and those between.

    Returns
    -------
    Figure
    """
    return overlaid_figure(Overlaid(both, None), count=count)


def overlaid_figure(both: Overlaid, *, count: int = 4) -> Figure:
    """Draw magnitude and phase of some FRFs: measured, the unchanged model, and with the explanation.

    Parameters
    ----------
    both : Overlaid
        The FRFs.
    count : int
        How many at the most.

    Returns
    -------
    Figure
    """
    return sheet_figure(overlaid_sheet(both, count=count))


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
    return chart_figure(cmif_chart(frfs, cmif(frfs, band=band, count=count)))


def mvmif_figure(frfs: FrfSet, *, band: tuple[float, float] | None = None, count: int = 4) -> Figure:
    """Draw the multivariate mode indicator functions.

    Parameters
    ----------
    frfs, band, count
        As of :func:`identification.mvmif`.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If no response was measured with every reference.
    """
    return chart_figure(mvmif_chart(frfs, mvmif(frfs, band=band, count=count)))


def stabilisation_figure(
    model: ModalModel, *, add: Sequence[float] = (), drop: Sequence[float] = ()
) -> Figure:
    """Draw every pole of every order over the summed magnitude, with the reason of every column that is no mode.

    Parameters
    ----------
    model : ModalModel
        The identification.
    add, drop : sequence of float
        The frequencies that were added and dropped by hand [Hz].

    Returns
    -------
    Figure
    """
    origins = pole_origins(model, add=add, drop=drop)
    columns = rejected_columns(model, origins)
    room = 72 * (WIDTH - 2 * MARGIN)
    reasons = [f"{_letter(i)}   {hertz(f)}: {text}" for i, (f, text) in enumerate(columns)]
    lines = [line for reason in reasons for line in broken(reason, room, SMALL)]
    listed = [bare_hertz(f) for f in model.modal.frequency]
    # frequencies of so many modes are listed; of more, the first and the last
    note = f"{', '.join(listed)} Hz" if len(listed) <= 24 else f"{listed[0]} to {listed[-1]} Hz"
    figure = chart_figure(poles_chart(model, origins), note=note, beneath=lines)
    _letters(figure.axes[0], [frequency for frequency, _ in columns])
    return figure


def _letter(i: int) -> str:
    """Return a, b, ... z, aa, ab, ..."""
    return (_letter(i // 26 - 1) if i >= 26 else "") + chr(ord("a") + i % 26)


def _letters(axes: Axes, columns: Sequence[float]) -> None:
    """Write a letter at the foot of each column that is no mode; those that stand close go one above the other."""
    low, high = axes.get_xlim()
    last, level = -np.inf, 0
    for i, frequency in enumerate(columns):
        level = level + 1 if frequency - last < 0.012 * (high - low) else 0
        last = frequency
        at = (frequency, (0.35 + level) * 0.05 * axes.get_ylim()[1])
        axes.text(*at, _letter(i), fontsize=SMALL, color=INK, ha="center", zorder=4)


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
    return chart_figure(
        matrix_chart("matrix", title, note, values, rows, columns, axes=(row_name, column_name))
    )


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
    chart = auto_mac_chart(modal)
    if chart is None:
        raise InputError("these modes have no shapes to compare; identify them from FRFs at several points")
    return chart_figure(chart)


def damping_figure(modal: ModalData, expected: ExpectedDamping | None = None) -> Figure:
    """Draw the damping of the modes over their frequency, beside what a model expects.

    Parameters
    ----------
    modal : ModalData
        Modes with damping ratios.
    expected : ExpectedDamping, optional
        As of :func:`modalkit.views.charts.damping.expected_damping`.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If no damping is known.
    """
    chart = damping_chart(modal, expected)
    if chart is None:
        raise InputError("these modes have no damping ratios to draw; identify them from FRFs")
    return chart_figure(chart)


def gap_figure(errors: ModeErrors, *, after: str = "after", title: str = "") -> Figure:
    """Draw the error of every mode as it was and as the best explanation leaves it.

    Parameters
    ----------
    errors : ModeErrors
        Errors of one specimen.
    after : str
        What the dots are.
    title : str
        Which specimen, where there are several.

    Returns
    -------
    Figure
    """
    chart = gap_chart(errors, after=after)
    return chart_figure(chart, note=f"{title}  ·  {chart.text}" if title else "")


def shrink_figure(diagnosis: Diagnosis) -> Figure:
    """Draw the gap of the unchanged model, of the tolerances alone, of the runner-up and of the answer.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.

    Returns
    -------
    Figure
    """
    return chart_figure(closing_chart(diagnosis))


def update_figure(
    frequency: FloatArray,
    before: FloatArray,
    after: FloatArray,
    *,
    sigma: FloatArray | None = None,
    parameters: Mapping[str, Factor] | None = None,
    title: str = "",
) -> Figure:
    """Draw the frequency errors before and after updating, and the factors found.

    Parameters
    ----------
    frequency : (n_modes,) array
        Measured frequencies [Hz].
    before, after : (n_modes,) arrays
        Errors of the nominal and of the updated model, relative to the test [%].
    sigma : (n_modes,) array, optional
        Standard deviation of the measured frequencies [%].
    parameters : mapping of str to (factor, sigma), optional
        Factors on the nominal values and their standard deviations, nan where unknown [-].
    title : str
        Of the study.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If the arrays do not have one entry per mode.
    """
    f, b, a = (np.asarray(v, dtype=float) for v in (frequency, before, after))
    if not f.ndim == 1 or not f.shape == b.shape == a.shape or len(f) == 0:
        raise InputError(f"frequencies {f.shape}, errors {b.shape} and {a.shape}: give one of each per mode")
    floor = None if sigma is None else 2 * np.asarray(sigma, dtype=float)
    charts = [replace(gap_chart(ModeErrors(f, b, a, floor, None, "frequency")), title="Errors, mode by mode")]
    if (factors := factors_chart(parameters or {})) is not None:
        charts.append(replace(factors, title="Parameters, over their nominal values"))
    sizes = [percent(float(np.sqrt(np.mean(v**2)))) for v in (b, a)]
    title = f"Updating takes the frequency error from {sizes[0]} to {sizes[1]} r.m.s."
    parts = [
        title,
        counted(len(f), "mode"),
        counted(len(parameters or {}), "parameter") if parameters else "",
    ]
    return sheet_figure(Sheet(title, "  ·  ".join(filter(None, parts)), charts))


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
    if len(found.now.names) < 2:
        raise InputError("the forecast has fewer than two effects to draw")
    title = "What the test separates, and from what severity on"
    note = f"forecast by {found.bench.basis}, including tolerances and all uncertainties"
    # of more effects only those that are not surely named are compared on paper
    charts = [thresholds_chart(found), separations_chart(found, most=24)]
    return sheet_figure(Sheet(title, note, [one for one in charts if one.y.names]), columns=1)
