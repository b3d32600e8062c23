"""All there is to see of an update: errors and parameters, how these moved, and FRAC where FRFs were updated."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from acquisition.quantities import raised
from modalkit.figures.update.errors import update_figure
from modalkit.figures.update.evolution import Course, Courses, evolution_figure
from modalkit.figures.update.frac import frac_figure
from updating.frf_update import FrfUpdate
from updating.update import Update
from updating.update.estimate import Estimate

LINES = 6
"""Most lines in a panel of the evolution; doubled, their labels touch."""


def update_figures(result: Update) -> dict[str, Figure]:
    """Draw an update: errors of the frequencies before and after, parameters with their sigma, and how they moved.

    Parameters
    ----------
    result : Update
        By frequencies, or by FRFs.

    Returns
    -------
    dict of str to Figure
        ``update``, one more (``update_2``, ...) for each further study; ``evolution`` if anything moved; ``frac`` of
        an update by FRFs.
    """
    studies = list(dict.fromkeys(result.pairs["study"]))
    names = ["update"] + [f"update_{n}" for n in range(2, len(studies) + 1)]
    found = {
        name: _errors(result, result.pairs[result.pairs["study"] == study], study, alone=len(studies) == 1)
        for name, study in zip(names, studies, strict=False)
    }
    if len(result.history) > 1:
        found["evolution"] = evolution_figure(
            "How the parameters moved", _iterations(result), _courses(result)
        )
    if isinstance(result, FrfUpdate):
        points = [f"{r}/{f}" for r, f in zip(result.frac["response"], result.frac["force"], strict=True)]
        before, after = (result.frac[name].to_numpy() for name in ("before", "after"))
        title = f"The updated model lifts the mean FRAC from {before.mean():.2f} to {after.mean():.2f}"
        found["frac"] = frac_figure(title, "response/force", points, {"before": before, "after": after})
    return found


def _errors(result: Update, pairs: pd.DataFrame, study: str, *, alone: bool) -> Figure:
    """Draw the errors of one study, and the parameters that are its own or shared."""
    test = pairs["test_hz"].to_numpy()
    before, after = (100 * (pairs[name].to_numpy() / test - 1) for name in ("before_hz", "after_hz"))
    own = [p for p in result.parameters if alone or p.study in (None, study)]
    factors = {
        p.name: (p.factor, p.sigma * p.factor / p.value) for p in own if p.factor is not None and p.value
    }
    others = [_value(p) for p in own if p.factor is None]
    return update_figure(
        test, before, after, parameters=factors or None, title="  ·  ".join([str(study), *others])
    )


def _value(p: Estimate) -> str:
    spread = f" ± {p.sigma:.2g}" if np.isfinite(p.sigma) else ", not determined by the data"
    return f"{p.name} = {p.value:.4g}{spread} {'' if p.unit == '-' else raised(p.unit)}".rstrip()


def _iterations(result: Update) -> str:
    """Return what stands below the title of the evolution."""
    again = " · grey: a stage begins or is taken up again" if isinstance(result, FrfUpdate) else ""
    return f"{result.iterations} iterations{again}"


def _courses(result: Update) -> list[Courses]:
    """Sort the history into panels: all factors together, what is no factor by its unit; six lines at most each."""
    panels: dict[str, list[Course]] = {}
    titles = {"-": "factors"}
    repeats = tuple(np.cumsum(result.stages).tolist()) if isinstance(result, FrfUpdate) else ()
    for name, p in zip(result.names, result.parameters, strict=True):
        unit = "-" if p.relative else p.unit
        titles.setdefault(unit, p.quantity.replace("_", " "))
        panels.setdefault(unit, []).append(Course(name, result.history[name].to_numpy(), repeats=repeats))
    return [Courses(titles[u], u, tuple(lines[:LINES])) for u, lines in panels.items()]
