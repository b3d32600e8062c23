"""Our versions of paper A's Figs. 3-6: the FRF at the accelerometer, measured and of the updated model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from acquisition import FrfSet
from acquisition.arrays import ComplexArray, FloatArray
from acquisition.form import FORMS
from acquisition.quantities import percent
from modalkit.figures.chart import sheet_figure
from modalkit.papers.a.chain import Walk, Walked
from modalkit.views.chart import Sheet
from modalkit.views.charts.frf import Curve, frf_chart
from updating.models.state import NOMINAL, State
from updating.nominal import predictor_of

MODES = 20
"""Modes of the model that are summed [-]."""


@dataclass(frozen=True)
class Shown:
    """What one of the paper's figures shows.

    Parameters
    ----------
    number : int
        Its number in the paper.
    of : str
        What was tested.
    top : float
        Upper end of the band shown [Hz].
    """

    number: int
    of: str
    top: float


FIGURES = {
    1: Shown(3, "Dry beam", 500.0),
    2: Shown(4, "Beam in water", 500.0),
    3: Shown(5, "Dry plate", 400.0),
    4: Shown(6, "Plate in water", 400.0),
}
"""Figures by the number of the table they belong to."""


def figures_a(walks: Sequence[Walk]) -> dict[str, Figure]:
    """Draw measured and updated FRFs of every test, the identified damping ratios put into the model.

    Parameters
    ----------
    walks : sequence of Walk
        The tests, worked out.

    Returns
    -------
    dict of str to Figure
        By file name: ``a_fig_3`` to ``a_fig_6``.
    """
    return {f"a_fig_{FIGURES[one.table.number].number}": _figure(one) for one in walks}


def _figure(one: Walk) -> Figure:
    shown, walked, table = FIGURES[one.table.number], one.models[0], one.table
    assert one.session.identified is not None
    whole = one.session.identified.frfs
    frfs = whole.band(float(whole.frequency[0]), shown.top)
    row = _at_the_sensor(frfs)
    estimate = walked.result.parameters[0]
    states = {
        "before": NOMINAL,
        "after": State(factors={table.parameter: float(estimate.factor or 1.0)}),
    }
    labels = {"before": "model before", "after": f"updated: {table.parameter} × {estimate.factor:.3f}"}
    lines = frfs.frequency
    curves = [Curve("measured", "synthetic test", lines, frfs.values[row])]
    curves += [
        Curve(part, labels[part], lines, model_frf(walked, frfs, state)) for part, state in states.items()
    ]
    after = walked.result.rms_percent("after")
    before = walked.result.rms_percent("before")
    title = (
        f"{shown.of}: one factor takes the frequency error from {percent(before)} to {percent(after)} r.m.s."
    )
    note = (
        f"Paper A, Fig. {shown.number}, ours  ·  {table.models[0].program} model of Table {table.number} with the "
        f"identified damping ratios  ·  accelerance at the accelerometer"
    )
    chart = frf_chart("frf", f"hit and seen at point {frfs.responses[row].node}", "", frfs.unit, curves)
    return sheet_figure(Sheet(title, note, [chart]))


def _at_the_sensor(frfs: FrfSet) -> int:
    """Return the FRF that is hit where it is measured."""
    pairs = zip(frfs.responses, frfs.references, strict=True)
    return next(i for i, (response, reference) in enumerate(pairs) if response.node == reference.node)


def model_frf(walked: Walked, like: FrfSet, state: State) -> ComplexArray:
    """Return a model's FRF at the accelerometer with the identified damping ratios (n_lines,) [unit of ``like``].

    Modes that the test has no partner for get the median of its ratios.
    """
    case = walked.case
    prediction = predictor_of(case).predict(state, count=MODES)
    row = int(np.flatnonzero(case.measured.seen == case.measured.hit)[0])
    omega = 2 * np.pi * prediction.frequency
    zeta = _ratios(walked, len(omega))
    s = like.laplace
    modes = s**2 + 2 * (zeta * omega)[:, None] * s + (omega**2)[:, None]
    return np.asarray(prediction.constants[row] @ (1 / modes) * s ** FORMS.index(like.form))


def _ratios(walked: Walked, count: int) -> FloatArray:
    measured = walked.case.measured.damping
    found = np.full(count, np.median(measured))
    pairs = walked.result.pairs
    partner = pairs["model_mode"].to_numpy(int) - 1
    inside = partner < count
    found[partner[inside]] = measured[pairs["test_mode"].to_numpy(int)[inside] - 1]
    return found
