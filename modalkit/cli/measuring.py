"""Commands that look at a test: inspect, frf, identify."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from acquisition import (
    InputError,
    StudyError,
    UffContent,
    holds_several_hits,
    judge_hits,
    propose_layout,
    reciprocity,
    write_uff,
    written_as_uff,
)
from acquisition.columns.proposal import BEGINS
from acquisition.display import named_files
from acquisition.warned import in_order
from modalkit.cli.common import check_folder, is_study, out, read_by, show_figures, show_table, show_warnings
from modalkit.cli.options import (
    Add,
    Band,
    Decay,
    Drop,
    Estimate,
    Figures,
    Files,
    FrfWindowOption,
    Layout,
    Leave,
    Report,
    SensorMass,
    Use,
    Window,
    WindowOn,
    processing,
)
from modalkit.cli.progress import Work, reading, working
from modalkit.cli.reporting import (
    expected_damping,
    identified_report,
    named_by_hand,
    report_wanted,
    save_report,
)
from modalkit.cli.showing import (
    save_modes,
    show_hits,
    show_modes,
    show_rejected,
    show_second_opinion,
)
from modalkit.output.destinations import check_outputs, json_of, text_of, uff_of
from modalkit.output.modes import modes_kind
from modalkit.output.whole import write_text
from modalkit.workflow.existing import Modes
from modalkit.workflow.files import read_files
from modalkit.workflow.identification import read, read_frfs
from modalkit.workflow.judged_hits import numbered, stated
from modalkit.workflow.processed import Processed
from modalkit.workflow.processing_options import ProcessingOptions
from modalkit.workflow.stages import AVERAGING, IDENTIFYING, JUDGING
from modalkit.workflow.usable import usable

if TYPE_CHECKING:
    import pandas as pd

    from identification import ModalModel


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(inspect)
    app.command()(frf)
    app.command()(identify)


def inspect(
    files: Files,
    decay: Decay = 0.0,
    layout: Layout = None,
    every: Annotated[bool, typer.Option("--all", help="print one row per data set")] = False,
    write_layout: Annotated[
        Path | None,
        typer.Option(
            "--write-layout", help="write a layout with guesses, to be corrected, and read the files with it"
        ),
    ] = None,
) -> None:
    """List the content of a file, and its faults."""
    options = ProcessingOptions(decay=decay)
    if write_layout is not None:
        layout = _written_layout(files, layout, write_layout)
    with reading(JUDGING) as work:
        content = read_files(files, layout=layout, progress=work.read)
    out.print(named_files(files) + (f": {content.title}" if content.title else ""), markup=False)
    if content.datasets:
        show_table(content.table() if every else _in_short(content))
    out.print("usable: " + ("; ".join(usable(content)) or "nothing"))
    with working(JUDGING):
        long = [holds_several_hits(test) for test in content.tests]
        single = [test for test, several_hits in zip(content.tests, long, strict=True) if not several_hits]
        warnings: list[str] = []
        judged = numbered([judge_hits(stated(test, options, warnings)) for test in single])
    if any(long):
        out.print("records hold several hits each; they are split when they are used")
    for verdicts in judged:
        show_hits(verdicts)
    if content.modal is not None and len(content.modal):
        show_modes(Modes(content.modal, named_files(files)))
    bad = [d for d in content.datasets if not d.ok]
    all_bad = bool(content.datasets) and len(bad) == len(content.datasets)
    show_warnings([w for w in (*content.warnings, *warnings) if not all_bad or w != bad[0].warning])
    if all_bad:
        raise InputError(content.reasons[0])


def _written_layout(files: Sequence[Path], layout: Path | None, place: Path) -> Path:
    """Write a layout with what the files let one guess, and return where it is.

    Raises
    ------
    InputError
        If a layout is given already, or the files are no columns of numbers.
    """
    if layout is not None:
        raise InputError("--layout and --write-layout are both given; leave one out")
    check_outputs((place, text_of("a layout", "layout", ".toml", BEGINS)), reads=files)
    if uff := [path for path in files if written_as_uff(path)]:
        raise InputError(
            f"{uff[0]}: a universal file states units and points itself; leave out --write-layout"
        )
    write_text(place, propose_layout(files))
    out.print(
        f"written: {place}; each line states what was guessed and why: check it before you use it",
        markup=False,
    )
    return place


def _in_short(content: UffContent) -> pd.DataFrame:
    """Return the table of data sets with those of a kind in one row, unless there is something to say of them.

    What there is to say stands in the warnings.
    """
    from pandas import concat

    table = content.table()
    plain = table["ok"] & (table["message"] == "")
    rows = [table[~plain]]
    for _, group in table[plain].groupby(["file", "data set", "kind"], sort=False):
        row = group.iloc[[0]].copy()
        if len(group) > 1:
            row["description"] = f"{len(group)} of them, the first: " + row["description"]
        rows.append(row)
    return concat(rows).sort_values(["file", "line"], kind="stable").drop(columns="message")


def frf(
    files: Files,
    output: Annotated[Path, typer.Option("--output", "-o", help="UFF file to write")],
    decay: Decay = 0.0,
    window_on: WindowOn = None,
    window: Window = 0.0,
    estimator: Estimate = "H1",
    use: Use = None,
    leave: Leave = None,
    layout: Layout = None,
    sensor_mass: SensorMass = None,
    figures: Figures = None,
) -> None:
    """Estimate FRFs with coherence from hits, and write them as UFF."""
    check_outputs((output, uff_of("frfs")), reads=read_by(files, layout))
    check_folder(figures)
    options = processing(
        decay=decay,
        window_on=window_on,
        window=window,
        estimator=estimator,
        use=use,
        leave=leave,
        layout=layout,
        sensors=sensor_mass,
    )
    with reading(AVERAGING) as work:
        processed = read_frfs(files, processing=options, progress=work.read)
    show_hits(processed.hits)
    show_table(processed.frfs.table(), "FRFs")
    show_rejected(processed.hits)
    pairs = reciprocity(processed.frfs)
    if len(pairs):
        show_table(pairs, "Reciprocity: H_ij beside H_ji")
    write_uff(output, frfs=processed.frfs, geometry=processed.frfs.geometry, title=processed.content.title)
    out.print(f"written: {output}", markup=False)
    show_warnings(processed.warnings)
    show_figures(figures, lambda: _drawn(processed))


def identify(
    files: Annotated[list[Path], typer.Argument(help="file(s) of one test, or a study file")],
    band: Band = None,
    order: Annotated[int | None, typer.Option(help="highest model order")] = None,
    add: Add = None,
    drop: Drop = None,
    decay: Decay = 0.0,
    window_on: WindowOn = None,
    window: Window = 0.0,
    frf_window: FrfWindowOption = None,
    estimator: Estimate = "H1",
    use: Use = None,
    leave: Leave = None,
    layout: Layout = None,
    sensor_mass: SensorMass = None,
    json: Annotated[Path | None, typer.Option("--json", help="file for the modes as JSON")] = None,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="file for the modes: .uff, .csv or .json")
    ] = None,
    check: Annotated[bool, typer.Option("--check", help="also show the poles of sdypy-EMA")] = False,
    report: Report = None,
    figures: Figures = None,
) -> None:
    """Identify frequencies, damping and mode shapes with uncertainties, or show existing modes."""
    check_outputs(
        (json, json_of("modalkit.modes/1")),
        (output, modes_kind(output)),
        *report_wanted(report),
        reads=read_by(files, layout),
    )
    check_folder(figures)
    options = processing(
        decay=decay,
        window_on=window_on,
        window=window,
        estimator=estimator,
        use=use,
        leave=leave,
        layout=layout,
        sensors=sensor_mass,
        frf_window=frf_window,
    )
    with reading(IDENTIFYING) as work:
        processed, model = _identified(files, options, band, order, (add or (), drop or ()), work)
    if isinstance(model, Modes) or processed is None:
        show_modes(model)
    else:
        show_hits(processed.hits)
        show_modes(model)
        show_rejected(processed.hits, model.points_rejected)
        if check:
            show_second_opinion(processed, model)
    warnings = in_order([*(() if processed is None else processed.warnings), *model.warnings])
    show_warnings(warnings)
    save_modes(processed, model, warnings, json, output)
    save_report(report, lambda: identified_report(files, processed, model, (add or (), drop or ()), warnings))
    show_figures(figures, lambda: _identified_drawn(files, processed, model, (add or (), drop or ())))


def _identified(
    files: list[Path],
    options: ProcessingOptions,
    band: tuple[float, float] | None,
    order: int | None,
    named: tuple[Sequence[float], Sequence[float]],
    work: Work,
) -> tuple[Processed | None, ModalModel | Modes]:
    """Return FRFs and modes of files, or of a study's test; modes that exist already have no FRFs."""
    add, drop = named
    if len(files) == 1 and is_study(files[0]):
        from modalkit.study.read import read_study
        from modalkit.workflow.case import process

        if options != ProcessingOptions():
            raise StudyError(
                f"{files[0]}: these options are not for studies; state them under [test] in the study"
            )
        return process(
            read_study(files[0]),
            band=band,
            order=order,
            add=add,
            drop=drop,
            progress=work.read,
            stage=work.begin,
        )
    found = read(files, processing=options, progress=work.read)
    if not isinstance(found, Modes):
        return found, found.identify(band=band, order=order, add=add, drop=drop, progress=work.begin)
    if order is not None or add or drop:
        raise InputError(
            f"{found.source}: contains modes; --order, --add and --drop are for the identification from FRFs"
        )
    return None, found.identify(band=band)


def _identified_drawn(
    files: list[Path],
    processed: Processed | None,
    model: ModalModel | Modes,
    named: tuple[Sequence[float], Sequence[float]],
) -> dict[str, Any]:
    """Draw an identification, with the modes added and dropped by hand, and the damping that a model expects."""
    from modalkit.figures import damping_figure, stabilisation_figure

    found = _drawn(*(() if processed is None else (processed,)), model)
    if not isinstance(model, Modes):
        add, drop = named_by_hand(files, named)
        found["stabilisation"] = stabilisation_figure(model, add=add, drop=drop)
    if "damping" in found:
        found["damping"] = damping_figure(model.modal, expected_damping(files, processed, model))
    return found


def _drawn(*results: Processed | ModalModel | Modes) -> dict[str, Any]:
    from modalkit.figures import draw

    return {name: figure for result in results for name, figure in draw(result).items()}
