"""Which parameters, or combinations of them, data determine; and which of them explain the residual best."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse.csgraph import connected_components
from scipy.stats import chi2

from acquisition.arrays import BoolArray, FloatArray
from acquisition.display import Displayed
from acquisition.quantities import uncertainty

FLOOR = 1e-10
"""Singular values under this share of the largest are none [-]."""

COUPLED = 0.05
"""Parameters whose share in a common undetermined direction is larger belong together [-]."""

KNOWN = 0.3
"""A combination counts as determined if data bring its doubt down to this share [-]."""

MOVED = 3.0
"""A parameter that data moved by more of its own standard deviations is determined, however small the doubt was: the
data contradict the doubt, which is then no yardstick. Doubling it calls undetermined what data moved by 3 to 6 [-]."""

NARROWED = 0.5
"""Share of its doubt to which data and the tolerances of the other parameters must bring one for it to be determined
[-]. Of two that only a ratio ties each keeps 0.7. Doubled: whatever has a tolerance is determined."""

NOTHING = 1e-3
"""What uninformative data leave is a thousand times the doubt, so that matrices can be inverted [-]."""

SIMPLE = 0.03
"""Exponents so near to a whole number or a half are written as such [-]."""


@dataclass(frozen=True)
class Coupling:
    """Parameters that data do not separate.

    Parameters
    ----------
    parameters : tuple of str
        Their names.
    determined : tuple of str
        Combinations of them that the data do determine, as text: ``E / density``.
    sigma : tuple of float
        Standard deviation of each combination; relative for a product of factors, else in units of the doubts [-].
    """

    parameters: tuple[str, ...]
    determined: tuple[str, ...]
    sigma: tuple[float, ...]

    def __str__(self) -> str:
        """Return one sentence."""
        names = ", ".join(self.parameters)
        if len(self.parameters) == 1:
            return f"{names}: the data determine it less precisely than the prior knowledge"
        if not self.determined:
            return f"{names}: the data determine no combination of them"
        known = "; ".join(
            f"{text} (to {uncertainty(sigma)})"
            for text, sigma in zip(self.determined, self.sigma, strict=True)
        )
        return f"{names}: the data determine only {known}, not each of them"


@dataclass(frozen=True, eq=False)
class Determinability(Displayed):
    """What data determine at a setting of the parameters.

    Parameters
    ----------
    singular_values : (min(n, p),) array
        Of the sensitivities over what the measurement is good for, times the doubts: how many times the data
        narrow a direction; under 1 they are weaker than the prior knowledge [-].
    alone : (p,) array
        Standard deviation of each parameter from the data alone, all others free, over its doubt [-].
    undetermined : (p,) bool array
        Parameters that the data alone determine less than the doubt, which they do not contradict either, and whose
        doubt they do not even halve together with the tolerances of the others.
    couplings : tuple of Coupling
        Parameters that only combinations determine, group by group.
    subset : tuple of str
        Parameters in the order in which they explain the residual of the nominal model best.
    explained : tuple of float
        Share of the residual's weighted square explained after each of them [-].
    """

    singular_values: FloatArray
    alone: FloatArray
    undetermined: BoolArray
    couplings: tuple[Coupling, ...]
    subset: tuple[str, ...]
    explained: tuple[float, ...]

    def without(self, names: Collection[str]) -> Determinability:
        """Return the same without the couplings of single parameters that are judged otherwise."""
        kept = tuple(c for c in self.couplings if len(c.parameters) > 1 or c.parameters[0] not in names)
        return replace(self, couplings=kept)


def determinability(
    scaled: FloatArray,
    names: Sequence[str],
    *,
    doubt: FloatArray,
    log: BoolArray,
    moved: FloatArray,
    at_start: FloatArray,
    residual: FloatArray,
    tolerated: BoolArray | None = None,
) -> Determinability:
    """Work out what data determine.

    Parameters
    ----------
    scaled : (n, p) array
        Sensitivities over standard deviations of the data, times the doubts [-].
    names : sequence of str
        Names of the parameters.
    doubt : (p,) array
        1-sigma scales of the coordinates.
    log : (p,) bool array
        Which coordinates are logarithms.
    moved : (p,) array
        By how much the coordinates left the nominal model.
    at_start : (n, p) array
        ``scaled`` at the nominal model.
    residual : (n,) array
        Residual of the nominal model over standard deviations of the data [-].
    tolerated : (p,) bool array, optional
        Which parameters' doubts are tolerances, that hold them; left out, none.
    """
    _, size, right = np.linalg.svd(scaled, full_matrices=True)
    padded = np.zeros(scaled.shape[1])
    padded[: len(size)] = size
    floored = np.maximum(padded, FLOOR * max(padded.max(initial=0.0), 1e-300))
    alone = np.sqrt(np.sum((right.T / floored) ** 2, axis=1))
    undetermined = (alone > 1) & (np.abs(moved) <= MOVED * alone * doubt)
    if tolerated is not None:
        undetermined &= ~(tolerated & (_together(scaled, tolerated) < NARROWED))
    couplings = _couplings(right, floored, undetermined, names, doubt, log)
    subset, explained = best_subset(at_start, residual)
    return Determinability(size, alone, undetermined, couplings, tuple(names[i] for i in subset), explained)


def _together(scaled: FloatArray, tolerated: BoolArray) -> FloatArray:
    """Return the standard deviation of each parameter by data and tolerances together, over its doubt (p,) [-]."""
    normal = scaled.T @ scaled + np.diag(tolerated.astype(float))
    inverse = np.linalg.pinv(normal, rcond=FLOOR, hermitian=True)
    return np.asarray(np.sqrt(np.maximum(np.diag(inverse), 0.0)))


def best_subset(columns: FloatArray, residual: FloatArray) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Select parameters one after the other by the angle between their column and the residual.

    Forward selection with orthogonalisation (Lallemand and Piranda, Proc. 8th IMAC (1990) 579-585; Friswell,
    Mottershead and Ahmadian, J. Vib. Acoust. 120 (1998) 854-859). It ends when no further parameter gains more
    than noise does.

    Parameters
    ----------
    columns : (n, p) array
        Sensitivities over standard deviations of the data.
    residual : (n,) array
        Residual over standard deviations of the data.

    Returns
    -------
    order : tuple of int
        The parameters selected.
    explained : tuple of float
        Share of the residual's square explained after each [-].
    """
    left, rest = np.array(columns, dtype=float), np.array(residual, dtype=float)
    total, enough = float(rest @ rest), float(chi2.isf(0.05, 1))
    before = np.linalg.norm(left, axis=0)
    order: list[int] = []
    explained: list[float] = []
    while len(order) < min(columns.shape):
        length = np.linalg.norm(left, axis=0)
        usable = length > 1e-6 * np.maximum(before, 1e-300)
        gain = np.where(usable, (left.T @ rest) ** 2 / np.maximum(length, 1e-150) ** 2, 0.0)
        best = int(np.argmax(gain))
        if gain[best] <= enough:
            break
        unit = left[:, best] / length[best]
        rest = rest - unit * (unit @ rest)
        left = left - np.outer(unit, unit @ left)
        order.append(best)
        explained.append(float(1 - rest @ rest / total))
    return tuple(order), tuple(explained)


