"""What an update hands back, and its report in the order in which a fit is read."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.display import Shown, counted
from acquisition.quantities import percent, uncertainty
from updating.update.estimate import Estimate
from updating.update.statistics.identifiability import Determinability

NOTABLE = 0.5
"""Correlations above it are listed [-]."""

MOST = 12
"""Most correlations listed."""


@dataclass(frozen=True, eq=False, kw_only=True)
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
        Parameters that the data do not determine: what they determine alone is less than the doubt before.
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
        What the user should know.
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
        return _report_text(self)

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


def _report_text(update: Update) -> str:
    """Return statistics, parameters, correlations and what is not determined as plain text."""
    parts = [
        *_section("Fit statistics", _statistics(update)),
        *_section("Parameters", _parameters(update)),
        *_section(f"Correlations over {NOTABLE:g}", _correlations(update)),
        *_section("Not determined by these data", _undetermined(update)),
        *_section("Best subset (order in which parameters explain the residual)", _subset(update)),
    ]
    return "\n".join(parts)


def _section(title: str, lines: Iterator[str]) -> list[str]:
    body = [f"    {line}" for line in lines]
    return [f"[[{title}]]", *body] if body else []


def _statistics(update: Update) -> Iterator[str]:
    rows = [
        ("data", str(update.data)),
        ("parameters", str(len(update.parameters))),
        ("iterations", f"{update.iterations} ({'converged' if update.converged else 'NOT converged'})"),
        ("quantity", {"frequency": "relative frequency"}.get(update.quantity, update.quantity)),
        ("weights", update.weights),
        ("chi-square", f"{update.chi2:.4g}"),
        ("degrees of freedom", f"{update.dof}{'' if update.dof > 0 else ': NOTHING IS TESTED'}"),
        ("reduced chi-square", f"{update.reduced_chi2:.4g}" if update.dof > 0 else ""),
        ("sigmas raised by", f"{update.inflation:.3g}"),
        ("r.m.s. error", f"{percent(update.rms_percent('before'))} -> {percent(update.rms_percent())}"),
    ]
    width = max(len(name) for name, _ in rows)
    yield from (f"{name:<{width}} = {value}" for name, value in rows if value)


def _parameters(update: Update) -> Iterator[str]:
    names = update.names
    width = max(len(name) for name in names)
    for name, parameter in zip(names, update.parameters, strict=True):
        yield f"{name + ':':<{width + 1}} {_value(parameter, _notes(update, name, parameter))}"


def _value(p: Estimate, notes: list[str]) -> str:
    text = f"{p.value:.6g}"
    if np.isfinite(p.sigma):
        share = f" ({uncertainty(abs(p.sigma / p.value))})" if p.value else ""
        text += f" +- {p.sigma:.2g} {p.unit}{share}"
    else:
        text += f" {p.unit}, no standard deviation"
    if p.interval is not None:
        text += f", 95 % {p.interval[0]:.5g} ... {p.interval[1]:.5g}"
    if p.factor is not None:
        text += f", factor {p.factor:.4g}"
    return f"{text} ({'; '.join(notes)})"


def _notes(update: Update, name: str, p: Estimate) -> list[str]:
    """Return where a parameter began, its bounds, and what there is to be careful about."""
    notes = [f"init {p.initial:.6g}", f"bounds {p.low:.3g} ... {p.high:.3g}"]
    notes += ["AT BOUND"] * p.at_bound
    if name in update.held:
        notes.append("HELD BY ITS TOLERANCE against the data: see the warnings")
    if name in update.undetermined:
        held = "; held by its tolerance" if np.isfinite(p.sigma) else ""
        notes.append(f"NOT DETERMINED by the data{held}")
    return notes


def _correlations(update: Update) -> Iterator[str]:
    matrix, names = update.correlations, update.names
    rows, columns = np.triu_indices(len(names), 1)
    value = matrix[rows, columns]
    chosen = np.flatnonzero(np.abs(np.nan_to_num(value)) > NOTABLE)
    chosen = chosen[np.argsort(-np.abs(value[chosen]), kind="stable")]
    for i in chosen[:MOST]:
        yield f"C({names[rows[i]]}, {names[columns[i]]}) = {value[i]:+.3f}"
    if len(chosen) > MOST:
        yield f"... and {len(chosen) - MOST} more"


def _undetermined(update: Update) -> Iterator[str]:
    stated = update.determinability
    if stated is not None:
        yield from (str(coupling) for coupling in stated.couplings)


def _subset(update: Update) -> Iterator[str]:
    stated = update.determinability
    if stated is None or len(update.parameters) < 2:
        return
    for name, share in zip(stated.subset, stated.explained, strict=True):
        yield f"{name}: {100 * share:.4g} % explained"
