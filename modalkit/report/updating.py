"""The report of an update."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime

import numpy as np
import pandas as pd

from acquisition.display import counted
from acquisition.quantities import percent, raised
from modalkit.report.document import Document, Part, Section
from modalkit.report.html import Cell, Column, Raw, bullets, definitions, element, joined, table
from modalkit.report.provenance import Basis, cover, provenance
from modalkit.report.sections import the_warnings
from modalkit.report.tested import sections_of_all
from modalkit.views.chart import Chart
from modalkit.views.charts.gap import gap_chart
from modalkit.views.charts.matrix import matrix_chart
from modalkit.views.charts.update import course_sheet, factors_chart, factors_of, frac_of
from modalkit.views.mode_errors import ModeErrors
from modalkit.views.shapes import Changed
from modalkit.workflow.case import Session
from modalkit.workflow.diagnosis import warnings_of
from modalkit.workflow.updated_model import updated_predictor
from updating import Case
from updating.frf_update import FrfUpdate
from updating.update import Update
from updating.update.statistics.doubts import untested


def update_report(
    result: Update, sessions: Sequence[Session], *, when: datetime, command: str = ""
) -> Document:
    """Return the report of an update.

    Parameters
    ----------
    result : Update
        By frequencies, or by FRFs.
    sessions : sequence of Session
        What was updated.
    when : datetime
        Date of the report.
    command : str
        What repeats it.
    """
    title = ", ".join(session.case.title for session in sessions)
    basis = Basis(when, command, [session.study for session in sessions])
    tests = sections_of_all(sessions, [updated_models(result, session.case) for session in sessions])
    return Document(
        title,
        "update",
        joined(element("h1", title), cover("Update of a model", basis), update_answer(result)),
        [
            *update_sections(result),
            *tests,
            Section("Warnings", [the_warnings([*result.warnings, *warnings_of(sessions)])]),
            Section("What this rests on", [provenance(basis)]),
        ],
    )


def updated_models(result: Update, case: Case) -> list[Changed]:
    """Return the updated model of a study, as it is drawn beside the shapes of its test."""
    return [Changed("updated", updated_predictor(result, case))]


def update_sections(result: Update) -> list[Section]:
    """Return errors, parameters, what is not determined, how all moved, and the statement of the fit."""
    frac = frac_of(result) if isinstance(result, FrfUpdate) else None
    return [
        Section("How far it closes", [*_errors(result), pairs_table(result)]),
        Section(
            "Parameters", [factors_chart(factors_of(result)), parameters_table(result), _correlations(result)]
        ),
        Section("What the data do not determine", [_undetermined(result)]),
        Section("FRAC", [frac]),
        Section("How the parameters moved", course_sheet(result).charts),
        Section("The whole statement", [element("pre", result.report())]),
    ]


def update_answer(result: Update) -> Raw:
    """Return how far it closes, in a few lines."""
    before, after = (percent(result.rms_percent(when)) for when in ("before", "after"))
    state = "converged" if result.converged else "NOT converged"
    stated = {
        "Closes": f"frequency error {before} → {after} r.m.s. over {counted(int(result.pairs['used'].sum()), 'mode')}",
        "Ended": f"{state} after {counted(result.iterations, 'iteration')}",
        "Fits": "no degree of freedom is left to test the fit"
        if result.dof <= 0
        else f"misfit {result.reduced_chi2:.3g} measurement variances per degree of freedom ({result.dof} of them)",
    }
    if result.undetermined:
        stated["Careful"] = f"the data do not determine {', '.join(result.undetermined)}"
    if result.held:
        stated["Held"] = f"{', '.join(result.held)} by the tolerance, against the data: see the warnings"
    quiet = element("p", untested(result.data, len(result.parameters))) if result.dof <= 0 else Raw("")
    line = f"{before} → {after} r.m.s., {state}"
    return joined(element("p", line, class_="answer"), definitions(stated, class_="letter"), quiet)


def _errors(result: Update) -> list[Part]:
    """Return the errors before and after, a chart for each study."""
    studies = list(dict.fromkeys(result.pairs["study"]))
    found: list[Part] = []
    for i, study in enumerate(studies, start=1):
        if len(studies) > 1:
            found.append(element("h3", str(study)))
        pairs = result.pairs[result.pairs["study"] == study]
        test = pairs["test_hz"].to_numpy(float)
        before, after = (100 * (pairs[name].to_numpy(float) / test - 1) for name in ("before_hz", "after_hz"))
        errors = ModeErrors(test, before, after, None, None, "frequency", pairs["test_mode"].to_numpy(int))
        found.append(gap_chart(errors, "gap" if i == 1 else f"gap-{i}"))
    return found


def pairs_table(result: Update) -> Raw:
    """Return one row per pair."""
    columns = [
        Column("test mode", lambda v: f"{v:.0f}"),
        Column("model mode", lambda v: f"{v:.0f}"),
        Column("MAC", lambda v: f"{v:.3f}"),
        Column("test [Hz]", lambda v: f"{v:.3f}"),
        Column("before [Hz]", lambda v: f"{v:.3f}"),
        Column("after [Hz]", lambda v: f"{v:.3f}"),
        Column("left [%]", lambda v: f"{v:+.3f}".replace("-", "−")),
        Column("used"),
    ]
    rows: list[list[Cell | Raw]] = [_pair(row) for _, row in result.pairs.iterrows()]
    if _several(result):
        columns.insert(0, Column("study"))
        rows = [[str(study), *row] for study, row in zip(result.pairs["study"], rows, strict=True)]
    return table("Paired modes before and after.", columns, rows)


def _several(result: Update) -> bool:
    """Return whether several studies were updated together; of one alone no table names it."""
    return result.pairs["study"].nunique() > 1


def _pair(row: pd.Series) -> list[Cell | Raw]:
    left = 100 * (float(row["after_hz"]) / float(row["test_hz"]) - 1)
    numbers = [float(row[name]) for name in ("mac", "test_hz", "before_hz", "after_hz")]
    return [
        int(row["test_mode"]),
        int(row["model_mode"]),
        *numbers,
        left,
        "yes" if row["used"] else "no",
    ]


def parameters_table(result: Update) -> Raw:
    """Return one row per parameter."""
    short = "{:.5g}".format
    columns = [
        Column("parameter"),
        Column("value", short),
        Column("± sigma", "{:.2g}".format),
        Column("unit"),
        Column("factor", "{:.4f}".format),
        Column("range"),
        Column("careful"),
    ]
    rows: list[list[Cell | Raw]] = []
    for name, p in zip(result.names, result.parameters, strict=True):
        careful = ["at the end of its range"] * p.at_bound + ["not determined by the data"] * (
            name in result.undetermined
        )
        careful += ["held by its tolerance against the data"] * (name in result.held)
        sigma = p.sigma if np.isfinite(p.sigma) else None
        limits = f"{p.low:.4g} to {p.high:.4g}"
        whose = [p.study or "shared"] if _several(result) else []
        rows.append([p.name, *whose, p.value, sigma, raised(p.unit), p.factor, limits, ", ".join(careful)])
    if _several(result):
        columns.insert(1, Column("study"))
    return table("What was updated, with one standard deviation.", columns, rows)


def _correlations(result: Update) -> Chart | None:
    """Return the correlations of the parameters; None of a single one."""
    if len(result.parameters) < 2:
        return None
    names = list(result.names)
    values = np.asarray(result.correlations, dtype=float)
    apart = np.abs(values - np.diag(np.diag(values)))
    i, j = sorted(int(k) for k in np.unravel_index(int(np.nanargmax(apart)), apart.shape))
    title = f"The most correlated parameters: {names[i]} and {names[j]}, {values[i, j]:+.2f}".replace(
        "-", "−"
    )
    text = "Correlation of the estimates in hundredths; blue rises together, orange against one another."
    return matrix_chart("correlations", title, text, values, names, names, quantity="correlation")


def _undetermined(result: Update) -> Raw:
    """Return the parameters that the data leave open."""
    if not result.undetermined:
        better = "Nothing: every parameter is known better than before."
        return element("p", "None." if result.held else better)
    return bullets(list(result.undetermined))
