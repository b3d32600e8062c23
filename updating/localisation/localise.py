"""Every method on one test beside one model: which region each puts first, and how far they agree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import rankdata

from acquisition.arrays import FloatArray
from acquisition.display import Displayed, with_reasons
from acquisition.errors import InputError
from updating.localisation.base import Kind, Localiser
from updating.localisation.comac import Comac
from updating.localisation.evidence import RegionEvidence
from updating.localisation.force_residual import ForceResidual
from updating.localisation.mece import ConstitutiveError
from updating.localisation.places import centres
from updating.localisation.subspace import BestSubspace
from updating.problem.specimen import SpecimenProblem

METHODS: Mapping[str, Localiser] = {
    "evidence": RegionEvidence(),
    "subspace": BestSubspace(),
    "subspace-plain": BestSubspace(nuisances=False),
    "mece": ConstitutiveError(),
    "force-serep": ForceResidual("serep"),
    "force-dynamic": ForceResidual("dynamic"),
    "comac": Comac(),
}
"""All methods by name, the most often right first (``benchmarks/bench_localisation.py``)."""


@dataclass(frozen=True, eq=False)
class Ranked:
    """What one method finds.

    Parameters
    ----------
    method : str
        Its name in ``METHODS``.
    scores : (n_regions,) array
        The greater the more suspect; of ``evidence`` the probability that the region is changed [-].
    """

    method: str
    scores: FloatArray

    @property
    def ranks(self) -> FloatArray:
        """Rank of each region from 1, the mean rank of those that score alike, (n_regions,) [-]."""
        return np.asarray(rankdata(-self.scores))

    @property
    def first(self) -> int | None:
        """Index of the region that it suspects the most; None where several score as high."""
        top = np.flatnonzero(self.scores == self.scores.max())
        return int(top[0]) if len(top) == 1 else None


@dataclass(frozen=True, eq=False)
class Localisation(Displayed):
    """In which region of a model an error sits, by each method.

    Parameters
    ----------
    title : str
        The study's.
    kind : {"stiffness", "mass", "damping"}
        What of a region may be wrong.
    regions : tuple of str
        Names of the regions.
    centres : (n_regions, d) array
        Their centres in as many coordinates as a place on the model has [m].
    found : tuple of Ranked
        One of each method that can be used, in the order of ``METHODS``.
    not_used : mapping of str to str
        Why each other method that was asked for cannot be used.
    warnings : tuple of str
        What the user should know.
    """

    title: str
    kind: Kind
    regions: tuple[str, ...]
    centres: FloatArray
    found: tuple[Ranked, ...]
    not_used: Mapping[str, str]
    warnings: tuple[str, ...] = ()

    def table(self) -> pd.DataFrame:
        """Return the rank of each region by each method, and its probability by the evidence.

        Those that the first method suspects the most come first.
        """
        places = {f"{axis} [m]": self.centres[:, i] for i, axis in enumerate("xyz"[: self.centres.shape[1]])}
        ranks = {one.method: one.ranks for one in self.found}
        table = pd.DataFrame({"region": self.regions, **places, **ranks})
        if (by_evidence := self._of("evidence")) is not None:
            table["probability"] = by_evidence.scores
        return table.sort_values(self.found[0].method, kind="stable", ignore_index=True)

    @property
    def concordance(self) -> float | None:
        """Kendall's W of the methods: 1 where all rank alike, 1 / (number of methods) by chance; None of one [-].

        Kendall and Babington Smith (1939), Ann. Math. Stat. 10, 275, with the correction for equal ranks.
        """
        m, n = len(self.found), len(self.regions)
        if m < 2:
            return None
        ranks = np.array([one.ranks for one in self.found])
        counts = [np.unique(row, return_counts=True)[1] for row in ranks]
        equal = sum(int(np.sum(count**3 - count)) for count in counts)
        spread = np.sum((ranks.sum(axis=0) - m * (n + 1) / 2) ** 2)
        return float(12 * spread / (m**2 * (n**3 - n) - m * equal))

    @property
    def favourite(self) -> tuple[int, int]:
        """Index of the region that most methods put first, of equals that of the better method, and how many do."""
        first = [one.first for one in self.found if one.first is not None]
        if not first:
            return int(np.argmax(self.found[0].scores)), 0
        best = max(first, key=first.count)
        return best, first.count(best)

    @property
    def unchanged(self) -> float | None:
        """Probability of no change beside one of any region; None without ``evidence`` [-]."""
        found = self._of("evidence")
        return None if found is None else float(max(0.0, 1.0 - found.scores.sum()))

    def _of(self, method: str) -> Ranked | None:
        return next((one for one in self.found if one.method == method), None)

    @property
    def consensus(self) -> str:
        """Which region most methods put first, in words."""
        best, count = self.favourite
        return f"{count} of {len(self.found)} methods put {self.regions[best]} first"

    @property
    def spread(self) -> str:
        """How far the methods agree, in words; empty for one method."""
        if self.concordance is None:
            return ""
        chance = 1 / len(self.found)
        return f"Kendall's W of the ranks: {self.concordance:.2f} (1: all rank alike; {chance:.2f}: chance)"

    def _headline(self) -> str:
        return f"{self.title}: {self.consensus} by {self.kind}"


def localise(
    problem: SpecimenProblem,
    *,
    methods: Sequence[str] = tuple(METHODS),
    kind: Kind = "stiffness",
    title: str = "",
    warnings: Sequence[str] = (),
) -> Localisation:
    """State which region of a model each method suspects.

    Parameters
    ----------
    problem : SpecimenProblem
        A test beside a model.
    methods : sequence of str
        Names in ``METHODS``.
    kind : {"stiffness", "mass", "damping"}
        What of a region may be wrong.
    title, warnings : str, sequence of str
        The study's.

    Returns
    -------
    Localisation

    Raises
    ------
    InputError
        If there is no such method, or none can be used on this model and this test.
    """
    if unknown := [name for name in methods if name not in METHODS]:
        raise InputError(f"no method {unknown[0]!r}; there are {', '.join(METHODS)}")
    spec = problem.predictor.spec
    if (why := _undivided(problem, kind)) is not None:
        raise InputError(f"{title}: there are no regions to compare: {why}")
    found, not_used = [], {}
    for name in (name for name in METHODS if name in methods):
        why = METHODS[name].obstacle(problem, kind=kind)
        scores = np.zeros(len(spec.regions)) if why else METHODS[name].scores(problem, kind=kind)
        if why is None and not np.ptp(scores) > 0:
            why = "all regions score alike"
        if why is None:
            found.append(Ranked(name, scores))
        else:
            not_used[name] = why
    if not found:
        raise InputError(f"{title}: no method can compare the {kind} of regions: {with_reasons(not_used)}")
    names = tuple(region.name for region in spec.regions)
    return Localisation(
        title, kind, names, centres(problem)[:, : spec.dim], tuple(found), not_used, tuple(warnings)
    )


def _undivided(problem: SpecimenProblem, kind: Kind) -> str | None:
    """Return why a model has no regions that can be changed one by one, or None."""
    spec = problem.predictor.spec
    if spec.imported is not None:
        why = spec.imported.obstacle("density" if kind == "mass" else "E", regional=True)
        if why is not None:
            return why
    if len(spec.regions) < 2:
        return "the model has one region; divide it by [[model.region]], on a deck by element sets"
    return None
