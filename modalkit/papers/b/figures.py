"""Our versions of paper B's Figs. 4-9: FRFs, parameters by iteration, and FRAC."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from acquisition.form import FORMS, UNITS
from modalkit.figures.curves import Curve, Panel, curves_figure
from modalkit.figures.update.evolution import Course, Courses, evolution_figure
from modalkit.figures.update.frac import frac_figure
from modalkit.papers.b import printed
from modalkit.papers.b.staged import Staged
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
                         {"before": bare, "updated": first.plus(bare)}),
        "b_fig_5": _courses(update, 5, printed.SECTION),
        "b_fig_6": _frac(update, 6, {"before": bare, "section updated": first.plus(bare)}, "undamped models",
                         "Without damping in the model FRAC stays low, whatever the section: {before} and {after}"),
        "b_fig_7": _frfs(update, 7, "Damping by region brings the model's FRFs onto the measured ones",
                         "section updated in both", {"before": first, "updated": both}),
        "b_fig_8": _courses(update, 8, printed.DAMPERS),
        "b_fig_9": _frac(update, 9, {"estimated damping": first, "damping updated": both}, "section updated in both",
                         "Damping by region lifts the mean FRAC from {before} to {after}"),
    }  # fmt: skip


def _frfs(update: Staged, number: int, statement: str, what: str, states: Mapping[str, State]) -> Figure:
    taped = update.taped
    frfs = taped.frfs
    back = frfs.laplace ** FORMS.index(frfs.form)
    measured = frfs.values / back
    models = {part: taped.values(state) / back for part, state in states.items()}
    labels = {"before": "model before", "updated": "updated model"}
    nodes = [r.node for r in frfs.responses]
    panels = []
    for row in (nodes.index(node) for node in NODES):
        curves = [Curve("measured", "synthetic test", measured[row])]
        curves += [Curve(part, labels[part], values[row]) for part, values in models.items()]
        title = f"seen at point {nodes[row]}, hit at point {frfs.references[row].node}"
        panels.append(Panel(title, frfs.frequency, tuple(curves), UNITS["receptance"], 135.0))
    note = f"Paper B, Fig. {number}, ours  ·  {what}  ·  receptances"
    return curves_figure(statement, note, panels)


def _frac(update: Staged, number: int, states: Mapping[str, State], what: str, statement: str) -> Figure:
    taped = update.taped
    bars = {name: taped.frac_of(state) for name, state in states.items()}
    before, after = (f"{v.mean():.2f}" for v in bars.values())
    note = f"Paper B, Fig. {number}, ours  ·  {what}  ·  receptances, 5-600 Hz"
    statement = statement.format(before=before, after=after)
    return frac_figure(statement, note, [f"{r.node}" for r in taped.frfs.responses], bars)


def _courses(update: Staged, number: int, rows: Mapping[str, tuple[str, float, float, float]]) -> Figure:
    panels: dict[str, list[Course]] = {}
    for parameter, scale, _, given in rows.values():
        region, name = parameter.split(".")
        course = Course(region, scale * update.courses[parameter], given, update.repeats[parameter])
        panels.setdefault(name, []).append(course)
    damped = "alpha" in panels
    statement = (
        "Alpha and beta under the tape grow far above those of the bare steel"
        if damped
        else "Area and inertia grow by a third: the test's calibration, not the beam"
    )
    note = (
        f"Paper B, Fig. {number}, ours  ·  stage {2 if damped else 1}  ·  dotted: what the paper printed  ·  "
        "grey: where the stage was taken up again"
    )
    courses = [
        Courses(name, _unit(name), tuple(lines), logarithmic=name == "beta") for name, lines in panels.items()
    ]
    return evolution_figure(statement, note, courses)


def _unit(name: str) -> str:
    return printed.UNITS[name].replace("1e-6 s", "µs")
