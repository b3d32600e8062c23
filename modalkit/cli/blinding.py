"""The command of the blind rig."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from acquisition.errors import StudyError
from modalkit.blind import BlindResult, Score, run_blind, score
from modalkit.cli.common import out, progress, show_figures, show_table
from modalkit.cli.options import Figures
from modalkit.write import write_json


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(blind)


def blind(
    study: Annotated[Path | None, typer.Argument(help="your own study (not in this version)")] = None,
    trials: Annotated[int, typer.Option(help="number of trials")] = 60,
    seed: Annotated[int, typer.Option(help="seed of the run")] = 1,
    workers: Annotated[int, typer.Option(help="trials in flight at a time")] = 2,
    json: Annotated[Path | None, typer.Option("--json", help="file for the score as JSON")] = None,
    figures: Figures = None,
) -> None:
    """Hide effects in simulated rigs, diagnose them without telling, and score the answers."""
    if study is not None:
        raise StudyError(
            f"{study}: blind trials of your own rig are not in this version; leave the study out"
        )
    result = _run(trials, seed, workers)
    table = score(result)
    show_score(table)
    if json is not None:
        write_json(json, table.to_json())
        out.print(f"written: {json}", markup=False)
    show_figures(figures, lambda: _figures(table))


def _run(trials: int, seed: int, workers: int) -> BlindResult:
    columns = (TextColumn("blind trials"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=progress) as bar:
        task = bar.add_task("trials", total=trials)
        return run_blind(trials, seed, workers=workers, progress=lambda _: bar.advance(task))


def show_score(table: Score) -> None:
    """Print the score of a blind run."""
    out.print(f"Blind run of {len(table.trials)} trials, seed {table.seed}", style="bold")
    digits = {"rate": 3, "low95": 3, "high95": 3}
    show_table(table.rates, "How often, with 95 % intervals", digits=digits)
    show_table(_answers(table.confusion), "What was hidden, and what was answered")
    failed = table.trials[table.trials["verdict"] == "failed"]
    for index, row in failed.iterrows():
        out.print(f"failed: trial {index} ({row['effect']}): {row.get('failure', '')}", markup=False)


def _answers(confusion: pd.DataFrame) -> pd.DataFrame:
    """Return the confusion matrix as lines: every hidden effect with the answers it got."""
    rows = [
        {
            "hidden": str(hidden),
            "trials": int(row.sum()),
            "answers": ", ".join(
                f"{answer} {int(n)}" for answer, n in row.sort_values(ascending=False).items() if n
            ),
        }
        for hidden, row in confusion.iterrows()
    ]
    return pd.DataFrame(rows)


def _figures(table: Score) -> dict[str, Any]:
    from modalkit.figures import blind_figure

    withheld = tuple(table.trials.loc[~table.trials["known"], "effect"].unique())
    return {"blind": blind_figure(table.confusion, table.rates, withheld=withheld)}
