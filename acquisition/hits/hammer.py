"""Raw time records of a hammer test, before any averaging."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from acquisition.arrays import AnyArray, frozen_array
from acquisition.display import Displayed, counted
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.form import Form
from acquisition.geometry import Geometry

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Hits(Displayed):
    """All hits at one point.

    Parameters
    ----------
    reference : Dof
        Where the hammer hit.
    responses : tuple of Dof, length n_responses
        Where the motion was measured.
    force : (n_hits, n_samples) array
        Force records, in double or, where they came so, in single precision [N].
    motion : (n_hits, n_responses, n_samples) array
        Response records, likewise [m/s^2, m/s or m, by the test's form].

    Raises
    ------
    InputError
        If the shapes disagree.
    """

    reference: Dof
    responses: tuple[Dof, ...]
    force: AnyArray
    motion: AnyArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "responses", tuple(self.responses))
        object.__setattr__(self, "force", frozen_array(self.force, keep_single=True))
        object.__setattr__(self, "motion", frozen_array(self.motion, keep_single=True))
        expected = (self.force.shape[0], len(self.responses), self.force.shape[-1])
        if self.force.ndim != 2 or self.motion.shape != expected:
            raise InputError(
                f"hits at {self.reference}: force has shape {self.force.shape} and motion "
                f"{self.motion.shape}; expected motion of shape {expected}"
            )

    @property
    def count(self) -> int:
        """Number of hits."""
        return int(self.force.shape[0])

    def _headline(self) -> str:
        seen = counted(len(self.responses), "response")
        return f"{counted(self.count, 'hit')} at {self.reference}, {seen}, {self.force.shape[-1]} samples"


@dataclass(frozen=True, eq=False)
class HammerTest(Displayed):
    """A hammer test as it was recorded.

    Parameters
    ----------
    rate : float
        Sampling rate [Hz].
    points : tuple of Hits
        The hits, one entry for each point that was hit; record lengths agree.
    form : {"receptance", "mobility", "accelerance"}
        What the response transducers measure: displacement, velocity, acceleration.
    decay : float
        Decay rate of an exponential window applied to the responses before they were stored [1/s].
    geometry : Geometry
        Nodes of the test.
    source : str
        Where the records came from, for messages.

    Raises
    ------
    InputError
        If there are no hits, the rate is not positive, or record lengths differ.
    """

    rate: float
    points: tuple[Hits, ...]
    form: Form = "accelerance"
    decay: float = 0.0
    geometry: Geometry = field(default_factory=Geometry.empty)
    source: str = "arrays"

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", tuple(self.points))
        if not self.points or not np.isfinite(self.rate) or self.rate <= 0:
            raise InputError(f"{self.source}: {len(self.points)} points hit, sampled at {self.rate} Hz")
        lengths = sorted({p.force.shape[-1] for p in self.points})
        if len(lengths) > 1:
            raise InputError(f"{self.source}: records of different lengths {lengths}; cut them to one length")

    @property
    def samples(self) -> int:
        """Samples per record."""
        return int(self.points[0].force.shape[-1])

    @property
    def duration(self) -> float:
        """Length of a record [s]."""
        return self.samples / self.rate

    def table(self) -> pd.DataFrame:
        """Return one row per entry of ``points``: the point hit, how many hits, the responses, samples."""
        import pandas as pd

        rows = [
            (str(p.reference), p.count, ", ".join(map(str, p.responses)), self.samples) for p in self.points
        ]
        return pd.DataFrame(rows, columns=["point", "hits", "responses", "samples"])

    def _headline(self) -> str:
        points, hits = len({p.reference for p in self.points}), sum(p.count for p in self.points)
        window = f", window of {self.decay:g} 1/s" if self.decay else ""
        return (
            f"{counted(hits, 'hit')} at {counted(points, 'point')}, {self.samples} samples at {self.rate:g} Hz, "
            f"for {self.form}{window}; from {self.source}"
        )
