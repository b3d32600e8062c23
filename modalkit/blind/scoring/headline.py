"""The ten numbers that matter first."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import pandas as pd

from modalkit.blind.scoring.intervals import share
from modalkit.blind.scoring.places import NEAR
from modalkit.blind.scoring.rates import asked

_FROM_RATES = {
    "most probable answer is the truth": "most probable answer is the truth",
    "true up to the class it gives": "answer is true (named, in the class, or none)",
    "commits to one answer": "commits to one answer",
    "right when it commits": "right when it commits, effect of the library",
    "false alarm where nothing is hidden": "false alarm on none",
    "outside the library: unknown, or an honest equivalent": (
        "effect outside the library: unknown or an honest equivalent"
    ),
    "outside the library: given a wrong name": "effect outside the library: wrong name",
    "left out of the library: unknown, or an honest equivalent": (
        "effect left out of the library: unknown or an honest equivalent"
    ),
    "left out of the library: given a wrong name": "effect left out of the library: wrong name",
}


def headline(
    rates: pd.DataFrame,
    trials: pd.DataFrame,
    forecasts: pd.DataFrame,
    severity: pd.DataFrame,
    places: pd.DataFrame,
) -> pd.DataFrame:
    """Return the numbers to read first; those that nothing was asked of are left out.

    Parameters
    ----------
    rates, trials, forecasts, severity, places : pandas.DataFrame
        Tables of the score.

    Returns
    -------
    pandas.DataFrame
        ``count`` of ``total``, ``rate`` and its interval, by ``number``.
    """
    rows: dict[str, dict[Hashable, Any] | dict[str, Any]]
    rows = {name: rates.loc[question].to_dict() for name, question in _FROM_RATES.items()}
    effects = asked(trials).loc[forecasts.index] & (trials["sort"] != "none").loc[forecasts.index]
    rows["set of 95 % holds the truth"] = share(forecasts["covers"], effects)
    rows["parameter inside its 95 % interval"] = share(severity["covered"].dropna().astype(bool))
    rows[f"place within {100 * NEAR:.0f} % of the span"] = share(
        places["nearest"] <= NEAR, places["held"].astype(bool)
    )
    table = pd.DataFrame.from_dict(
        rows, orient="index", columns=["count", "total", "rate", "low95", "high95"]
    )
    table.index.name = "number"
    return table[table["total"] > 0]
