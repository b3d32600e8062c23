"""The command that makes a synthetic test of a study's model."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
import typer

from acquisition.display import counted
from modalkit.cli.common import check_folder, out, read_by, show_figures, show_table
from modalkit.cli.options import Figures
from modalkit.cli.progress import working
from modalkit.output.destinations import check_outputs, uff_of
from modalkit.simulation.setup import Options
from modalkit.simulation.simulate import SimulatedTest, simulate_test
from modalkit.study.named_effects import effects_of, parse_effect
from modalkit.study.read import kind_of, read_study
from modalkit.workflow.stages import SIMULATING
from updating import LIBRARY
from updating.effects import Effect


def add_commands(app: typer.Typer) -> None:
    """Add the commands of this module."""
    app.command()(simulate)


def simulate(
    study: Annotated[Path, typer.Argument(help="study file")],
    output: Annotated[Path, typer.Option("--output", "-o", help="UFF file to write")],
    effect: Annotated[
        list[str] | None,
        typer.Option(help="NAME or NAME:PARAM=VALUE,PARAM=VALUE, as lumped_mass:mass=20g,x=0.1; repeat"),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="seed of all scatter and noise")] = 0,
    frfs: Annotated[bool, typer.Option("--frfs", help="write averaged FRFs instead of raw hits")] = False,
    hits: Annotated[int | None, typer.Option(min=1, max=1000, help="hits at each point")] = None,
    samples: Annotated[int | None, typer.Option(min=64, max=4_194_304, help="samples per record")] = None,
    rate: Annotated[float | None, typer.Option(min=1.0, max=1e8, help="sampling rate [Hz]")] = None,
    noise: Annotated[
        float | None,
        typer.Option(
            min=0.0, max=100.0, help="r.m.s. noise of the responses, relative to their largest magnitude [-]"
        ),
    ] = None,
    points: Annotated[
        int | None, typer.Option(min=2, max=10_000, help="number of points, if the study has none")
    ] = None,
    remount: Annotated[
        bool,
        typer.Option("--remount", help="add the scatter of frequencies and level that re-mounting causes"),
    ] = False,
    figures: Figures = None,
) -> None:
    """Simulate a hammer test of a study's model, with effects added."""
    options = Options(hits=hits, samples=samples, rate=rate, noise=noise, points=points, remount=remount)
    check_outputs((output, uff_of("simulated")), reads=read_by([study]))
    check_folder(figures)
    asked = read_study(study)
    kind = "beam" if asked.model is None else kind_of(asked.model)
    there: Mapping[str, Effect] = effects_of(asked.spec()) if asked.hypothesis else LIBRARY
    effects = [parse_effect(text, kind, there) for text in effect or ()]
    with working(SIMULATING):
        made = simulate_test(asked, effects, seed=seed, options=options)
        made.write(output, as_frfs=frfs)
    _show(made, there)
    out.print(f"written: {output}", markup=False)
    show_figures(figures, lambda: _figures(made))


def _figures(made: SimulatedTest) -> dict[str, Any]:
    from modalkit.figures import frf_figure

    return {"frf": frf_figure(made.frfs())}


def _show(made: SimulatedTest, there: Mapping[str, Effect]) -> None:
    out.print(made.title, style="bold", markup=False)
    rows = [
        {"effect": name, "channel": there[name].channel, "parameter": parameter, "value": value}
        for name, values in made.effects
        for parameter, value in (values or {"-": float("nan")}).items()
    ]
    if rows:
        show_table(pd.DataFrame(rows), "Added to the study's model")
    plan, (low, high) = made.test_setup.plan, made.test_setup.band
    count = sum(len(test.points) for test in made.tests)
    out.print(
        f"{counted(plan.hits, 'hit')} at each of {counted(count, 'point')}, "
        f"{counted(len(dict.fromkeys(made.test_setup.responses)), 'response')} ({plan.form}); "
        f"{plan.samples} samples at {plan.rate:g} Hz, band {low:g} to {high:g} Hz."
    )
    noise = (
        f"{plan.response_noise:g} of each record"
        if plan.response_noise
        else f"{plan.response_floor:.3g} r.m.s."
    )
    stated = made.tests[0].decay
    out.print(
        f"Force of {plan.peak:.3g} N in {1e3 * plan.width:.3g} ms; noise {plan.force_noise:.2g} N and {noise}; "
        f"hits scatter by {1e3 * plan.position_sigma:g} mm"
        + (f"; stated window of {stated:g} 1/s" if stated else "")
        + "."
    )
    table = made.table()
    show_table(table, f"{counted(len(table), 'mode')} in the band", digits=dict.fromkeys(table.columns, 4))
    for note in made.notes:
        out.print(f"note: {note}", markup=False)
