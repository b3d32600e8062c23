"""How far an answer closes the gap, and what it leaves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from acquisition.display import Displayed
from acquisition.quantities import closed, percent, sigmas
from updating.diagnosis.answer.rules import DEFAULT_RULES

Metric = Literal["frequency", "damping", "frf", "combined"]


@dataclass(frozen=True)
class Closed:
    """Share of the closable gap that closes, with its 95 % interval, and what counts as nearly all [%]."""

    value: float
    low95: float
    high95: float
    nearly_all: float = DEFAULT_RULES.closes_nearly_all

    @property
    def determined(self) -> bool:
        """Whether the interval leaves out nothing, or nearly all: one that holds both is not informative."""
        return self.low95 > 0.0 or self.high95 < self.nearly_all

    def __str__(self) -> str:
        return closed(self.value, self.low95, self.high95)


@dataclass(frozen=True)
class HeldPoints:
    """R.m.s. error of the modal constants at points held out part by part [%]."""

    before: float
    after: float
    nuisance: float


@dataclass(frozen=True, kw_only=True)
class Shrink(Displayed):
    """How far the gap shrinks, on the data fitted and on modes held out in turn [%].

    Parameters
    ----------
    metric : str
        What the errors are of: frequency, damping, frf, or combined, where 100 % is one standard deviation.
    before, after : float
        R.m.s. error of the nominal model, and once the best explanation is fitted [%].
    held_before, held_after, held_runner_up, held_nuisance : float
        The same on modes held out, with the best explanation, the one behind it, and the tolerances alone, none of them
        taken further than is believed; nan where there is one mode only [%].
    floor : float
        What repeating the test alone would give [%].
    closed : Closed, optional
        Share of the closable gap that closes on modes held out; None where there is next to nothing to close.
    stretch : float
        By how much a tolerance would have to be off if tolerances alone were to explain the data [sigma].
    points : HeldPoints, optional
        The errors at points held out, where the gap shows in the FRFs.
    aside : bool
        Whether data count nowhere: those that the best explanation takes to be worse than stated, and does not explain
        either.
    """

    metric: Metric
    before: float
    after: float
    held_before: float
    held_after: float
    held_runner_up: float | None
    held_nuisance: float
    floor: float
    closed: Closed | None
    stretch: float = 0.0
    points: HeldPoints | None = None
    aside: bool = False

    @property
    def all_aside(self) -> bool:
        """Whether the best explanation closes nothing: what is left of the gap lies in data that count nowhere."""
        return self.aside and self.closed is None

    def size(self, value: float) -> str:
        """Return one of its errors [%] as text; of all data together, in standard deviations."""
        return sigmas(value / 100) if self.metric == "combined" else percent(value)


@dataclass(frozen=True)
class Remainder(Displayed):
    """What the best explanation leaves beyond noise.

    Parameters
    ----------
    significant : bool
        Whether it is more than the stated noise makes: something else is there, or something was measured worse than
        thought.
    percent : float
        R.m.s. left beyond the noise, in the metric of the gap [%].
    sigma : float
        Largest r.m.s. residual of a kind of data of a mode, or of a measuring channel [standard deviations].
    carried_by : tuple of str
        Which data carry it, most plainly first.
    """

    significant: bool
    percent: float
    sigma: float
    carried_by: tuple[str, ...]

    def _headline(self) -> str:
        if not self.significant:
            return "nothing beyond noise"
        return f"{percent(self.percent)}, {self.sigma:.0f} sigma in {', '.join(self.carried_by) or 'all data together'}"
