"""Commands that look at a test: inspect, frf, identify."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

from acquisition import (
    HitVerdict,
    InputError,
    StudyError,
    UffContent,
    hits_table,
    judge_hits,
    looks_long,
    reciprocity,
    write_uff,
)
from identification import ModalModel
from modalkit.cli.common import (
    is_study,
    out,
    reading,
    several,
    show_figures,
    show_table,
    show_warnings,
    working,
)
from modalkit.cli.options import (
    Decay,
    Estimate,
    Figures,
    Files,
    Layout,
    Leave,
    Use,
    Window,
    WindowOn,
    handling,
)
from modalkit.handling import Handling
from modalkit.process import process
from modalkit.reading import Processed, read, read_files
from modalkit.records import modes_record
from modalkit.study import read_study
from modalkit.write import write_json


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(inspect)
    app.command()(frf)
    app.command()(identify)


def inspect(
    files: Files,
    layout: Layout = None,
    every: Annotated[bool, typer.Option("--all", help="a row for every data set")] = False,
) -> None:
    """List what is in a file, and what is wrong with it."""
    with reading() as progress:
        content = read_files(files, layout=layout, progress=progress)
    out.print(f"{', '.join(map(str, files))}: {content.title or 'no title'}", markup=False)
    if content.datasets:
        show_table(content.table() if every else _in_short(content))
    out.print("usable: " + ("; ".join(_usable(content)) or "nothing"))
    for test in content.tests:
        if looks_long(test):
            out.print("records hold several hits each; they are split when they are used")
        else:
            _show_hits(judge_hits(test))
    show_warnings(content.warnings)
    bad = [d for d in content.datasets if not d.ok]
    if content.datasets and len(bad) == len(content.datasets):
        raise InputError(f"{bad[0].place}: {bad[0].message}")


def _in_short(content: UffContent) -> pd.DataFrame:
    """Return the table of data sets with those of a kind in one row, unless there is something to say of them."""
    table = content.table()
    plain = table["ok"] & (table["message"] == "")
    rows = [table[~plain]]
    for _, group in table[plain].groupby(["file", "data set", "kind"], sort=False):
        row = group.iloc[[0]].copy()
        if len(group) > 1:
            row["description"] = f"{len(group)} of them, the first: " + row["description"]
        rows.append(row)
    return pd.concat(rows).sort_values(["file", "line"], kind="stable")


def _usable(content: UffContent) -> list[str]:
    parts = [several(len(content.geometry.nodes), "node")] if content.geometry.nodes else []
    for test in content.tests:
        count = sum(p.count for p in test.points)
        where = several(len({p.reference for p in test.points}), "point")
        parts.append(f"{several(count, 'hit')} at {where}, {test.samples} samples at {test.rate:g} Hz")
    if content.frfs is not None:
        f = content.frfs
        span = f"{f.frequency[0]:g} to {f.frequency[-1]:g} Hz in steps of {f.df:g} Hz"
        parts.append(f"{several(len(f.responses), 'FRF')} ({f.form}), {span}")
    if content.modal is not None:
        parts.append(several(len(content.modal), "mode"))
    return parts


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
    figures: Figures = None,
) -> None:
    """Turn hits into FRFs with coherence, and write them as UFF."""
    said = handling(
        decay=decay,
        window_on=window_on,
        window=window,
        estimator=estimator,
        use=use,
        leave=leave,
        layout=layout,
    )
    with reading("averaging the hits") as progress:
        processed = read(files, handling=said, progress=progress)
    _show_hits(processed.hits)
    show_table(processed.frfs.table(), "FRFs")
    pairs = reciprocity(processed.frfs)
    if len(pairs):
        show_table(pairs, "Reciprocity: H_ij beside H_ji")
    write_uff(output, frfs=processed.frfs, geometry=processed.frfs.geometry, title=processed.content.title)
    out.print(f"written: {output}", markup=False)
    show_warnings(processed.warnings)
    show_figures(figures, lambda: _frf_figures(processed))


def identify(
    files: Annotated[list[Path], typer.Argument(help="file(s) of one test, or a study file")],
    band: Annotated[tuple[float, float] | None, typer.Option(help="frequency band [Hz]")] = None,
    order: Annotated[int | None, typer.Option(help="highest model order")] = None,
    add: Annotated[list[float] | None, typer.Option(help="keep a mode here [Hz]; repeat")] = None,
    drop: Annotated[list[float] | None, typer.Option(help="this is no mode [Hz]; repeat")] = None,
    decay: Decay = 0.0,
    window_on: WindowOn = None,
    window: Window = 0.0,
    estimator: Estimate = "H1",
    use: Use = None,
    leave: Leave = None,
    layout: Layout = None,
    json: Annotated[Path | None, typer.Option("--json", help="file for the modes as JSON")] = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="UFF file for the modes")] = None,
    check: Annotated[bool, typer.Option("--check", help="also show the poles of sdypy-EMA")] = False,
    figures: Figures = None,
) -> None:
    """Identify frequencies, damping and mode shapes, with their uncertainties."""
    said = handling(
        decay=decay,
        window_on=window_on,
        window=window,
        estimator=estimator,
        use=use,
        leave=leave,
        layout=layout,
    )
    with reading("identifying") as progress:
        if len(files) == 1 and is_study(files[0]):
            if said != Handling():
                raise StudyError(
                    f"{files[0]}: a study says in [test] how its files are treated; write it there"
                )
            processed, model = process(
                read_study(files[0]),
                band=band,
                order=order,
                add=add or (),
                drop=drop or (),
                progress=progress,
            )
        else:
            processed = read(files, handling=said, progress=progress)
            model = processed.identify(band=band, order=order, add=add or (), drop=drop or ())
    _show_hits(processed.hits)
    _show_modes(model)
    if check:
        _show_second_opinion(processed, model)
    warnings = [*processed.warnings, *model.warnings]
    show_warnings(warnings)
    if json is not None:
        write_json(json, modes_record(model, processed.hits, warnings))
        out.print(f"written: {json}", markup=False)
    if output is not None:
        write_uff(output, modal=model.modal, geometry=model.modal.geometry, title=processed.content.title)
        out.print(f"written: {output}", markup=False)
    show_figures(figures, lambda: _mode_figures(processed, model))


def _show_modes(model: ModalModel) -> None:
    digits = {"frequency [Hz]": 4, "sigma [Hz]": 5, "damping [%]": 4, "sigma [%]": 5, "MPC": 3}
    title = f"{several(len(model), 'mode')} between {model.band[0]:g} and {model.band[1]:g} Hz"
    show_table(model.table(), title, digits=digits)
    scaled = "mass-normalised" if model.modal.scaled else "not mass-normalised: no drive point among the FRFs"
    out.print(f"Shapes at {several(len(model.modal.dofs), 'degree')} of freedom, {scaled}.")
    if model.frfs.decay:
        out.print(f"Window: {model.frfs.decay:.4g} 1/s of decay was taken out of the damping.")


def _show_hits(hits: tuple[HitVerdict, ...]) -> None:
    if not hits:
        return
    left = [h for h in hits if not h.used]
    out.print(f"{several(len(hits), 'hit')}, {len(left)} left out" + (":" if left else "."))
    table = hits_table(hits)
    noted: pd.DataFrame = table[[bool(h.reasons) for h in hits]]
    if len(noted):
        show_table(noted)


def _show_second_opinion(processed: Processed, model: ModalModel) -> None:
    from identification import beside, second_opinion

    with working("asking sdypy-EMA"):
        table = second_opinion(processed.frfs, band=model.band)
    both = beside(model.modal, table)
    title = "Second opinion, beside ours: sdypy-EMA (LSCF)"
    show_table(both, title, digits=dict.fromkeys(both.columns, 4))
    show_warnings(table.attrs.get("warnings", ()))


def _frf_figures(processed: Processed) -> dict[str, Any]:
    from modalkit.figures import frf_figure

    return {"frf": frf_figure(processed.frfs), **_hit_figures(processed)}


def _hit_figures(processed: Processed) -> dict[str, Any]:
    from modalkit.figures import hits_figure

    names = ["hits"] + [f"hits_{n}" for n in range(2, len(processed.judged) + 1)]
    return {n: hits_figure(j.test, j.verdicts) for n, j in zip(names, processed.judged, strict=False)}


def _mode_figures(processed: Processed, model: ModalModel) -> dict[str, Any]:
    from modalkit.figures import auto_mac_figure, frf_figure, shapes_figure, stabilisation_figure

    return {
        "frf": frf_figure(model.frfs, model),
        "stabilisation": stabilisation_figure(model),
        "auto_mac": auto_mac_figure(model.modal),
        "shapes": shapes_figure(model.modal),
        **_hit_figures(processed),
    }
