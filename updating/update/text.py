"""An update as text, in the order in which a fit is read."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from acquisition.quantities import percent, uncertainty

if TYPE_CHECKING:
    from updating.update.estimate import Estimate
    from updating.update.result import Update

NOTABLE = 0.5
"""Correlations above it are listed [-]."""

MOST = 12
"""Most correlations listed."""


def report_text(update: Update) -> str:
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
