"""Best subspace: which region's sensitivities hold most of the error vector, alone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.gaussian import marginal, normal_equations
from updating.localisation.base import KINDS, Kind, Localiser
from updating.localisation.changes import columns
from updating.models.state import NOMINAL
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True)
class BestSubspace(Localiser):
    """How far the error shrinks by the best linear change of each region alone.

    Parameters
    ----------
    nuisances : bool
        Whether tolerances, calibration, damping and positions are projected out first.
    """

    summary: ClassVar[str] = (
        "How far the best change of one region alone reduces the weighted error, once tolerances, calibration and the "
        "like are projected out (subspace-plain: without that)."
    )
    needs: ClassVar[str] = "Needs frequencies, and shapes to separate mirrored regions."
    misleads: ClassVar[str] = (
        "Misleads where a change is large, since sensitivities are those of the nominal model; subspace-plain also "
        "where the whole model is off within its tolerances."
    )
    source: ClassVar[str] = "Lallement and Piranda (1990), Proc. IMAC 8; Friswell, Garvey and Penny (1997)"
    kinds: ClassVar[tuple[Kind, ...]] = KINDS
    needs_shapes: ClassVar[bool] = False

    nuisances: bool = True

    def scores(self, problem: SpecimenProblem, *, kind: Kind = "stiffness") -> FloatArray:
        """Return the share of the squared error that each region removes, (n_regions,) [-]."""
        comparison = problem.compare(NOMINAL)
        if not self.nuisances:
            comparison = replace(comparison, nuisance=comparison.nuisance[:, :0])
        scale = marginal(comparison).scale
        normal, load = normal_equations(comparison, columns(problem, kind), scale)
        power = np.diag(normal)
        gain = np.where(
            power > 1e-12 * max(power.max(initial=0.0), 1e-300), load**2 / np.maximum(power, 1e-300), 0.0
        )
        total, _ = normal_equations(comparison, comparison.residual[:, None], scale)
        if kind == "damping":
            gain = np.where(load > 0, gain, 0.0)  # a region cannot take damping away
        return np.asarray(np.clip(gain / max(float(total[0, 0]), 1e-300), 0.0, 1.0))
