"""The 95 % set: how often it holds the truth, and how large it is."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from modalkit.blind.scoring.intervals import bootstrap, share

SIZES = (1, 2, 3, 4, 5)
"""Sizes of their own; larger ones are taken together."""


def cover_table(forecasts: pd.DataFrame, trials: pd.DataFrame, rng: np.random.Generator) -> pd.DataFrame:
    """Return coverage and size of the smallest set of rows that holds 95 %, and of the class as stated.

    Parameters
    ----------
    forecasts : pandas.DataFrame
        As :func:`modalkit.blind.scoring.calibration.forecast_table` returns them.
    trials : pandas.DataFrame
        One row per trial.
    rng : numpy.random.Generator
        For the intervals of the means.

    Returns
    -------
    pandas.DataFrame
        By ``set``: ``count`` of ``total``, ``rate`` with interval, ``mean_size`` with interval, and how many have
        each size.
    """
    of = trials.loc[forecasts.index]
    visible = of["sort"].isin(["effect", "pair"]) & of["visible"]
    stated = of[visible & of["verdict"].isin(["named", "class"])]
    rows = {
        "smallest that holds 95 %, visible effects": (
            forecasts[visible]["covers"],
            forecasts[visible]["size"],
        ),
        "smallest that holds 95 %, none and faint too": (forecasts["covers"], forecasts["size"]),
        "as stated, where an effect or a class is named": (stated["holds"], stated["sets"]),
    }
    table = [{"set": name} | _row(covers, size, rng) for name, (covers, size) in rows.items()]
    return pd.DataFrame(table)


def _row(covers: pd.Series, size: pd.Series, rng: np.random.Generator) -> dict[str, Any]:
    mean = bootstrap(size.to_numpy(float), rng)
    sizes = {f"size {n}": int((size == n).sum()) for n in SIZES}
    return (
        share(covers)
        | {"mean_size": mean["value"], "mean_low95": mean["low95"], "mean_high95": mean["high95"]}
        | sizes
        | {f"size over {SIZES[-1]}": int((size > SIZES[-1]).sum())}
    )
