"""The command that ranks the regions of a model by how far its test contradicts them: localise."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from acquisition.display import grouped, with_reasons
from acquisition.errors import InputError
from acquisition.quantities import probability
from modalkit.cli.common import check_folder, out, read_by, show_figures, show_table, show_warnings
from modalkit.cli.options import Figures
from modalkit.cli.progress import working
from modalkit.output.destinations import check_outputs, json_of
from modalkit.output.localisation import localisation_document
from modalkit.output.whole import write_json
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from modalkit.workflow.localisation import localise_study
from modalkit.workflow.stages import PREPARING, REGIONS
from updating.localisation import KINDS, METHODS, Localisation


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(localise)


def localise(
    study: Annotated[Path, typer.Argument(help="study file")],
    method: Annotated[
        list[str] | None, typer.Option(help=f"one of {', '.join(METHODS)}; repeat; default: all")
    ] = None,
    kind: Annotated[
        str, typer.Option(help=f"property of a region that may be wrong: {', '.join(KINDS)}")
    ] = KINDS[0],
    json: Annotated[Path | None, typer.Option("--json", help="file for the result as JSON")] = None,
    figures: Figures = None,
) -> None:
    """Rank the regions of the model by how far the test contradicts them, by several methods."""
    chosen = next((one for one in KINDS if one == kind), None)
    if chosen is None:
        raise InputError(f"--kind {kind}: write one of {', '.join(KINDS)}")
    for name in method or ():
        if name not in METHODS:
            raise InputError(f"--method {name}: write one of {', '.join(METHODS)}")
    check_outputs((json, json_of("modalkit.localisation/1")), reads=read_by([study]))
    check_folder(figures)
    with working(PREPARING):
        session = open_study(read_study(study))
    with working(REGIONS):
        found = localise_study(session, methods=method or tuple(METHODS), kind=chosen)
    _show(found)
    if json is not None:
        write_json(json, localisation_document(found))
        out.print(f"written: {json}", markup=False)
    show_figures(figures, lambda: _figures(found))


def _show(found: Localisation) -> None:
    """Print ranks, agreement, and what each method needs."""
    out.print(f"{found.title}: {found.consensus}", style="bold", markup=False)
    if found.spread:
        out.print(found.spread, markup=False)
    if found.unchanged is not None:
        text = (
            "Probability that no region is changed, given that at most one is: "
            f"{probability(found.unchanged)}"
        )
        out.print(text, markup=False)
    out.print()
    table = found.table()
    digits = {str(c): 4 for c in table.columns if str(c).endswith("[m]")} | {"probability": 3}
    show_table(table, f"Rank of each region if only its {found.kind} is wrong", digits=digits)
    methods = {one.method: METHODS[one.method] for one in found.found}
    for text, names in grouped(
        {n: f"{m.summary} {m.needs} {m.misleads}" for n, m in methods.items()}
    ).items():
        out.print(f"{', '.join(names)}: {text}", markup=False)
    if found.not_used:
        out.print(f"Not used: {with_reasons(found.not_used)}", markup=False)
    show_warnings(found.warnings)


def _figures(found: Localisation) -> dict[str, Any]:
    from modalkit.figures import draw

    return dict(draw(found))
