"""LSCF at 1025 lines, orders 1 to 120: modalkit beside pyOMA2, which runs for over a minute.

pyOMA2 is no part of modalkit: ``uv run --group bench python benchmarks/bench_plscf.py``. Its coefficients are real,
so that its degree 120 has 60 pairs of poles; ours has 120 poles at that degree. The conjugate FRFs suit its sign
convention.
"""

from __future__ import annotations

import argparse

import common
import numpy as np
from pyoma2.functions import plscf
from scipy import fft

from identification import lscf

OUTPUTS, LINES = 25, 1025


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--order", type=int, default=120)
    order: int = parser.parse_args().order
    frfs = common.synthetic(OUTPUTS, LINES, np.random.default_rng(1))
    step, result = 0.5 / float(frfs.frequency[-1]), []

    def theirs() -> None:
        with common.quiet():
            denominators, numerators = plscf.pLSCF(frfs.values.conj()[:, None, :], step, order)
            result.append(plscf.pLSCF_poles(denominators, numerators, step, "per", 2 * (LINES - 1)))

    def transforms() -> None:
        for _ in range(2):
            fft.ifft(frfs.values, int(fft.next_fast_len(round(1.08 * LINES))), axis=1)

    orders = range(1, order + 1)
    own = common.seconds(lambda: lscf(frfs, orders=orders), 9)
    peer = common.seconds(theirs, 1)
    classic, least = common.classic_floor(orders, transforms), common.own_floor(orders, transforms)
    poles = np.asarray(result[0][3], complex)[:, -1]
    print(
        f"{OUTPUTS} outputs, {LINES} lines, orders 1-{order}: {own:.3f} s, "
        f"pyOMA2 {peer:.1f} s, ratio {peer / own:.0f}; "
        f"{own / classic:.2f} of the classic floor {classic:.3f} s, {own / least:.1f} of our own {least:.3f} s; "
        f"modes {common.modes_found(lscf(frfs, orders=[order]).poles[0])} and "
        f"{common.modes_found(poles[np.isfinite(poles)])} of 12"
    )


if __name__ == "__main__":
    main()
