"""Measured FRFs beside those of the model, before and after."""

from __future__ import annotations

import numpy as np

from acquisition.display import counted
from acquisition.frfs.frf import FrfSet
from modalkit.views.chart import Axis, Chart, Choices, Sheet
from modalkit.views.charts.frf import NAMES, Curve, frf_chart, frf_names, magnitude
from modalkit.views.charts.thin import common_lines
from modalkit.workflow.overlaid import Overlaid
from updating.correlation.frfs import CorrelatedFrfs


def overlaid_sheet(both: Overlaid, *, count: int = 4) -> Sheet:
    """Return magnitude and phase of some FRFs: measured, the unchanged model, and with the explanation.

    Parameters
    ----------
    both : Overlaid
        The FRFs.
    count : int
        How many at the most: a drive point if there is one, the best, the worst, and those between.
    """
    shown = both.before if both.after is None else both.after
    chosen, names = chosen_frfs(shown, count), frf_names(shown.measured)
    charts = []
    for row, why in chosen.items():
        stated = f" ({why})" if why else ""
        charts.append(
            frf_chart(
                f"frfs-{row}",
                f"{names[row]}{stated}",
                "",
                shown.measured.unit,
                _curves(both, row, scored=True),
            )
        )
    title = overlaid_title(both).partition(": ")[2]
    title = title if both.after is not None else f"test and model, {title}"
    several = f"{len(chosen)} of {len(names)} FRFs" if len(chosen) < len(names) else "all FRFs"
    lines = f" on every {both.every}th line" if both.every > 1 else ""
    note = f"{several}{lines}, FRAC {shown.frac.min():.3f} to {shown.frac.max():.3f}. {_damping(both)}"
    if decay := shown.measured.decay:
        note += f" All with the exponential window of {decay:g} 1/s."
    return Sheet(f"{NAMES[shown.measured.form]}: {title}", note, charts)


def overlaid_chart(both: Overlaid, name: str = "frfs", *, tests: int = 1) -> Chart:
    """Return the magnitudes of measured FRFs and the model's, one shown at a time, the worst first.

    Parameters
    ----------
    both : Overlaid
        The FRFs.
    name : str
        Of the chart.
    tests : int
        Tests that share the file [-].
    """
    shown = both.before if both.after is None else both.after
    test = both.before.measured
    keep, count = common_lines(test, 3, tests=tests)
    names = frf_names(test)
    items = [
        (f"{names[i]}, FRAC {shown.frac[i]:.3f}", [magnitude(curve, keep) for curve in _curves(both, i)])
        for i in np.argsort(shown.frac, kind="stable")[:count].tolist()
    ]
    left = f" The {count} worst of {len(names)} FRFs are shown." if count < len(names) else ""
    return Chart(
        name,
        overlaid_title(both),
        f"The worst first. {_damping(both)}{left}",
        Axis("frequency [Hz]", range=ends(test)),
        Axis(f"|H| [{test.unit}]", log=True),
        choices=Choices("FRF", items, test.frequency[keep]),
    )


def _curves(both: Overlaid, row: int, *, scored: bool = False) -> list[Curve]:
    """Return the curves of one FRF, those of models with their FRAC if ``scored``."""
    test = both.before.measured
    models = [("before", "unchanged model", both.before)]
    models += [] if both.after is None else [("after", "with the explanation", both.after)]
    found = [Curve("measured", "measured", test.frequency, test.values[row])]
    for part, name, one in models:
        score = f", FRAC {one.frac[row]:.3f}" if scored else ""
        found.append(Curve(part, name + score, one.model.frequency, one.model.values[row]))
    return found


def _damping(both: Overlaid) -> str:
    level = " The test has no absolute level; the models are scaled to fit it." if both.levelled else ""
    return f"Damping of the model: {both.before.damping}.{level}"


def overlaid_title(both: Overlaid) -> str:
    """State the median FRAC before and after."""
    median = f"{counted(len(both.before.frac), 'FRF')}: median FRAC {np.median(both.before.frac):.3f}"
    return median if both.after is None else f"{median} before, {np.median(both.after.frac):.3f} after"


def ends(frfs: FrfSet) -> tuple[float, float]:
    """Return the ends of the axis [Hz]."""
    return float(frfs.frequency[0]), float(frfs.frequency[-1])


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
