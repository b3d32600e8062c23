"""The demonstration on shipped data."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from modalkit.cli.common import check_folder, out, show_figures, show_table
from modalkit.cli.diagnosing import diagnosis_figures, show_diagnosis
from modalkit.cli.progress import working
from modalkit.samples import sample_file
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from modalkit.workflow.stages import PREPARING
from updating import diagnose as examine


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(demo)


def demo(
    figures: Annotated[Path | None, typer.Option("--figures", help="folder for the figures")] = None,
) -> None:
    """Run the main job on shipped data: hits to modes to the cause of the gap."""
    check_folder(figures)
    study = read_study(sample_file("beam_wet/study.toml"))
    out.print(f"Study: {study.name}\n", style="bold", markup=False)
    with working(PREPARING):
        session = open_study(study)
    if session.processed is not None and session.identified is not None:
        hits = session.processed.hits
        out.print(f"{len(hits)} hits read, {sum(not h.used for h in hits)} left out. Modes identified:")
        show_table(session.identified.table())
    with working(PREPARING) as work:
        diagnosis = examine(session.case, progress=work.begin, part=work.done)
    show_diagnosis(diagnosis, session)
    show_figures(figures, lambda: diagnosis_figures(diagnosis, session))
