"""All there is to see of an update: errors and parameters, how these moved, and FRAC where FRFs were updated."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from acquisition.quantities import raised
from modalkit.figures.chart import chart_figure, sheet_figure
from modalkit.figures.charts import update_figure
from modalkit.views.charts.update import course_sheet, factors_of, frac_of
from updating.frf_update import FrfUpdate
from updating.update import Update
from updating.update.estimate import Estimate


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
    if (courses := course_sheet(result)).charts:
        found["evolution"] = sheet_figure(courses, columns=1, tall=2.2)
    if isinstance(result, FrfUpdate):
        found["frac"] = chart_figure(frac_of(result))
    return found


def _errors(result: Update, pairs: pd.DataFrame, study: str, *, alone: bool) -> Figure:
    """Draw the errors of one study, and the parameters that are its own or shared."""
    test = pairs["test_hz"].to_numpy()
    before, after = (100 * (pairs[name].to_numpy() / test - 1) for name in ("before_hz", "after_hz"))
    own = [p for p in result.parameters if p.factor is None and (alone or p.study in (None, study))]
    title = "  ·  ".join([str(study), *map(_value, own)])
    factors = factors_of(result, None if alone else study)
    return update_figure(test, before, after, parameters=factors or None, title=title)


def _value(p: Estimate) -> str:
    spread = f" ± {p.sigma:.2g}" if np.isfinite(p.sigma) else ", not determined by the data"
    return f"{p.name} = {p.value:.4g}{spread} {'' if p.unit == '-' else raised(p.unit)}".rstrip()
