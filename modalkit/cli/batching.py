"""The command for many studies: batch."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import pandas as pd
import typer

from acquisition.display import counted
from acquisition.errors import EstimationError
from modalkit.batch import (
    BatchResult,
    find_studies,
    part_document,
    run_batch,
    table_places,
    tables,
    write_tables,
)
from modalkit.cli.common import check_folder, check_workers, out, read_by, show_table
from modalkit.cli.progress import working
from modalkit.output.destinations import check_outputs, json_of, store_of
from modalkit.output.whole import write_json
from modalkit.workflow.stages import SEARCHING, STUDIES

PART = json_of("modalkit.part/1")
_SHOWN = ["study", "verdict", "effects", "probability", "gap_before_percent", "gap_after_percent", "f1_hz"]


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(batch)
    app.command(hidden=True)(part)


def batch(
    folder: Annotated[Path, typer.Argument(help="folder of studies, including subfolders")],
    output: Annotated[Path, typer.Option("--output", "-o", help="table to write: .parquet or .csv")],
    workers: Annotated[int, typer.Option(help="studies run in parallel")] = 2,
    scheduler: Annotated[
        str | None, typer.Option(help="address of a Dask scheduler whose workers run the studies")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="run only studies that are new, have changed, or failed")
    ] = False,
    json_dir: Annotated[
        Path | None, typer.Option(help="folder for the results of each study as JSON")
    ] = None,
) -> None:
    """Identify, update and diagnose a folder of studies, and write modes, factors and causes as tables."""
    check_workers(workers)
    store = output.with_name(f"{output.name}.jsonl")
    places = [*table_places(output), (store, store_of("modalkit.batchrun/1"))]
    check_outputs(*places)
    check_folder(json_dir)
    with working(SEARCHING):
        studies = find_studies(folder)
    parts = [] if json_dir is None else [_part_place(json_dir, one.name) for one in studies]
    there = [(path, PART) for path in parts if path.exists()]
    check_outputs(*places, *there, reads=[path for one in studies for path in one.inputs])
    with working(STUDIES) as work:
        result = run_batch(
            studies,
            workers=workers,
            scheduler=scheduler,
            store=store,
            resume=resume,
            progress=work.counter(len(studies)),
        )
    _show(result)
    if not result.worked:
        raise EstimationError(f"{folder}: none of {counted(len(studies), 'study file')} worked")
    for path in write_tables(output, tables(result)):
        out.print(f"written: {path}", markup=False)
    if json_dir is not None:
        _write_parts(json_dir, result)
        out.print(f"written: {json_dir}", markup=False)


def part(
    study: Annotated[Path, typer.Argument(help="study file")],
    json: Annotated[Path, typer.Option("--json", help="file for the record")],
) -> None:
    """Work out one study of a batch."""
    check_outputs((json, PART), reads=read_by([study]))
    write_json(json, part_document(study))


def _part_place(folder: Path, name: str) -> Path:
    return folder / f"{name.removesuffix('.toml')}.json"


def _write_parts(folder: Path, result: BatchResult) -> None:
    for one in result.worked:
        path = _part_place(folder, one.name)
        path.parent.mkdir(parents=True, exist_ok=True)
        write_json(path, one.record or {})


def _show(result: BatchResult) -> None:
    """Print one row per study, and what was skipped, with its message."""
    frame = tables(result)[""]
    shown = pd.DataFrame({name: frame[name] for name in _SHOWN})
    text = ["verdict", "effects"]
    others = frame["candidates"].where(frame["verdict"] == "class").fillna(1) - 1
    shown["effects"] = [
        f"{name} or {counted(int(n), 'other')}" if n > 0 else name
        for name, n in zip(frame["effects"], others, strict=True)
    ]
    shown[text] = shown[text].astype("object").where(shown[text].notna(), "-")
    if len(shown):
        show_table(shown, f"{len(shown)} of {counted(len(result.parts), 'study file')}")
    for one in result.skipped:
        out.print(f"skipped: {one.name}: {one.failure}", style="yellow", markup=False)
