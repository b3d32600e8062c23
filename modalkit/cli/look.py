"""Commands that look at a test: inspect, frf, identify."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

from acquisition import HitVerdict, hits_table, read_uff, write_uff
from identification import ModalModel
from modalkit.cli.common import is_study, out, show_figures, show_table, show_warnings, working
from modalkit.process import Processed, process, read
from modalkit.records import modes_record
from modalkit.study import read_study
from modalkit.write import write_json

Files = Annotated[list[Path], typer.Argument(help="UFF file(s); several are one test")]
Figures = Annotated[Path | None, typer.Option("--figures", help="folder for figures")]


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(inspect)
    app.command()(frf)
    app.command()(identify)


def inspect(files: Files) -> None:
    """List what is in a file, and what is wrong with it."""
    with working("reading"):
        content = read_uff(files)
    out.print(f"{', '.join(map(str, files))}: {content.title or 'no title'}", markup=False)
    show_table(content.table())
    parts = [f"{len(content.geometry.nodes)} nodes"]
    for test in content.tests:
        count = sum(p.count for p in test.points)
        parts.append(f"{count} hits at {len(test.points)} points, {test.samples} samples at {test.rate:g} Hz")
    if content.frfs is not None:
        f = content.frfs
        parts.append(
            f"{len(f.responses)} FRFs ({f.form}), {f.frequency[0]:g} to {f.frequency[-1]:g} Hz in steps of {f.df:g} Hz"
        )
    if content.modal is not None:
        parts.append(f"{len(content.modal)} modes")
    out.print("usable: " + "; ".join(parts))
    show_warnings(content.warnings)


def frf(
    files: Files,
    output: Annotated[Path, typer.Option("--output", "-o", help="UFF file to write")],
    decay: Annotated[float, typer.Option(help="decay of an exponential window in the records [1/s]")] = 0.0,
    figures: Figures = None,
) -> None:
    """Turn hits into H1 FRFs with coherence, and write them as UFF."""
    with working("averaging the hits"):
        processed = read(files, decay=decay)
    _show_hits(processed.hits)
    show_table(processed.frfs.table(), "FRFs")
    write_uff(output, frfs=processed.frfs, geometry=processed.frfs.geometry, title=processed.content.title)
    out.print(f"written: {output}", markup=False)
    show_warnings(processed.warnings)
    show_figures(figures, lambda: _frf_figures(processed))


def identify(
    files: Annotated[list[Path], typer.Argument(help="UFF file(s), or a study file")],
    band: Annotated[tuple[float, float] | None, typer.Option(help="frequency band [Hz]")] = None,
    order: Annotated[int | None, typer.Option(help="highest model order")] = None,
    json: Annotated[Path | None, typer.Option("--json", help="file for the modes as JSON")] = None,
    check: Annotated[bool, typer.Option("--check", help="also show the poles of sdypy-EMA")] = False,
    figures: Figures = None,
) -> None:
    """Identify frequencies, damping and mode shapes, with their uncertainties."""
    with working("identifying"):
        processed, model = _identified(files, band, order)
    _show_hits(processed.hits)
    table = model.table()
    digits = {"frequency [Hz]": 4, "sigma [Hz]": 5, "damping [%]": 4, "sigma [%]": 5, "MPC": 3}
    show_table(table, f"{len(model)} modes between {model.band[0]:g} and {model.band[1]:g} Hz", digits=digits)
    scaled = "mass-normalised" if model.modal.scaled else "not mass-normalised: no drive point among the FRFs"
    out.print(f"Shapes at {len(model.modal.dofs)} degrees of freedom, {scaled}.")
    if processed.frfs.decay:
        out.print(f"Window: {processed.frfs.decay:g} 1/s of decay was taken out of the damping.")
    if check:
        _show_second_opinion(model)
    warnings = [*processed.warnings, *model.warnings]
    show_warnings(warnings)
    if json is not None:
        write_json(json, modes_record(model, processed.hits, warnings))
        out.print(f"written: {json}", markup=False)
    show_figures(figures, lambda: _mode_figures(processed, model))


def _identified(
    files: list[Path], band: tuple[float, float] | None, order: int | None
) -> tuple[Processed, ModalModel]:
    if len(files) == 1 and is_study(files[0]):
        study = read_study(files[0])
        if band is None and order is None:
            return process(study)
        processed = read([study.file(f) for f in study.test.files], decay=study.test.exponential_window)
        return processed, processed.identify(band=band or study.test.band, order=order)
    processed = read(files)
    return processed, processed.identify(band=band, order=order)


def _show_hits(hits: tuple[HitVerdict, ...]) -> None:
    if not hits:
        return
    left = [h for h in hits if not h.used]
    out.print(f"{len(hits)} hits, {len(left)} left out" + (":" if left else "."))
    table = hits_table(hits)
    noted: pd.DataFrame = table[[bool(h.reasons) for h in hits]]
    if len(noted):
        show_table(noted)


def _show_second_opinion(model: ModalModel) -> None:
    from identification import second_opinion

    with working("asking sdypy-EMA"):
        table = second_opinion(model.frfs, band=model.band)
    show_table(table, "Second opinion: sdypy-EMA (LSCF)")


def _frf_figures(processed: Processed) -> dict[str, Any]:
    from modalkit.figures import frf_figure, hits_figure

    figures = {"frf": frf_figure(processed.frfs)}
    if processed.content.tests:
        figures["hits"] = hits_figure(processed.content.tests[0], processed.hits)
    return figures


def _mode_figures(processed: Processed, model: ModalModel) -> dict[str, Any]:
    from modalkit.figures import auto_mac_figure, frf_figure, hits_figure, shapes_figure, stabilisation_figure

    figures = {
        "frf": frf_figure(model.frfs, model),
        "stabilisation": stabilisation_figure(model),
        "auto_mac": auto_mac_figure(model.modal),
        "shapes": shapes_figure(model.modal),
    }
    if processed.content.tests:
        figures["hits"] = hits_figure(processed.content.tests[0], processed.hits)
    return figures
