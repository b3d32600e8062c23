"""Commands that lay test and model side by side: correlate, tables."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

from acquisition.display import counted
from acquisition.errors import InputError
from acquisition.quantities import percent
from identification import Correlation as Comparison
from modalkit.cli.common import check_folder, is_study, out, read_by, show_figures, show_table, show_warnings
from modalkit.cli.options import Figures
from modalkit.cli.progress import working
from modalkit.output.correlation import comparison_document, correlation_document
from modalkit.output.destinations import Kind, check_outputs, json_of, text_of
from modalkit.output.whole import write_json, write_text
from modalkit.study.read import read_study
from modalkit.workflow import comparison as comparing
from modalkit.workflow.case import Session, open_study
from modalkit.workflow.stages import PREPARING, TABLES
from updating.correlation.correlate import Correlation
from updating.correlation.correlate import correlate as compare
from updating.prediction.predict import Predictor


class TableFormat(StrEnum):
    """How tables are written."""

    md = "md"
    csv = "csv"
    latex = "latex"


Json = Annotated[Path | None, typer.Option("--json", help="file for the result as JSON")]


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(correlate)
    app.command()(tables)


def correlate(
    study: Annotated[Path, typer.Argument(help="study file; with OTHER also a file of modes, FRFs or hits")],
    other: Annotated[
        Path | None,
        typer.Argument(help="another test to compare with: a study, or a file of modes, FRFs or hits"),
    ] = None,
    json: Json = None,
    figures: Figures = None,
) -> None:
    """Pair the modes of test and model, or of two tests, and show how well they agree, FRFs included."""
    schema = "modalkit.correlation/1" if other is None else "modalkit.comparison/1"
    check_outputs((json, json_of(schema)), reads=read_by([s for s in (study, other) if s]))
    check_folder(figures)
    if other is not None:
        _correlate_tests(study, other, json, figures)
        return
    if not is_study(study):
        raise InputError(
            f"{study}: is not a study; name a study file, or a second test to compare this one with"
        )
    with working(PREPARING):
        session = open_study(read_study(study), with_baseline=False)
    identified = session.identified
    result = compare(session.case, None if identified is None else identified.frfs)
    pairs = result.table
    out.print(
        f"{session.study.name}: {percent(result.rms_percent)} r.m.s. over {len(pairs)} pairs", style="bold"
    )
    show_table(pairs, digits={"test [Hz]": 3, "model [Hz]": 3, "error [%]": 3, "sigma [%]": 3, "MAC": 3})
    for table, whose in ((result.unpaired_test, "Measured"), (result.unpaired_model, "Model")):
        if len(table):
            show_table(table, f"{whose} modes without a partner")
    if len(result.frac):
        title = "FRAC per FRF (near 0 where peaks do not overlap, however similar the shapes)"
        show_table(_named_frac(result.frac), title, digits={"FRAC": 3})
    if result.frfs is not None:
        out.print(f"Model's FRFs: {result.frfs.damping}.")
    show_warnings([*result.warnings, *session.warnings])
    if json is not None:
        write_json(json, correlation_document(result, session.warnings))
        out.print(f"written: {json}", markup=False)
    show_figures(figures, lambda: _correlation_figures(session, result))


def _named_frac(frac: pd.DataFrame) -> pd.DataFrame:
    """Return FRAC by points as they are written, ``81+Z``; without a column for forces that modes do not say."""
    ends = {
        end: frac[end].astype("Int64").astype(str) + frac[f"{end} direction"].fillna("")
        for end in ("response", "force")
        if frac[end].notna().any()
    }
    return pd.DataFrame(ends | {"FRAC": frac["FRAC"]})


def _correlate_tests(first: Path, second: Path, json: Path | None, figures: Path | None) -> None:
    """Lay two tests side by side."""
    with working(PREPARING):
        found = comparing.compare(first, second)
    names = {"test": "first", "test [Hz]": "first [Hz]", "model": "second", "model [Hz]": "second [Hz]"}
    table = found.table().rename(columns=names | {"error [%]": "difference [%]"})
    if not found.subspaces:
        table = table.drop(columns=["mixed with", "space"])
    digits = {"first": 0, "second": 0, "first [Hz]": 3, "second [Hz]": 3, "difference [%]": 3, "MAC": 3}
    show_table(table, f"{first} beside {second}: {counted(len(found.pairs), 'pair')}", digits=digits)
    if len(found.dofs) > 1:
        mac = comparing.mac(found.test, found.model)
        numbered = mac.set_axis([str(n) for n in range(1, mac.shape[1] + 1)], axis=1).rename_axis("mode")
        title = "MAC, first down and second across"
        show_table(numbered, title, digits=dict.fromkeys(map(str, numbered.columns), 2))
    show_warnings(found.notes)
    if json is not None:
        write_json(json, comparison_document(found))
        out.print(f"written: {json}", markup=False)
    show_figures(figures, lambda: _drawn(found))


def _drawn(found: Comparison) -> dict[str, Any]:
    from modalkit.figures import draw

    return draw(found)


def tables(
    paper: Annotated[
        str | None, typer.Option(help="A: submerged structures; B: beam with tape; default both")
    ] = None,
    form: Annotated[TableFormat, typer.Option("--format", help="md, csv or latex")] = TableFormat.md,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="file to write")] = None,
    fluid: Annotated[
        bool,
        typer.Option(
            "--fluid", help="paper A's tables in water with every variant of the computed added mass"
        ),
    ] = False,
    figures: Figures = None,
) -> None:
    """Recompute the tables of two papers from the sample data, beside the published values."""
    from modalkit.papers.render import render
    from modalkit.papers.tables import fluid_work, work

    check_outputs((output, _tables_as(form)))
    check_folder(figures)
    with working(TABLES):
        made = fluid_work(paper) if fluid else work(paper)
        text = render(made.tables(), form.value)
    if output is None:
        out.print(text, markup=False)
    else:
        write_text(output, text + "\n")
        out.print(f"written: {output}", markup=False)
    show_figures(figures, made.figures)


def _tables_as(form: TableFormat) -> Kind:
    """Return the kind of file that the papers' tables are written to."""
    endings = {TableFormat.md: ".md", TableFormat.csv: ".csv", TableFormat.latex: ".tex"}
    begins = ("## Paper ", "paper,table,", "\\begin{table}\n\\caption{Paper ")
    return text_of("tables of the papers", "tables", endings[form], *begins)


def _correlation_figures(session: Session, result: Correlation) -> dict[str, Any]:
    from modalkit.figures import mac_figure, overlay_figure, shapes_figure

    figures = {} if result.frfs is None else {"overlay": overlay_figure(result.frfs)}
    if len(result.mac):
        rows, columns = [str(i) for i in result.mac.index], [str(c) for c in result.mac.columns]
        figures["mac"] = mac_figure(result.mac.to_numpy(), rows, columns)
    if session.case.measured.has_shapes:
        predictor = Predictor(session.case.spec, session.case.measured, session.case.environment)
        figures["shapes"] = shapes_figure(session.case.measured, predictor)
    return figures
