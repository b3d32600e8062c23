"""What a diagnosis states, as records that the face turns into text, JSON and figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.display import Displayed, Shown, counted
from acquisition.quantities import (
    bare_p,
    closed,
    estimate,
    percent,
    place,
    probability,
    quantity,
    sigmas,
)
from updating.diagnosis.answer.in_no_library import SomethingElse
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.search.search import Searched
from updating.effects import LIBRARY, Effect
from updating.effects.obstacles import Obstacle

Verdict = Literal["named", "class", "unknown", "none"]

Shortcoming = Literal["fit", "closing", "evidence", "partners", "one size", "library"]
"""What the most probable set lacks where none is an answer: it is rejected, closes too little and leaves more than
noise, is not clearly more likely than tolerances further off, most modes have no partner, parts of the data want
another size of it each, or a cause that is not in the library is as likely."""

Metric = Literal["frequency", "damping", "frf", "combined"]
Place = tuple[float, float, float]


SETS = 10
"""So many sets of effects are printed."""


@dataclass(frozen=True, eq=False)
class Gap(Displayed):
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

    def _headline(self) -> str:
        return (
            f"{percent(self.rms_percent)} r.m.s. frequency error over {counted(len(self.modes), 'mode')}, "
            f"noise floor {percent(self.floor_percent)}"
        )

    def _frame(self) -> pd.DataFrame:
        return self.modes


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter of an effect with its 95 % interval [unit], or what its form fixes: points, which have none.

    One that is ``aside`` matters little by itself and takes a default elsewhere, as the rotary inertia of a mass.
    """

    value: float | str | tuple[int, ...]
    unit: str
    low95: float | None
    high95: float | None
    at_bound: bool
    aside: bool = False

    def __str__(self) -> str:
        if isinstance(self.value, str):
            return self.value
        if isinstance(self.value, tuple):
            return ", ".join(map(str, self.value))
        if self.low95 is None or self.high95 is None:
            return quantity(self.value, self.unit)
        return estimate(self.value, self.unit, self.low95, self.high95)

    @property
    def whole(self) -> str:
        """Value and interval, with its level, as text."""
        if isinstance(self.value, str | tuple) or self.low95 is None or self.high95 is None:
            return str(self)
        return estimate(self.value, self.unit, self.low95, self.high95, level="95 %")

    @property
    def bare(self) -> str:
        """The value alone, as text."""
        return quantity(self.value, self.unit) if isinstance(self.value, float) else str(self)


@dataclass(frozen=True, eq=False, kw_only=True)
class Ranked(Displayed):
    """One set of effects with its probability.

    Parameters
    ----------
    effects : tuple of str
        Their names.
    probability : float
        Of the set, in all its forms [-].
    equivalents : tuple of tuple of str
        Other sets that fit as well.
    parameters : dict of str to ParameterEstimate
        Of its best form.
    plausible : bool
        Whether no parameter is at an end of its range that is a judgement.
    p_value : float
        How well it fits [-].
    forms : tuple of mapping
        What the best form fixes of each effect: the points, the region, which parameters act.
    other_forms : tuple of tuple of mapping
        The same of the other probable forms, a mirrored region for instance, the best first.
    """

    effects: tuple[str, ...]
    probability: float
    equivalents: tuple[tuple[str, ...], ...]
    parameters: dict[str, ParameterEstimate]
    plausible: bool
    p_value: float
    forms: tuple[Mapping[str, Any], ...] = ()
    other_forms: tuple[tuple[Mapping[str, Any], ...], ...] = ()

    def of(self, effect: str) -> dict[str, ParameterEstimate]:
        """Return the parameters of one of the effects by their own names."""
        start = f"{effect}."
        return {n.removeprefix(start): e for n, e in self.parameters.items() if n.startswith(start)}

    def _headline(self) -> str:
        sizes = "; ".join(f"{n} = {e}" for n, e in self.parameters.items())
        return f"{' + '.join(self.effects) or '(tolerances alone)'}, {probability(self.probability)}: {sizes}"


@dataclass(frozen=True)
class Zone:
    """Probability that the cause sits in a region."""

    name: str
    center: Place
    probability: float


@dataclass(frozen=True)
class LikelyPlace:
    """One place where a cause may sit.

    Parameters
    ----------
    place : tuple of float
        Where it most probably is [m].
    spread : tuple of float
        Standard deviation along each axis [m].
    probability : float
        Share of the explanation's probability; places taken at the same time have 1 each [-].
    """

    place: Place
    spread: Place
    probability: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Where(Displayed):
    """Where the cause sits.

    Parameters
    ----------
    channel : str
        stiffness, mass, damping, measurement, or none.
    channels : dict of str to float
        Probability of each, given that there is a cause; ``none`` is that of no cause at all [-].
    location : tuple of float, optional
        The most probable place [m].
    locations : tuple of tuple of float
        All places that hold a notable share of the probability, mirrored ones too, most probable first [m].
    points : tuple of int
        Test nodes concerned: at the places, or those named by an effect of the measurement.
    zones : tuple of Zone
        Probability of each region.
    zones_by : {"explanations", "regions"}
        Whether these rest on the places of the explanations, or, where nothing explains the gap, on the evidence of
        a change of one region alone.
    likely_places : tuple of LikelyPlace
        The locations with spread and probability.
    modes : DataFrame, optional
        What each mode adds to the gap, in standard deviations; see :mod:`updating.diagnosis.answer.contributions`.
    band : str
        One sentence on the modes and the kind of data that carry the gap.
    nearest : tuple of int
        Test nodes nearest to the places, where any are near.
    names : tuple of str
        Regions, node sets, joints and supports of the user's own model that the first explanation names.
    """

    channel: str
    channels: dict[str, float]
    location: Place | None
    locations: tuple[Place, ...]
    points: tuple[int, ...]
    zones: tuple[Zone, ...]
    zones_by: Literal["explanations", "regions"] = "explanations"
    likely_places: tuple[LikelyPlace, ...] = ()
    modes: pd.DataFrame | None = None
    band: str = ""
    nearest: tuple[int, ...] = ()
    names: tuple[str, ...] = ()

    def _headline(self) -> str:
        share = probability(self.channels.get(self.channel, 0.0))
        places = " and ".join(place(at) for at in self.locations[:3])
        return f"{self.channel} ({share})" + (f", at {places}" if places else "")


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


