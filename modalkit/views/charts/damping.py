"""The damping of the modes over their frequency, beside what the model expects where it states any."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition import ModalData
from acquisition.arrays import FloatArray
from acquisition.display import counted
from acquisition.quantities import hertz, percent
from modalkit.views.chart import Axis, Chart, Series
from modalkit.views.shapes import Beside


@dataclass(frozen=True, eq=False)
class ExpectedDamping:
    """Damping that a model expects of the modes that have a partner in it.

    Parameters
    ----------
    frequency : (n_pairs,) array
        The model's natural frequencies [Hz].
    ratio : (n_pairs,) array
        Damping ratios [-].
    measured : (n_pairs,) array
        The test's natural frequencies [Hz].
    """

    frequency: FloatArray
    ratio: FloatArray
    measured: FloatArray


def expected_damping(beside: Beside) -> ExpectedDamping | None:
    """Return the damping that the model of a study expects of the paired modes; None where it states none.

    Parameters
    ----------
    beside : Beside
        The model beside the test.
    """
    if not beside.predictor.expects_damping:
        return None
    pairs = beside.correlation.table
    ratio = beside.predictor.predict().damping[pairs["model mode"].to_numpy(int) - 1]
    known = np.isfinite(ratio)
    model, test = (pairs[name].to_numpy(float)[known] for name in ("model [Hz]", "test [Hz]"))
    return ExpectedDamping(model, ratio[known], test) if known.any() else None


def damping_chart(
    modal: ModalData, expected: ExpectedDamping | None = None, name: str = "damping"
) -> Chart | None:
    """Return the damping ratio of every mode with two standard deviations over its frequency; None without any.

    Parameters
    ----------
    modal : ModalData
        Modes, identified or read.
    expected : ExpectedDamping, optional
        What the model expects.
    name : str
        Of the chart.
    """
    if modal.damping is None or not np.isfinite(modal.damping).any():
        return None
    modes = np.flatnonzero(np.isfinite(modal.damping))
    frequency, ratio = modal.frequency[modes], 100 * modal.damping[modes]
    sigma = np.full(len(modal), np.nan) if modal.damping_sigma is None else modal.damping_sigma
    error = 200 * np.where(sigma > 0, sigma, np.nan)[modes]
    text = [
        f"mode {i + 1}: {hertz(f)}\ndamping {percent(d)}"
        + (f" ± {percent(e)} (2σ)" if np.isfinite(e) else "")
        for i, f, d, e in zip(modes.tolist(), frequency, ratio, error, strict=True)
    ]
    series = [
        Series("identified", "points", frequency, ratio, "blue", {"error": error, "text": text, "size": 5})
    ]
    title = f"Damping of {counted(len(modes), 'mode')}: {_span(ratio)}"
    note = "Damping ratio over natural frequency" + (
        ", with two standard deviations (hidden where smaller than the mark)."
        if np.isfinite(error).any()
        else "; standard deviations are unknown."
    )
    if expected is not None:
        series.insert(0, _expected(expected))
        title += f"; the model expects {_span(100 * expected.ratio)}"
        note += " Rings: damping that the model expects for paired modes, at the frequencies of the model."
    return Chart(
        name, title, note, Axis("frequency [Hz]", zero=True), Axis("damping ratio [%]", zero=True), series, 260.0
    )  # fmt: skip


def _expected(expected: ExpectedDamping) -> Series:
    ratio = 100 * expected.ratio
    text = [
        f"expected of the mode at {hertz(test)}\ndamping {percent(d)}, at {hertz(model)}"
        for test, model, d in zip(expected.measured, expected.frequency, ratio, strict=True)
    ]
    return Series(
        "expected by the model",
        "points",
        expected.frequency,
        ratio,
        "ink",
        {"text": text, "hollow": True, "size": 5},
    )


def _span(values: Sequence[float] | FloatArray) -> str:
    """Return the smallest and the largest ratio [%]."""
    low, high = percent(float(np.min(values))), percent(float(np.max(values)))
    return low if low == high else f"{low} to {high}"
