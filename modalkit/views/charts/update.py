"""How the parameters of an update moved, where they stand, and what became of the FRAC."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.display import counted
from modalkit.views.chart import Axis, Chart, Series, Sheet
from updating.frf_update import FrfUpdate
from updating.update import Update

Factor = tuple[float, float]
"""A factor on the nominal value and its standard deviation [-]."""

SHADES = ("blue", "orange", "green", "red", "ink", "muted")
"""Of lines in a panel; a seventh begins a panel of its own."""


def factors_of(result: Update, study: str | None = None) -> dict[str, Factor]:
    """Return the factors on the nominal values with their standard deviations, of one study those that move it."""
    own = zip(result.names, result.parameters, strict=True)
    return {
        name: (p.factor, p.sigma * p.factor / p.value)
        for name, p in own
        if p.factor is not None and p.value and (study is None or p.study in (None, study))
    }


def factors_chart(factors: Mapping[str, Factor]) -> Chart | None:
    """Return factors on the nominal values; None where none is one."""
    known = [(name, *factor) for name, factor in factors.items()]
    if not known:
        return None
    rows = np.arange(len(known))
    factor = np.array([f for _, f, _ in known], dtype=float)
    sigma = np.array([2 * s if np.isfinite(s) else 0.0 for _, _, s in known])
    text = [
        f"{name}\nfactor {f:.4f}" + (f" ± {s:.2g} (1σ)" if np.isfinite(s) else ", not determined by the data")
        for name, f, s in known
    ]
    far = int(np.argmax(np.abs(factor - 1)))
    change = f"{100 * (factor[far] - 1):+.3g} %".replace("-", "−")
    return Chart(
        "factors",
        f"{known[far][0]} moved by {change}"
        if len(known) == 1
        else f"{counted(len(known), 'factor')}; {known[far][0]} moved most, by {change}",
        "Factors on the nominal values, with two standard deviations. Dotted: the start, 1.",
        Axis("factor on the nominal value [-]", range=_with_one(factor - sigma, factor + sigma)),
        Axis(names=tuple(name for name, _, _ in known)),
        [
            Series("2σ", "links", [], rows, "faint", {"low": factor - sigma, "high": factor + sigma}),
            Series("after the update", "points", factor, rows, "blue", {"text": text, "size": 5}),
        ],
        more={
            "lines": [1.0],
            "notes": [f"{f:.3f}" + (f" ± {s:.3f}" if np.isfinite(s) else "") for _, f, s in known],
        },
    )


def _with_one(low: FloatArray, high: FloatArray) -> tuple[float, float]:
    """Return the ends of an axis on which all factors stand, and 1, where they began [-]."""
    ends = min(1.0, float(low.min())), max(1.0, float(high.max()))
    edge = 0.05 * max(ends[1] - ends[0], 1e-3)
    return ends[0] - edge, ends[1] + edge


@dataclass(frozen=True, eq=False)
class Course:
    """One parameter's way.

    Parameters
    ----------
    name : str
        What the key calls it.
    values : (n_iterations + 1,) array
        Its values, the start first [unit of the chart].
    printed : float, optional
        What a paper printed [unit of the chart].
    """

    name: str
    values: FloatArray
    printed: float | None = None


def course_chart(
    name: str, title: str, axis: Axis, courses: Sequence[Course], *, repeats: Sequence[float] = ()
) -> Chart:
    """Return parameters by iteration, dashed beside them what a paper printed.

    Parameters
    ----------
    name, title : str
        Of the chart.
    axis : Axis
        Of the values.
    courses : sequence of Course
        The parameters, six at the most.
    repeats : sequence of float
        Iterations after which a stage begins or is taken up again.
    """
    series = []
    for one, shade in zip(courses, SHADES, strict=False):
        steps = np.arange(len(one.values))
        series.append(Series(f"{one.name} {one.values[-1]:.3g}", "line", steps, one.values, shade))
        if one.printed is not None:
            ends, stated = steps[[0, -1]], np.full(2, one.printed)
            series.append(Series(f"printed {one.printed:.3g}", "line", ends, stated, shade, {"dash": True}))
    again = " Dotted: a stage starts or is repeated." if len(repeats) else ""
    names = ", ".join(one.name for one in courses)
    more = {"lines": [float(at) for at in repeats]}
    return Chart(name, title, f"{names}.{again}", Axis("iteration"), axis, series, 220.0, more=more)


def course_sheet(result: Update) -> Sheet:
    """Return how the parameters moved, those of one unit together, six to a chart; no chart if none moved."""
    panels: dict[str, list[int]] = {}
    for i, p in enumerate(result.parameters):
        panels.setdefault("-" if p.relative else p.unit, []).append(i)
    groups = [
        (unit, members[k : k + len(SHADES)])
        for unit, members in panels.items()
        for k in range(0, len(members), len(SHADES))
    ]
    repeats = np.cumsum(result.stages).tolist() if isinstance(result, FrfUpdate) else []
    charts = []
    for number, (unit, part) in enumerate(groups, start=1):
        courses = [Course(result.names[i], result.history[result.names[i]].to_numpy(float)) for i in part]
        title = f"{counted(len(part), 'parameter')} over {counted(result.iterations, 'iteration')}"
        axis = Axis("factor [-]" if unit == "-" else f"value [{unit}]")
        charts.append(course_chart(f"course-{number}", title, axis, courses, repeats=repeats))
    moved = len(result.history) > 1
    return Sheet("How the parameters moved", counted(result.iterations, "iteration"), charts if moved else [])


def frac_of(result: FrfUpdate) -> Chart:
    """Return FRAC of every FRF of an update before and after."""
    names = [f"{r}/{f}" for r, f in zip(result.frac["response"], result.frac["force"], strict=True)]
    before, after = (result.frac[name].to_numpy(float) for name in ("before", "after"))
    return frac_chart(names, before, after)


def frac_chart(
    names: Sequence[str], before: FloatArray, after: FloatArray, words: tuple[str, str] = ("before", "after")
) -> Chart:
    """Return FRAC of every FRF before and after.

    Parameters
    ----------
    names : sequence of str
        Of the FRFs, as response/force.
    before, after : (n_frfs,) arrays
        FRAC [-].
    words : (str, str)
        What the rings and the dots are.
    """
    rows = np.arange(len(names))
    return Chart(
        "frac",
        f"{counted(len(names), 'FRF')}: mean FRAC {before.mean():.2f} before, {after.mean():.2f} after",
        f"Rings: {words[0]}; dots: {words[1]}.",
        Axis("FRAC [-]", range=(0.0, 1.02)),
        Axis("response/force", names=tuple(names)),
        [
            Series("", "links", [], rows, "faint", {"low": before, "high": after}),
            Series(words[0], "points", before, rows, "ink", {"hollow": True, "size": 4.5}),
            Series(words[1], "points", after, rows, "blue", {"size": 4.5}),
        ],
        more={"row": 20},
    )
