"""Our versions of paper B's Figs. 4-9: FRFs, parameters by iteration, and FRAC."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from acquisition.form import FORMS, UNITS
from modalkit.figures.chart import chart_figure, sheet_figure
from modalkit.papers.b import printed
from modalkit.papers.b.staged import Staged
from modalkit.views.chart import Axis, Sheet
from modalkit.views.charts.frf import Curve, frf_chart
from modalkit.views.charts.update import Course, course_chart, frac_chart
from updating.models.state import State

NODES = (4, 11)
"""Points whose FRFs are shown: where the hammer hits, and the far end."""


def figures_b(update: Staged) -> dict[str, Figure]:
    """Draw the figures of both stages.

    Parameters
    ----------
    update : Staged
        The updated beam.

    Returns
    -------
    dict of str to Figure
        By file name: ``b_fig_4`` to ``b_fig_9``.
    """
    bare = printed.undamped(update.taped.regions)
    first, both = update.section, update.both
    return {
        "b_fig_4": _frfs(update, 4, "Updating the section moves the resonances; their height waits for damping",
                         "undamped, as the paper's first stage",
                         {"before": bare, "after": first.plus(bare)}),
        "b_fig_5": _courses(update, 5, printed.SECTION),
        "b_fig_6": _frac(update, 6, {"before": bare, "section updated": first.plus(bare)}, "undamped models",
                         "Without damping in the model FRAC stays low, whatever the section: {before} and {after}"),
        "b_fig_7": _frfs(update, 7, "Damping by region brings the model's FRFs onto the measured ones",
                         "section updated in both", {"before": first, "after": both}),
        "b_fig_8": _courses(update, 8, printed.DAMPERS),
        "b_fig_9": _frac(update, 9, {"estimated damping": first, "damping updated": both}, "section updated in both",
                         "Damping by region lifts the mean FRAC from {before} to {after}"),
    }  # fmt: skip


def _frfs(update: Staged, number: int, title: str, what: str, states: Mapping[str, State]) -> Figure:
    taped = update.taped
    frfs = taped.frfs
    back = frfs.laplace ** FORMS.index(frfs.form)
    measured = frfs.values / back
    models = {part: taped.values(state) / back for part, state in states.items()}
    labels = {"before": "model before", "after": "updated model"}
    nodes = [r.node for r in frfs.responses]
    panels = []
    for row in (nodes.index(node) for node in NODES):
        curves = [Curve("measured", "synthetic test", frfs.frequency, measured[row])]
        curves += [Curve(part, labels[part], frfs.frequency, values[row]) for part, values in models.items()]
        title = f"seen at point {nodes[row]}, hit at point {frfs.references[row].node}"
        panels.append(frf_chart(f"frf-{row}", title, "", UNITS["receptance"], curves))
    note = f"Paper B, Fig. {number}, ours  ·  {what}  ·  receptances"
    return sheet_figure(Sheet(title, note, panels), columns=1)


def _frac(update: Staged, number: int, states: Mapping[str, State], what: str, title: str) -> Figure:
    taped = update.taped
    bars = [taped.frac_of(state) for state in states.values()]
    before, after = (f"{v.mean():.2f}" for v in bars)
    note = f"Paper B, Fig. {number}, ours  ·  {what}  ·  receptances, 5-600 Hz"
    title = title.format(before=before, after=after)
    first, second = states
    chart = frac_chart([f"{r.node}" for r in taped.frfs.responses], bars[0], bars[1], (first, second))
    return chart_figure(chart, title=title, note=note)


def _courses(update: Staged, number: int, rows: Mapping[str, tuple[str, float, float, float]]) -> Figure:
    panels: dict[str, list[Course]] = {}
    repeats: dict[str, tuple[int, ...]] = {}
    for parameter, scale, _, given in rows.values():
        region, name = parameter.split(".")
        panels.setdefault(name, []).append(Course(region, scale * update.courses[parameter], given))
        repeats.setdefault(name, update.repeats[parameter])
    damped = "alpha" in panels
    title = (
        "Alpha and beta under the tape grow far above those of the bare steel"
        if damped
        else "Area and inertia grow by a third: the test's calibration, not the beam"
    )
    note = (
        f"Paper B, Fig. {number}, ours  ·  stage {2 if damped else 1}  ·  dashed: what the paper printed  ·  "
        "dotted: where the stage was taken up again"
    )
    charts = [
        course_chart(
            f"course-{name}", name, Axis(f"[{_unit(name)}]", log=name == "beta"), lines, repeats=repeats[name]
        )
        for name, lines in panels.items()
    ]
    return sheet_figure(Sheet(title, note, charts), columns=1, tall=2.2)


def _unit(name: str) -> str:
    return printed.UNITS[name].replace("1e-6 s", "µs")