def _couplings(
    right: FloatArray,
    size: FloatArray,
    undetermined: BoolArray,
    names: Sequence[str],
    doubt: FloatArray,
    log: BoolArray,
) -> tuple[Coupling, ...]:
    lost = np.flatnonzero(undetermined)
    if not len(lost):
        return ()
    empty = right[size < 1]
    shared = np.abs(empty.T @ empty)[np.ix_(lost, lost)]
    count, label = connected_components(shared > COUPLED, directed=False)
    groups = [lost[label == i] for i in range(count)]
    return tuple(_coupling(right, size, group, names, doubt, log) for group in groups)


def _coupling(
    right: FloatArray,
    size: FloatArray,
    group: np.ndarray,
    names: Sequence[str],
    doubt: FloatArray,
    log: BoolArray,
) -> Coupling:
    """Find the combinations of a group in which the data alone leave little doubt."""
    covariance = (right.T / np.maximum(size, NOTHING) ** 2) @ right
    known = np.linalg.inv(covariance[np.ix_(group, group)])
    values, vectors = np.linalg.eigh((known + known.T) / 2)
    kept = np.flatnonzero(values > 1 / KNOWN**2)[::-1]
    own = tuple(names[i] for i in group)
    if len(kept) > 3:
        return Coupling(
            own, (f"{len(kept)} combinations of the {len(group)}",), (float(values[kept[-1]] ** -0.5),)
        )
    texts, sigmas = [], []
    for weight in _readable(vectors[:, kept]):
        text, scale = _text(weight, own, doubt[group], log[group])
        texts.append(text)
        sigmas.append(scale * float(np.sqrt(weight @ np.linalg.solve(known, weight))))
    return Coupling(own, tuple(texts), tuple(sigmas))


def _readable(directions: FloatArray) -> list[FloatArray]:
    """Return other vectors of the same span with as many zeros as it admits, by elimination with pivots."""
    rows = directions.T.copy()
    done: list[int] = []
    for i in range(len(rows)):
        free = [j for j in range(rows.shape[1]) if j not in done]
        pivot = free[int(np.argmax(np.abs(rows[i, free])))]
        rows[i] /= rows[i, pivot]
        for k in range(len(rows)):
            if k != i:
                rows[k] -= rows[k, pivot] * rows[i]
        done.append(pivot)
    return [np.asarray(row) for row in rows]


def _text(weight: FloatArray, names: Sequence[str], doubt: FloatArray, log: BoolArray) -> tuple[str, float]:
    """Write a combination of scaled coordinates; return it with the factor from its doubts to what is written."""
    used = np.abs(weight) > COUPLED * np.abs(weight).max()
    if log[used].all():
        exponents = np.where(used, weight / doubt, 0.0)
        largest = exponents[np.argmax(np.abs(exponents))]
        exponents = exponents / largest
        above = " ".join(_power(n, e) for n, e in zip(names, exponents, strict=True) if e > 0)
        below = " ".join(_power(n, -e) for n, e in zip(names, exponents, strict=True) if e < 0)
        return above + (f" / {below}" if below else ""), float(1 / abs(largest))
    parts = [f"{w:+.2g} {n}" for n, w, u in zip(names, weight, used, strict=True) if u]
    return " ".join(parts).lstrip("+") + " in units of their doubts", 1.0


def _power(name: str, exponent: float) -> str:
    near = round(2 * exponent) / 2
    if near and abs(exponent - near) < SIMPLE:
        exponent = near
    return name if exponent == 1 else f"{name}^{exponent:.2g}"