@dataclass(frozen=True)
class NextTest(Displayed):
    """A measurement, what it separates, and by how many sigma.

    Parameters
    ----------
    measure : str
        What to do.
    separates : tuple of str
        The effects of the explanations it separates.
    expected_sigma : float
        By how many sigma at least; nan for advice where there is nothing to separate [-].
    pairs : tuple of (set, set)
        Which explanations it separates from which.
    whole : bool
        Whether these are all that are left.
    """

    measure: str
    separates: tuple[str, ...]
    expected_sigma: float
    pairs: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = ()
    whole: bool = True


@dataclass(frozen=True, eq=False, kw_only=True)
class Diagnosis(Shown):
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
        What the reader should know.
    not_examined : dict of str to Obstacle
        Effects that could not be examined, and why.
    comparable : bool
        Whether most measured modes have a partner in the model; if not, no cause is named.
    remainder : Remainder, optional
        What the first set of the ranking leaves; None where there is no gap.
    included : dict of str to float
        Probability of each effect that it is among the causes [-].
    own : dict of str to Effect
        The study's hypotheses.
    lacks : str, optional
        What the most probable set lacks, where the verdict is unknown.
    searched : tuple of Searched
        How many sets of one cause, of two and so on were searched, and how many there are.
    something_else : SomethingElse, optional
        A cause that is in no library beside those that are; None where there is no gap, or it was not examined.
    rules : DecisionRules
        What the answer was decided by.
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
    not_examined: dict[str, Obstacle]
    comparable: bool = True
    remainder: Remainder | None = None
    included: Mapping[str, float] = field(default_factory=dict)
    own: Mapping[str, Effect] = field(default_factory=dict)
    lacks: Shortcoming | None = None
    searched: tuple[Searched, ...] = ()
    something_else: SomethingElse | None = None
    rules: DecisionRules = DEFAULT_RULES

    @property
    def suspected(self) -> Ranked | None:
        """What would most probably explain the data where some cause is likely, though chance might make the gap."""
        likely = sum(row.probability for row in self.ranking) >= self.rules.likely_all_the_same
        return self.ranking[0] if self.verdict == "none" and likely else None

    @property
    def effects(self) -> tuple[str, ...]:
        """Union of the sets, in the order of their probability; what occurs twice in one of them is there twice."""
        most: Counter[str] = Counter()
        for names in self.sets:
            most |= Counter(names)
        return tuple(most.elements())

    @property
    def known(self) -> Mapping[str, Effect]:
        """The effects of the library and the study's hypotheses, by name."""
        return {**LIBRARY, **self.own}

    def table(self) -> pd.DataFrame:
        """Return the ranking, one row per set of effects, with its probability [-] to four decimals.

        The effects are the index, so that no width of a terminal hides the probability; `ranking` has all digits.
        """
        columns = {
            "probability": [round(r.probability, 4) for r in self.ranking],
            "fits (p)": [float(f"{r.p_value:.3g}") for r in self.ranking],
            "parameters": [", ".join(f"{n} = {e}" for n, e in r.parameters.items()) for r in self.ranking],
        }
        names = [" + ".join(r.effects) or "(tolerances alone)" for r in self.ranking]
        return pd.DataFrame(columns, index=pd.Index(names, name="effects"))

    def sizes(self, *, count: int = SETS) -> pd.DataFrame:
        """Return one row per parameter of the most probable sets, in short columns that print whole.

        Parameters
        ----------
        count : int
            Number of sets.

        Returns
        -------
        DataFrame
            Probability and fit of the set [-]; value and 95 % interval of the parameter [unit]. Effects and parameter
            are the index.
        """
        rows = [
            {
                "effects": " + ".join(r.effects) or "(tolerances alone)",
                "parameter": name,
                "probability": f"{r.probability:.4f}",
                "fits (p)": bare_p(r.p_value),
                "size": "" if size is None else str(size),
            }
            for r in self.ranking[:count]
            for name, size in r.parameters.items() or [("", None)]
        ]
        columns = ["effects", "parameter", "probability", "fits (p)", "size"]
        return pd.DataFrame(rows, columns=columns).set_index(["effects", "parameter"])

    def __str__(self) -> str:
        """Return one line, and the sizes below it, nothing cut."""
        if not self.ranking:
            return self._headline()
        rows = self.sizes().reset_index()
        again = rows["effects"].duplicated()
        rows[["effects", "probability", "fits (p)"]] = rows[["effects", "probability", "fits (p)"]].mask(
            again, ""
        )
        return f"{self._headline()}\n{rows.to_string(index=False, justify='left', max_colwidth=None)}"

    def _headline(self) -> str:
        which = " | ".join(" + ".join(names) for names in self.sets)
        return f"{self.title}: {self.verdict}{f' ({which})' if which else ''}; {self.gap._headline()}"
