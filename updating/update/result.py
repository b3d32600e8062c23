"""What an update hands back, reported as a fit ought to be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.display import Shown, counted
from acquisition.quantities import percent
from updating.update.estimate import Estimate
from updating.update.statistics.identifiability import Determinability
from updating.update.text import report_text


@dataclass(frozen=True, eq=False)
class Update(Shown):
    """An updated model.

    Parameters
    ----------
    parameters : tuple of Estimate
        What was updated.
    pairs : DataFrame
        One row per paired mode: study, test_mode, model_mode (from 1), mac, test_hz, before_hz, after_hz, used;
        with shapes as data shape_sigma, the error each shape is taken to have over its r.m.s. [-].
    covariance, correlations : (p, p) arrays
        Of the values [product of units] and [-].
    undetermined : tuple of str
        Parameters that the data do not determine: what they say alone is less than the doubt before.
    iterations : int
        Number of steps.
    converged : bool
        Whether the increments of the parameters died out.
    chi2, dof, inflation : float, int, float
        Misfit in measurement variances, degrees of freedom, and the factor by which it raised ``sigma``.
    history : DataFrame
        Factors and values of every iteration.
    exact : bool
        Whether the frequencies after the update are those of the full model.
    warnings : tuple of str
        What the user ought to know.
    draws : int
        Number of bootstrap updates behind the intervals; 0 without any.
    determinability : Determinability, optional
        What the data determine: singular values, combinations, the best subset.
    data : int
        Number of data that weigh anything [-].
    weights, quantity : str
        What W_s is, and what is compared: ``frequency`` (relative) or ``eigenvalue``.
    held : tuple of str
        Parameters that their tolerances keep from where the data would take them; their sigmas are the tolerances'.
    """

    parameters: tuple[Estimate, ...]
    pairs: pd.DataFrame
    covariance: FloatArray
    correlations: FloatArray
    undetermined: tuple[str, ...]
    iterations: int
    converged: bool
    chi2: float
    dof: int
    inflation: float
    history: pd.DataFrame
    exact: bool
    warnings: tuple[str, ...]
    draws: int = 0
    determinability: Determinability | None = None
    data: int = 0
    weights: str = ""
    quantity: str = ""
    held: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, with their study where there are several."""
        return tuple(str(name) for name in self.history.columns)

    def table(self) -> pd.DataFrame:
        """Return one row per parameter: value, sigma, unit, factor, and what there is to be careful about."""
        rows = [
            {
                "parameter": p.name,
                "study": p.study or "shared",
                "value": p.value,
                "sigma": p.sigma,
                "unit": p.unit,
                "factor": np.nan if p.factor is None else p.factor,
                "remark": ", ".join(
                    [
                        *["at bound"] * p.at_bound,
                        *["not determined by the data"] * (name in self.undetermined),
                        *["held by its tolerance against the data"] * (name in self.held),
                    ]
                ),
            }
            for p, name in zip(self.parameters, self.names, strict=True)
        ]
        return pd.DataFrame(rows)

    @property
    def reduced_chi2(self) -> float:
        """Misfit in measurement variances per degree of freedom, nan without any [-]."""
        return self.chi2 / self.dof if self.dof > 0 else float("nan")

    def report(self) -> str:
        """Return the whole result as text: statistics, parameters, correlations, what is not determined and why."""
        return report_text(self)

    def rms_percent(self, which: str = "after") -> float:
        """Return the r.m.s. relative error of the frequencies used, ``before`` or ``after`` [%]."""
        used = self.pairs[self.pairs["used"]]
        error = used[f"{which}_hz"] / used["test_hz"] - 1
        return float(100 * np.sqrt(np.mean(error**2)))

    def _headline(self) -> str:
        end = "converged" if self.converged else "not converged"
        return (
            f"{counted(len(self.parameters), 'parameter')}, r.m.s. frequency error "
            f"{percent(self.rms_percent('before'))} -> {percent(self.rms_percent('after'))}, {end} "
            f"after {counted(self.iterations, 'iteration')}"
        )
