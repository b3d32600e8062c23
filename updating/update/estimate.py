"""One updated parameter, with its uncertainty and its bounds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One updated parameter.

    Parameters
    ----------
    name : str
        Name as the user wrote it.
    study : str or None
        Study it belongs to; None where it is shared by several.
    value : float
        Value after the update [``unit``].
    unit : str
        Its unit.
    factor : float or None
        Value over nominal value; None for what is no factor [-].
    sigma : float
        Standard deviation of ``value`` [``unit``], its r.m.s. error where several solutions explain the data about
        as well; infinite where the data do not determine it.
    at_bound : bool
        Whether the value stands at the end of its range.
    low, high : float
        The range [``unit``].
    initial : float
        Value before the update [``unit``].
    interval : tuple of float, optional
        Ends of the 95 % interval: 2.5 and 97.5 percentiles of a bootstrap, or, where several solutions explain the
        data about as well, of the mixture of all [``unit``].
    relative : bool
        Whether its course over the iterations is that of the factor, not of the value.
    quantity : str
        What is updated, without where or of which effect: ``alpha`` of ``root.alpha``.
    """

    name: str
    study: str | None
    value: float
    unit: str
    factor: float | None
    sigma: float
    at_bound: bool
    low: float
    high: float
    initial: float = np.nan
    interval: tuple[float, float] | None = None
    relative: bool = False
    quantity: str = ""
