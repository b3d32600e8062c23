"""The command that plans a test: which effects it separates, from when on, and what to change."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd

from modalkit.cli.common import out, show_figures, show_table
from modalkit.cli.progress import working
from modalkit.cli.reporting import now, save_report, this_command
from modalkit.output.whole import write_json
from modalkit.planning import DesignForecast, Forecast, forecast
from modalkit.planning.document import family_of, severity_text, to_json
from modalkit.planning.note import brings, note, offered
from modalkit.planning.own import bench_of
from modalkit.planning.separability import NONE, SEEN, SURE
from modalkit.planning.trials import Check, check, first_to_follow
from modalkit.study.read import Study, read_study
from modalkit.workflow.stages import PLANNING, TRIALS, solving

if TYPE_CHECKING:
    from modalkit.report.document import Document

WIDEST = 20
"""So many effects still have their separations in a table that is printed; JSON, report and figure have all."""


def plan_study(
    study: Path,
    *,
    trials: int | None = None,
    seed: int | None = None,
    workers: int = 1,
    json: Path | None = None,
    figures: Path | None = None,
    report: Path | None = None,
) -> None:
    """Forecast which effects the test of a study separates, and check it by blind trials on the study's own model.

    Parameters
    ----------
    study : Path
        The study file, with data or without.
    trials : int
        Blind trials before and as many after the first advice is followed; 0 for the forecast alone [-].
    seed, workers : int
        Of the trials [-].
    json, figures, report : Path, optional
        Where to write.
    """
    own = read_study(study)
    with working(PLANNING) as work:
        bench = bench_of(own)
        work.begin(solving(bench.basis))
        found = forecast(bench)
    show_note(own.name, found)
    show_tables(found)
    document, checked = to_json(found), None
    if trials:
        checked = _checked(found, trials, 1 if seed is None else seed, workers)
        show_check(checked, found.bench.basis)
        document["trials"] = checked.to_json()
    if json is not None:
        write_json(json, document)
        out.print(f"written: {json}", markup=False)
    save_report(report, lambda: _report(own, found, checked))
    show_figures(figures, lambda: _figures(found))


def _report(study: Study, found: Forecast, checked: Check | None) -> Document:
    from modalkit.report import plan_report

    return plan_report(study, found, when=now(), command=this_command(), checked=checked)


def _checked(found: Forecast, trials: int, seed: int, workers: int) -> Check:
    runs = (1 if first_to_follow(found) is None else 2) * trials
    with working(TRIALS) as work:
        return check(found, trials, seed, workers=workers, progress=work.counter(runs))


def _figures(found: Forecast) -> dict[str, Any]:
    from modalkit.figures.charts import planning_figure

    return {"planning": planning_figure(found)}


def show_note(name: str, found: Forecast) -> None:
    """Print what a colleague would report in ten lines."""
    bench = found.bench
    out.print(name, style="bold", markup=False)
    for line in note(found):
        out.print(line, markup=False)
    out.print(f"Assumed: {'; '.join(bench.assumptions)}", markup=False)
    reasons: dict[str, list[str]] = {}
    for key, why in bench.not_forecast.items():
        reasons.setdefault(why, []).append(key)
    left = [*bench.left_out, *[f"{', '.join(keys)} ({why})" for why, keys in reasons.items()]]
    out.print(f"Omitted: {'; '.join(left)}; pairs of effects", markup=False)
    out.print()


def show_tables(found: Forecast) -> None:
    """Print thresholds, separations and changes."""
    show_table(
        _thresholds(found.now),
        f"Severities from which effects are seen and separated ({SEEN:g} sigma beyond tolerances), surely ({SURE:g})",
    )
    if len(found.now.names) <= WIDEST:
        show_table(
            _separations(found.now),
            "Separation [sigma] of each effect, at the severity asked about, from the nearest case of every other",
        )
    if offered(found):
        show_table(_changes(found), "Gain of each change", digits={"times smaller": 2, "share separated": 3})
    if idle := [one.change.measure for one in found.advice if one.worth <= 0]:
        out.print(f"Tried, without overall gain: {'; '.join(idle)}", markup=False)
        out.print()


def _thresholds(now: DesignForecast) -> pd.DataFrame:
    """Return the limits in words, those after the first as mere amounts."""
    rows = []
    for name, limit in now.limits.items():
        family = family_of(now, name)
        sizes = (limit.seen, limit.separated, limit.sure, limit.clear)
        words = [family.amount(q) if math.isfinite(q) else "never" for q in sizes]
        if not family.at:
            words[0] = severity_text(now, name, limit.seen) or "never"
        keys = ("seen from", "separated from", "surely from", "asked about")
        row = {"effect": name, **dict(zip(keys, words, strict=True))}
        rows.append({**row, "nearest": _nearest(now, name), "expected": now.outcomes[name].kind})
    return pd.DataFrame(rows)


def _nearest(now: DesignForecast, name: str) -> str:
    """Return the rival from which an effect is not separated, or hardly; else that which comes nearest to it."""
    rivals, limit = now.outcomes[name].rivals, now.limits[name]
    if not rivals:
        return f"{limit.nearest} ({limit.sigma:.1f})"
    return f"{rivals[0]} ({now.found[now.names.index(name)].clear_of(rivals[0]):.1f})"


def _separations(now: DesignForecast) -> pd.DataFrame:
    """Return the matrix with short names as columns, in whole sigma above ten."""

    def cell(value: float) -> str:
        return (
            ""
            if pd.isna(value)
            else f"{value:.1f}"
            if value < 10
            else f"{value:.0f}"
            if value < 1000
            else ">999"
        )

    table = now.matrix.map(cell)
    table.columns = [NONE, *[str(i + 1) for i in range(len(now.names))]]
    table.insert(0, "effect", [f"{i + 1} {name}" for i, name in enumerate(now.names)])
    return table.reset_index(drop=True)


def _changes(found: Forecast) -> pd.DataFrame:
    return pd.DataFrame(
        [
            {
                "change": one.change.measure,
                "newly separates": brings(one) or "-",
                "times smaller": one.factor,
                "share separated": one.after.shown_share,
            }
            for one in offered(found)
        ]
    )


def show_check(checked: Check, basis: str) -> None:
    """Print what blind trials answered beside what was forecast."""
    show_table(checked.table, f"Blind trials on {basis}: forecast and answer", digits={"sigma": 1})
    for line in checked.summary:
        out.print(line, markup=False)
