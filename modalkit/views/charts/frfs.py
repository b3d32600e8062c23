"""Measured FRFs beside those of the model, before and after."""

from __future__ import annotations

import numpy as np

from acquisition.display import counted
from modalkit.views.chart import Axis, Chart, Choices, Series
from modalkit.views.charts.test import ends, size
from modalkit.views.charts.thin import common_lines
from modalkit.views.hits import frf_names
from modalkit.workflow.overlaid import Overlaid
from updating.correlation.frfs import CorrelatedFrfs


def overlaid_chart(both: Overlaid, name: str = "frfs", *, tests: int = 1) -> Chart:
    """Return measured FRFs and the model's, the worst first.

    Parameters
    ----------
    both : Overlaid
        The FRFs.
    name : str
        Of the chart.
    tests : int
        Tests that share the file [-].
    """
    before, after = both.before, both.after
    shown = before if after is None else after
    test = before.measured
    keep, count = common_lines(test, 3, tests=tests)
    names = frf_names(test)
    items = []
    for i in np.argsort(shown.frac, kind="stable")[:count].tolist():
        series = [
            Series("measured", "line", None, size(test.values[i], keep), "ink"),
            Series(
                "unchanged model",
                "line",
                None,
                size(before.model.values[i], keep),
                "orange",
                {"dash": True},
            ),
        ]
        if after is not None:
            series.append(
                Series("with the explanation", "line", None, size(after.model.values[i], keep), "blue")
            )
        items.append((f"{names[i]}, FRAC {shown.frac[i]:.3f}", series))
    left = f" Of {len(names)} FRFs the {count} worst are here." if count < len(names) else ""
    level = " The level of the test is not known; the models are drawn to fit it." if both.levelled else ""
    return Chart(
        name,
        overlaid_title(both),
        f"The worst first. Damping of the model: {before.damping}.{level}{left}",
        Axis("frequency [Hz]", range=ends(test)),
        Axis(f"|H| [{test.unit}]", log=True),
        choices=Choices("FRF", items, test.frequency[keep]),
    )


def overlaid_title(both: Overlaid) -> str:
    """State the median FRAC before and after."""
    median = f"{counted(len(both.before.frac), 'FRF')}: median FRAC {np.median(both.before.frac):.3f}"
    return median if both.after is None else f"{median} before, {np.median(both.after.frac):.3f} after"


def chosen_frfs(both: CorrelatedFrfs, count: int) -> dict[int, str]:
    """Return the rows that are shown and why: drive point, best, worst, then what lies evenly between them."""
    order = np.argsort(-both.frac, kind="stable")
    pairs = zip(both.measured.responses, both.measured.references, strict=True)
    drive = [i for i, (r, f) in enumerate(pairs) if (r.node, r.axis) == (f.node, f.axis)]
    stated = [(i, "drive point") for i in drive[:1]]
    stated += [(int(order[0]), "best FRAC"), (int(order[-1]), "worst FRAC")]
    stated += [(int(order[k]), "") for k in np.linspace(0, len(order) - 1, count).round().astype(int)]
    chosen: dict[int, str] = {}
    for row, why in stated:
        if row in chosen:
            chosen[row] = ", ".join(filter(None, (chosen[row], why)))
        elif len(chosen) < max(count, 1):
            chosen[row] = why
    return chosen
