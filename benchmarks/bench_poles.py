"""Poles, chart and residues: modalkit beside sdypy-EMA on the same synthetic FRFs, as ratios of one run.

sdypy-EMA's ``pol_order_high`` counts pairs of poles: at 100 its polynomials have real coefficients and degrees 2, 4 ...
200. Complex coefficients of degree n hold n poles of the band, so that its n-th polynomial compares with our degree n.
"""

from __future__ import annotations

from collections.abc import Sequence

import common
import numpy as np
from scipy import fft, linalg
from sdypy import EMA

from acquisition import FrfSet
from identification import fit_residues, lscf, stabilise
from identification.poles.selection import candidates

LINES = 1001


def ours(frfs: FrfSet, orders: Sequence[int]) -> int:
    """Poles at every order, the chart, the poles chosen from it, and their residues."""
    sets = lscf(frfs, orders=orders)
    chosen = candidates(stabilise(sets, band=(float(frfs.frequency[0]), float(frfs.frequency[-1]))))
    fit_residues(frfs, chosen)
    return common.modes_found(chosen)


def theirs(frfs: FrfSet, order: int) -> int:
    """The same with sdypy-EMA, which is told where the modes are."""
    with common.quiet():
        model = EMA.Model(
            frf=np.array(frfs.values),
            freq=np.array(frfs.frequency),
            lower=10,
            upper=1000,
            pol_order_high=order,
            frf_form="accelerance",
        )
        model.get_poles(method="lscf", show_progress=False)
        model.select_closest_poles(list(common.HERTZ))
        model.get_constants(method="lsfd")
        chosen = 2 * np.pi * np.asarray(model.nat_freq) * (1j - np.asarray(model.nat_xi))
        return common.modes_found(chosen)


def transforms(frfs: FrfSet) -> None:
    """Transform the data twice, and solve for the residues."""
    for _ in range(2):
        fft.ifft(frfs.values, int(fft.next_fast_len(round(1.08 * len(frfs.frequency)))), axis=1)
    unknowns = 2 * len(common.HERTZ) + 2
    linalg.lapack.dposv(np.eye(unknowns), np.ones((unknowns, len(frfs.values))))


def compare(frfs: FrfSet, order: int, orders: Sequence[int], note: str) -> None:
    """Print one line."""
    own = common.seconds(lambda: ours(frfs, orders), 9)
    peer = common.seconds(lambda: theirs(frfs, order), 2)
    classic = common.classic_floor(orders, lambda: transforms(frfs))
    least = common.own_floor(orders, lambda: transforms(frfs))
    print(
        f"{len(frfs.values):3d} outputs, pol_order_high {order:3d}, {note}: {own:.3f} s, sdypy-EMA {peer:.2f} s, "
        f"ratio {peer / own:5.1f}; {own / classic:.2f} of the classic floor {classic:.3f} s, "
        f"{own / least:.1f} of our own {least:.3f} s; modes {ours(frfs, orders)} and {theirs(frfs, order)} of 12"
    )


def main() -> None:
    rng = np.random.default_rng(1)
    for outputs in (25, 250):
        frfs = common.synthetic(outputs, LINES, rng).band(1.0, 1000.0)
        for order in (50, 100):
            compare(frfs, order, range(1, order + 1), f"the same {order} orders")
        compare(frfs, 50, range(2, 101, 2), "the same 50 degrees")
        compare(frfs, 100, [int(n) for n in np.linspace(16, 100, 25)], "25 orders as identify tries")


if __name__ == "__main__":
    main()
