"""The command that updates models: update."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acquisition.quantities import percent
from modalkit.cli.common import (
    check_folder,
    check_once,
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
from modalkit.output.update import to_json
from modalkit.output.whole import write_json
from modalkit.study.read import read_study
from modalkit.workflow.case import Session, open_study
from modalkit.workflow.stages import PREPARING
from modalkit.workflow.update import update_studies
from updating.frf_update import FrfUpdate
from updating.update import Update
from updating.update.statistics.doubts import untested

if TYPE_CHECKING:
    from modalkit.report.document import Document

PAIRS = {"test_hz": 3, "before_hz": 3, "after_hz": 3, "mac": 4, "shape_sigma": 3}
PAIRS |= dict.fromkeys(("test_damping", "before_damping", "after_damping"), 5)
"""Decimals of the table of pairs."""


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(update)


def update(
    studies: Annotated[list[Path], typer.Argument(help="study file(s)")],
    shared: Annotated[str, typer.Option(help="parameters that several studies share, comma-separated")] = "",
    bootstrap: Annotated[
        int,
        typer.Option(
            min=0, max=100_000, help="number of bootstrap draws of the hits, for intervals; 0: none"
        ),
    ] = 0,
    seed: Annotated[int, typer.Option(min=0, help="seed of the bootstrap draws")] = 0,
    json: Annotated[Path | None, typer.Option("--json", help="file for the result as JSON")] = None,
    report: Report = None,
    figures: Figures = None,
) -> None:
    """Update the parameters that the study lists for updating, by frequencies or by FRFs."""
    check_outputs((json, json_of("modalkit.update/1")), *report_wanted(report), reads=read_by(studies))
    check_folder(figures)
    check_once(studies)
    names = tuple(name.strip() for name in shared.split(",") if name.strip())
    with working(PREPARING) as work:
        sessions = [open_study(read_study(path), with_baseline=False) for path in studies]
        result = update_studies(
            sessions, names, draws=bootstrap, seed=seed, progress=work.begin, part=work.done
        )
    before, after = result.rms_percent("before"), result.rms_percent("after")
    state = "converged" if result.converged else "NOT converged"
    out.print(
        f"{', '.join(s.study.name for s in sessions)}: {percent(before)} -> {percent(after)} r.m.s., "
        f"{state} after {result.iterations} iterations",
        style="bold",
    )
    if result.dof <= 0:
        out.print(untested(result.data, len(result.parameters)), style="bold", markup=False)
    out.print(result.report(), markup=False)
    out.print()
    show_table(result.pairs, "Pairs", digits=PAIRS)
    if isinstance(result, FrfUpdate):
        show_table(result.frac, "FRAC per FRF", digits=dict.fromkeys(result.frac.columns[2:], 3))
    show_warnings([*result.warnings, *(w for s in sessions for w in s.warnings)])
    if json is not None:
        write_json(json, to_json(result))
        out.print(f"written: {json}", markup=False)
    save_report(report, lambda: _report(result, sessions))
    show_figures(figures, lambda: _figures(result))


def _report(result: Update, sessions: list[Session]) -> Document:
    from modalkit.report import update_report

    return update_report(result, sessions, when=now(), command=this_command())


def _figures(result: Update) -> dict[str, Any]:
    from modalkit.figures import draw

    return dict(draw(result))
