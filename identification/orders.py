"""Which model orders are tried: enough for the modes that the FRFs hold."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from identification.arrangement import arrange
from identification.fit.noise.levels import quiet_floor, scatter
from identification.poles.base import PoleEstimator
from identification.poles.selection import candidates
from identification.poles.stabilisation import StabilisationChart, stabilise

_ORDER = 60
_LEVELS = 25
_HIGHEST = 400
_EACH = 3
"""Poles tried for each direction of the FRFs beyond noise [-]. A candidate holds through a third of the orders, so 1.5
would leave no pole for noise, and 2 finds close modes too far from where they are; doubled: eight times the work for
the same modes."""
_SKETCH = 200  # combinations of FRFs that show as many directions as the highest order has use for


def charted(
    frfs: FrfSet, estimator: PoleEstimator, *, band: tuple[float, float], order: int | None
) -> tuple[StabilisationChart, ComplexArray]:
    """Return the stabilisation chart of the FRFs and its candidates for modes.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs in the band.
    estimator : PoleEstimator
        What finds the poles.
    band : tuple of float
        The band [Hz].
    order : int, optional
        Largest number of poles; default 60, or more where the FRFs hold more modes than that carries [-].

    Returns
    -------
    chart : StabilisationChart
        Poles of all orders.
    start : (n,) complex array
        Candidates [rad/s].

    Raises
    ------
    InputError
        If the order is under 2 or beyond 400.
    """
    if order is None:
        order = max(_ORDER, min(_EACH * directions(frfs), _HIGHEST)) if estimator.any_order else _ORDER
    orders = order_list(frfs, order, poly_reference=estimator.poly_reference)
    chart = stabilise(estimator(frfs, orders=orders), band=band)
    return chart, candidates(chart)


def directions(frfs: FrfSet) -> int:
    """Return how many independent combinations of FRFs hold more than noise [-].

    Each mode of the band adds one, as long as there are as many FRFs. They are counted by the singular values of the
    FRFs over their noise beyond the largest that noise alone has, sqrt(n_frf) + sqrt(n_lines) (Davidson and Szarek,
    Handbook of the Geometry of Banach Spaces 1 (2001) 317-366, Theorem 2.13); of many FRFs random combinations are
    taken (Halko, Martinsson and Tropp, SIAM Rev. 53 (2011) 217-288).

    Parameters
    ----------
    frfs : FrfSet
        The FRFs in the band.
    """
    noise = np.sqrt(np.maximum(scatter(frfs.values)[:, None], quiet_floor(frfs.values)))
    whitened = frfs.values / noise
    if len(whitened) > _SKETCH:
        mixed = np.random.default_rng(0).standard_normal((len(whitened), _SKETCH))
        whitened = np.linalg.qr(mixed)[0].T @ whitened
    power = np.linalg.eigvalsh(whitened @ whitened.conj().T)
    largest = np.sqrt(len(whitened)) + np.sqrt(whitened.shape[1])
    return int(np.count_nonzero(power > largest**2))


def order_list(frfs: FrfSet, order: int, *, poly_reference: bool) -> list[int]:
    """Return the orders to try: up to ``order`` poles, in some 25 steps, as far as the lines carry them.

    Raises
    ------
    InputError
        If the order is under 2 or beyond 400.
    """
    columns = len(arrange(frfs).columns) if poly_reference else 1
    if order < 2:
        raise InputError(f"order {order} is too low for a mode; use 2 or more")
    if order > _HIGHEST:
        raise InputError(f"order {order} is beyond {_HIGHEST}; divide the band instead")
    carried = max(2, len(frfs.frequency) // 2)
    top = min(max(order // columns, min(order, 16)), carried)
    bottom = max(1, min(top - 1, max(top // 6, 2)))
    return sorted({int(n) for n in np.linspace(bottom, top, _LEVELS).round()})
