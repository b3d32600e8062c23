"""What a diagnosis says, as records that the face turns into text, JSON and figures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import pandas as pd

from acquisition.arrays import FloatArray

Verdict = Literal["named", "class", "unknown", "none"]
Metric = Literal["frequency", "damping", "frf", "combined"]
Place = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Gap:
    """The gap between the test and the nominal model, mode by mode.

    Parameters
    ----------
    modes : DataFrame
        One row per paired mode: test and model frequency [Hz], error and sigma [%], MAC, damping ratios [-].
    rms_percent, floor_percent : float
        R.m.s. frequency error, and what noise alone would give [%].
    frac : (n_frf,) array
        Correlation of measured and predicted modal constants over the modes, per FRF [-].
    """

    modes: pd.DataFrame
    rms_percent: float
    floor_percent: float
    frac: FloatArray


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter of an effect with its 95 % interval [unit]."""

    value: float
    unit: str
    low95: float
    high95: float
    at_bound: bool


@dataclass(frozen=True, eq=False)
class Ranked:
    """One set of effects with its probability."""

    effects: tuple[str, ...]
    probability: float
    equivalents: tuple[tuple[str, ...], ...]
    parameters: dict[str, ParameterEstimate]
    plausible: bool
    p_value: float


@dataclass(frozen=True)
class Zone:
    """Probability that the cause sits in a region."""

    name: str
    center: Place
    probability: float


@dataclass(frozen=True)
class Where:
    """Where the cause sits."""

    channel: str
    channels: dict[str, float]
    location: Place | None
    locations: tuple[Place, ...]
    points: tuple[int, ...]
    zones: tuple[Zone, ...]


@dataclass(frozen=True)
class Closed:
    """Share of the closable gap that closes, with its 95 % interval [%]."""

    value: float
    low95: float
    high95: float


@dataclass(frozen=True)
class Shrink:
    """How far the gap shrinks, on the data fitted and on modes held out in turn [%]."""

    metric: Metric
    before: float
    after: float
    held_before: float
    held_after: float
    held_runner_up: float | None
    held_nuisance: float
    floor: float
    closed: Closed | None


@dataclass(frozen=True)
class NextTest:
    """A measurement, what it separates, and by how many sigma."""

    measure: str
    separates: tuple[str, ...]
    expected_sigma: float


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """The whole answer.

    Parameters
    ----------
    title : str
        Of the study.
    significant, p_value : bool, float
        Whether test and model differ by more than tolerances and noise.
    gap, where, shrink : Gap, Where, Shrink
        How large, where, and how far it closes.
    verdict : str
        named, class, unknown or none.
    sets : tuple of tuple of str
        The sets of effects that hold 95 % of the probability.
    ranking : tuple of Ranked
        All sets examined, most probable first.
    next_test : tuple of NextTest
        What to measure next.
    warnings : tuple of str
        What the reader ought to know.
    not_examined : dict of str to str
        Effects that could not be examined, and why.
    """

    title: str
    significant: bool
    p_value: float
    gap: Gap
    where: Where
    shrink: Shrink
    verdict: Verdict
    sets: tuple[tuple[str, ...], ...]
    ranking: tuple[Ranked, ...]
    next_test: tuple[NextTest, ...]
    warnings: tuple[str, ...]
    not_examined: dict[str, str]

    @property
    def effects(self) -> tuple[str, ...]:
        """Union of the sets, in the order of their probability."""
        return tuple(dict.fromkeys(name for names in self.sets for name in names))

    def table(self) -> pd.DataFrame:
        """Return the ranking, one row per set of effects."""
        rows = [
            {
                "effects": " + ".join(r.effects) or "(tolerances alone)",
                "probability": r.probability,
                "fits (p)": r.p_value,
                "parameters": ", ".join(
                    f"{n} = {e.value:.4g} [{e.low95:.4g}, {e.high95:.4g}] {e.unit}"
                    for n, e in r.parameters.items()
                ),
            }
            for r in self.ranking
        ]
        return pd.DataFrame(rows)
