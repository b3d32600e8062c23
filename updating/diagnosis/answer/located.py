"""Where a cause sits: the channel, the regions and the places, each with its probability."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import pandas as pd

from acquisition.display import Displayed
from acquisition.quantities import place, probability
from updating.effects.box import Place


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
    channel : str
        Of the effect that sits there.
    which : int
        Places of one channel with one number are alternatives, those of two are taken at the same time.
    """

    place: Place
    spread: Place
    probability: float
    channel: str = ""
    which: int = 0


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
