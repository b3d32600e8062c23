"""Commands that bring test and model together: correlate, update, tables."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from acquisition.errors import StudyError
from modalkit.cli.common import out, show_figures, show_table, show_warnings, working
from modalkit.cli.options import Figures
from modalkit.json_update import to_json
from modalkit.process import Session, open_study
from modalkit.study import read_study
from modalkit.write import write_json, write_text
from updating.correlation import Correlation
from updating.correlation import correlate as compare
from updating.prediction import Predictor
from updating.update import Update
from updating.update import update as fit


class TableFormat(StrEnum):
    """How tables are written."""

    md = "md"
    csv = "csv"
    latex = "latex"


Json = Annotated[Path | None, typer.Option("--json", help="file for the result as JSON")]


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(correlate)
    app.command()(update)
    app.command()(tables)


def correlate(
    study: Annotated[Path, typer.Argument(help="study file")],
    figures: Figures = None,
) -> None:
    """Pair the modes of test and model and say how far they agree."""
    with working("reading and identifying"):
        session = open_study(read_study(study))
    identified = session.identified
    result = compare(session.case, None if identified is None else identified.frfs)
    pairs = result.table
    out.print(
        f"{session.study.name}: {result.rms_percent:.3g} % r.m.s. over {len(pairs)} pairs", style="bold"
    )
    show_table(pairs, digits={"test [Hz]": 3, "model [Hz]": 3, "error [%]": 3, "sigma [%]": 3, "MAC": 3})
    for table, whose in ((result.unpaired_test, "Measured"), (result.unpaired_model, "Model")):
        if len(table):
            show_table(table, f"{whose} modes without a partner")
    if len(result.frac):
        title = "FRAC per FRF (peaks that do not overlap make it near 0, however alike the shapes)"
        show_table(result.frac, title, digits={"FRAC": 3})
    show_warnings([*result.warnings, *session.warnings])
    show_figures(figures, lambda: _correlation_figures(session, result))


def update(
    studies: Annotated[list[Path], typer.Argument(help="study file(s)")],
    shared: Annotated[str, typer.Option(help="parameters that several studies share, comma-separated")] = "",
    json: Json = None,
    figures: Figures = None,
) -> None:
    """Update the parameters named in the study's update table by the identified frequencies (paper A, Eqs. 15-25)."""
    with working("reading and identifying"):
        sessions = [open_study(read_study(path)) for path in studies]
    if any(session.study.update.method != "eigenvalue" for session in sessions):
        raise StudyError('[update] method = "frf" is not in this version; use method = "eigenvalue"')
    names = tuple(name.strip() for name in shared.split(",") if name.strip())
    with working("updating"):
        result = _fit(sessions, names)
    before, after = result.rms_percent("before"), result.rms_percent("after")
    state = "converged" if result.converged else "NOT converged"
    out.print(
        f"{', '.join(s.study.name for s in sessions)}: {before:.3g} % -> {after:.3g} % r.m.s., "
        f"{state} after {result.iterations} iterations",
        style="bold",
    )
    show_table(result.table())
    show_table(result.pairs, "Pairs", digits={"test_hz": 3, "before_hz": 3, "after_hz": 3, "mac": 3})
    if result.undetermined:
        out.print("These data do not determine: " + ", ".join(result.undetermined))
    warnings = [*result.warnings, *(w for s in sessions for w in s.warnings)]
    show_warnings(warnings)
    if json is not None:
        write_json(json, to_json(result))
        out.print(f"written: {json}", markup=False)
    show_figures(figures, lambda: _update_figures(result))


def _fit(sessions: list[Session], shared: tuple[str, ...]) -> Update:
    """Update one study by its own settings, or several with the first one's weights and all shared names."""
    tables = [session.study.update for session in sessions]
    cases = [session.case for session in sessions]
    if len(cases) == 1 and not shared:
        return fit(cases[0], parameters=tables[0].parameters, weights=tables[0].weights)
    own = [list(dict.fromkeys([*table.parameters, *shared])) for table in tables]
    lists = [table.weights for table in tables if isinstance(table.weights, list)]
    if lists and len(lists) < len(tables):
        raise StudyError("[update] weights: some studies list numbers and some do not; use one kind in all")
    weights = [w for own_weights in lists for w in own_weights] if lists else tables[0].weights
    return fit(cases, parameters=own, shared=shared, weights=weights)


def tables(
    paper: Annotated[str, typer.Option(help="A: submerged structures")] = "A",
    form: Annotated[TableFormat, typer.Option("--format", help="md, csv or latex")] = TableFormat.md,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="file to write")] = None,
) -> None:
    """Make the paper's tables through the whole chain, our value beside the published one."""
    from modalkit.tables import render
    from modalkit.tables import tables as make

    with working("making the tables"):
        text = render(make(paper), form.value)
    if output is None:
        out.print(text, markup=False)
        return
    write_text(output, text + "\n")
    out.print(f"written: {output}", markup=False)


def _correlation_figures(session: Session, result: Correlation) -> dict[str, Any]:
    from modalkit.figures import mac_figure, shapes_figure

    figures = {}
    if len(result.mac):
        rows, columns = [str(i) for i in result.mac.index], [str(c) for c in result.mac.columns]
        figures["mac"] = mac_figure(result.mac.to_numpy(), rows, columns)
    if session.case.measured.has_shapes:
        predictor = Predictor(session.case.spec, session.case.measured, session.case.environment)
        figures["shapes"] = shapes_figure(session.case.measured, predictor)
    return figures


def _update_figures(result: Update) -> dict[str, Any]:
    from modalkit.figures import update_figure

    pairs = result.pairs
    test = pairs["test_hz"].to_numpy()
    errors = [100 * (pairs[name].to_numpy() / test - 1) for name in ("before_hz", "after_hz")]
    factors = {
        p.name: (p.factor, p.sigma * p.factor / p.value)
        for p in result.parameters
        if p.factor is not None and np.isfinite(p.sigma) and p.value
    }
    return {"update": update_figure(test, errors[0], errors[1], parameters=factors or None)}
