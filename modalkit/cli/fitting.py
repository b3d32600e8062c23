"""The command that updates models: update."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from modalkit.cli.common import (
    check_folder,
    check_once,
    out,
    read_by,
    show_figures,
    show_table,
    show_warnings,
    working,
)
from modalkit.cli.options import Figures
from modalkit.fitting import update_studies
from modalkit.json_update import to_json
from modalkit.outputs import check_outputs, json_of
from modalkit.process import open_study
from modalkit.study import read_study
from modalkit.write import write_json
from updating.frf_update import FrfUpdate
from updating.update import Update
from updating.update.doubts import untested

if TYPE_CHECKING:
    from modalkit.figures.evolution import Course, Courses

PAIRS = {"test_hz": 3, "before_hz": 3, "after_hz": 3, "mac": 4}
PAIRS |= dict.fromkeys(("test_damping", "before_damping", "after_damping"), 5)
"""Decimals of the table of pairs."""


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(update)


def update(
    studies: Annotated[list[Path], typer.Argument(help="study file(s)")],
    shared: Annotated[str, typer.Option(help="parameters that several studies share, comma-separated")] = "",
    bootstrap: Annotated[
        int, typer.Option(min=0, max=100_000, help="draw the hits anew so often, for intervals; 0 for none")
    ] = 0,
    seed: Annotated[int, typer.Option(min=0, help="of the draws")] = 0,
    json: Annotated[Path | None, typer.Option("--json", help="file for the result as JSON")] = None,
    figures: Figures = None,
) -> None:
    """Update the parameters named in the study's update table, by eigenvalues or by FRFs."""
    check_outputs((json, json_of("modalkit.update/1")), reads=read_by(studies))
    check_folder(figures)
    check_once(studies)
    with working("reading and identifying"):
        sessions = [open_study(read_study(path), with_baseline=False) for path in studies]
    names = tuple(name.strip() for name in shared.split(",") if name.strip())
    with working("updating"):
        result = update_studies(sessions, names, draws=bootstrap, seed=seed)
    before, after = result.rms_percent("before"), result.rms_percent("after")
    state = "converged" if result.converged else "NOT converged"
    out.print(
        f"{', '.join(s.study.name for s in sessions)}: {before:.3g} % -> {after:.3g} % r.m.s., "
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
    show_figures(figures, lambda: _figures(result))


def _figures(result: Update) -> dict[str, Any]:
    from modalkit.figures import evolution_figure, frac_figure, update_figure

    pairs = result.pairs
    test = pairs["test_hz"].to_numpy()
    errors = [100 * (pairs[name].to_numpy() / test - 1) for name in ("before_hz", "after_hz")]
    factors = {
        p.name: (p.factor, p.sigma * p.factor / p.value)
        for p in result.parameters
        if p.factor is not None and np.isfinite(p.sigma) and p.value
    }
    found = {"update": update_figure(test, errors[0], errors[1], parameters=factors or None)}
    if len(result.history) > 1:
        found["evolution"] = evolution_figure("How the parameters moved", _said(result), _courses(result))
    if isinstance(result, FrfUpdate):
        points = [f"{r}/{f}" for r, f in zip(result.frac["response"], result.frac["force"], strict=True)]
        before, after = (result.frac[name].to_numpy() for name in ("before", "after"))
        title = f"The updated model lifts the mean FRAC from {before.mean():.2f} to {after.mean():.2f}"
        found["frac"] = frac_figure(title, "response/force", points, {"before": before, "after": after})
    return found


def _said(result: Update) -> str:
    """Return what stands below the title of the evolution."""
    again = " · grey: a stage begins or is taken up again" if isinstance(result, FrfUpdate) else ""
    return f"{result.iterations} iterations{again}"


def _courses(result: Update) -> list[Courses]:
    """Sort the history into panels: all factors together, what is no factor by its unit; six lines at most each."""
    from modalkit.figures.evolution import Course, Courses

    panels: dict[str, list[Course]] = {}
    repeats = tuple(np.cumsum(result.stages).tolist()) if isinstance(result, FrfUpdate) else ()
    for name, p in zip(result.names, result.parameters, strict=True):
        unit = "-" if p.factor is not None and not p.name.startswith("length") else p.unit
        panels.setdefault(unit, []).append(Course(name, result.history[name].to_numpy(), repeats=repeats))
    titles = {"-": "factors"}
    return [
        Courses(titles.get(u, lines[0].label.rpartition(".")[2]), u, tuple(lines[:6]))
        for u, lines in panels.items()
    ]
