"""Commands of the diagnosis: diagnose, effects."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

from acquisition.display import with_reasons
from acquisition.quantities import percent
from modalkit.cli.common import (
    check_folder,
    check_once,
    names_of,
    out,
    read_by,
    show_figures,
    show_table,
    show_warnings,
)
from modalkit.cli.options import Figures, Report
from modalkit.cli.progress import working
from modalkit.cli.reporting import now, report_wanted, save_report, this_command
from modalkit.output.destinations import check_outputs, json_of
from modalkit.output.documents import diagnosis_document
from modalkit.output.how_far import without_cause
from modalkit.output.library import effects_document, effects_table
from modalkit.output.schemas.effects import EffectEntry
from modalkit.output.summary import NO_CAUSE, of_no_library_text, searched_text, separates, summary_text
from modalkit.output.whole import write_json
from modalkit.study.read import read_study
from modalkit.study.rules import read_rules
from modalkit.workflow.case import Session, open_study
from modalkit.workflow.diagnosis import diagnose_studies, warnings_of
from modalkit.workflow.stages import PREPARING
from updating import Diagnosis
from updating.diagnosis.answer.rules import DEFAULT_RULES


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(diagnose)
    app.command()(effects)


def diagnose(
    studies: Annotated[list[Path], typer.Argument(help="study file(s)")],
    shared: Annotated[
        str, typer.Option(help="effects with the same size in all studies, comma-separated")
    ] = "",
    without: Annotated[str, typer.Option(help="effects to remove from the library, comma-separated")] = "",
    rules: Annotated[
        Path | None,
        typer.Option(help="TOML file with decision rules that replace the defaults"),
    ] = None,
    json: Annotated[Path | None, typer.Option("--json", help="file for the diagnosis as JSON")] = None,
    report: Report = None,
    figures: Figures = None,
) -> None:
    """Find where the gap between test and model lies, what causes it, and how far it closes."""
    _check_places(studies, rules, json, report, figures)
    check_once(studies)
    decided_by = DEFAULT_RULES if rules is None else read_rules(rules)
    with working(PREPARING) as work:
        sessions = [open_study(read_study(path)) for path in studies]
        diagnosis = diagnose_studies(
            sessions,
            names_of(shared),
            names_of(without),
            rules=decided_by,
            progress=work.begin,
            part=work.done,
        )
    if json is not None:  # first, for a reader of what is printed may close the pipe
        write_json(json, diagnosis_document(diagnosis, warnings_of(sessions)))
    show_diagnosis(diagnosis, *sessions)
    if json is not None:
        out.print(f"written: {json}", markup=False)
    if report is not None or figures is not None:
        _draw(diagnosis, sessions, report, figures)


def _check_places(
    studies: list[Path], rules: Path | None, json: Path | None, report: Path | None, figures: Path | None
) -> None:
    """See that the results have places of their own, before work begins that would be lost."""
    check_outputs(
        (json, json_of("modalkit.diagnosis/1")), *report_wanted(report), reads=read_by(studies, rules)
    )
    check_folder(figures)


def _draw(diagnosis: Diagnosis, sessions: list[Session], report: Path | None, figures: Path | None) -> None:
    """Write the report and the figures."""
    if report is not None:
        from modalkit.report import diagnosis_report

        save_report(report, lambda: diagnosis_report(diagnosis, sessions, when=now(), command=this_command()))
    show_figures(figures, lambda: diagnosis_figures(diagnosis, *sessions))


def show_diagnosis(diagnosis: Diagnosis, *sessions: Session) -> None:
    """Print a diagnosis: five lines, then the tables."""
    out.print(diagnosis.title, style="bold", markup=False)
    for line in summary_text(diagnosis):
        out.print(line, markup=False)
    out.print()
    digits = {"test [Hz]": 3, "model [Hz]": 3, "error [%]": 3, "sigma [%]": 3, "MAC": 3}
    gap = diagnosis.gap
    modes = gap.modes if len(sessions) > 1 else gap.modes.drop(columns="study", errors="ignore")
    show_table(modes, f"Gap: {percent(gap.rms_percent)} r.m.s. over {len(gap.modes)} modes", digits=digits)
    show_table(
        _explanations(diagnosis),
        "Explanations, most probable first",
        digits={"probability": 4},
    )
    if diagnosis.next_test:
        rows = [
            {"measure next": t.measure, "separates": separates(t), "sigma": t.expected_sigma}
            for t in diagnosis.next_test
        ]
        show_table(pd.DataFrame(rows), "What to measure next")
    if other := of_no_library_text(diagnosis):
        out.print(other[:1].upper() + other[1:], markup=False)
    if any(one.sets for one in diagnosis.searched):
        out.print(f"Searched: {searched_text(diagnosis)}", markup=False)
    if diagnosis.not_examined:
        out.print("Not examined: " + with_reasons(diagnosis.not_examined), markup=False)
    show_warnings([*diagnosis.warnings, *warnings_of(sessions)])


def _explanations(diagnosis: Diagnosis) -> pd.DataFrame:
    """Return the most probable rows of the ranking, with that of no cause: where this is the answer it is the first."""
    rows = diagnosis.table().head(10).reset_index()
    aside = diagnosis.set_aside
    if diagnosis.verdict == "none":
        chance = float(f"{diagnosis.p_value:.3g}")
        first = dict(zip(rows.columns, (NO_CAUSE, without_cause(diagnosis), chance, ""), strict=True))
        return pd.concat([pd.DataFrame([first]), rows], ignore_index=True)
    if aside is None or round(aside.probability, 4) == 0.0:
        return rows
    cells = ("no cause", aside.probability, float(f"{aside.p_value:.3g}"), str(aside))
    own = dict(zip(rows.columns, cells, strict=True))
    rows = pd.concat([rows, pd.DataFrame([own])], ignore_index=True)
    return rows.sort_values("probability", ascending=False, kind="stable", ignore_index=True)


def diagnosis_figures(diagnosis: Diagnosis, *sessions: Session) -> dict[str, Any]:
    """Draw a diagnosis, and the tests it rests on."""
    from modalkit.figures.diagnosis.all import drawings

    return {name: drawing.figure for name, drawing in drawings(diagnosis, sessions).items()}


def effects(
    json: Annotated[Path | None, typer.Option("--json", help="file for the library as JSON")] = None,
    table: Annotated[
        bool, typer.Option("--table", help="print a Markdown table with one row per effect")
    ] = False,
) -> None:
    """List the effects of the library, with priors, signatures and the tests that separate them."""
    check_outputs((json, json_of("modalkit.effects/1")))
    record = effects_document()
    if json is not None:
        write_json(json, record)
        out.print(f"written: {json}", markup=False)
        return
    if table:
        typer.echo(effects_table(record), nl=False)
        return
    for effect in record["effects"]:
        show_effect(effect)
    out.print(f"\nPriors that scale with the specimen are shown for {record['specimen']}.", markup=False)


def show_effect(effect: EffectEntry) -> None:
    """Print one effect: what it is, how it shows, its priors, and what it is mistaken for."""
    out.print(f"{effect['name']} ({effect['channel']}; {', '.join(effect['models'])})", style="bold")
    out.print(f"  {effect['summary']}", markup=False)
    out.print(f"  seen as: {effect['footprint']}", markup=False)
    for p in effect["parameters"]:
        scale = "log-uniform" if p["log"] else "uniform"
        unit = "" if p["unit"] == "-" else f" {p['unit']}"
        text = f"  {p['name']}: {p['low']:.4g} to {p['high']:.4g}{unit}, {scale}: {p['why']}"
        out.print(text, markup=False)
    if effect["labels"]:
        out.print(f"  {', '.join(effect['labels'])}: node numbers of the test", markup=False)
    if effect["of_sensor"]:
        out.print('  channel: or one fixed sensor of the test, as "5+Z"', markup=False)
    if effect["not_for"]:
        out.print(f"  not for: {', '.join(effect['not_for'])}", markup=False)
    if effect["equivalent_to"]:
        out.print(f"  mistaken for: {', '.join(effect['equivalent_to'])}", markup=False)
    out.print(f"  separated by: {effect['separated_by']}", markup=False)
