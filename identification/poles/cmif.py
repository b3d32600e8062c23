"""The complex mode indicator function: how many modes there are at a line, close ones included."""

from __future__ import annotations

import numpy as np
import pandas as pd

from acquisition.frfs.frf import FrfSet
from identification.poles.frf_matrix import full_matrix, indicators


def cmif(frfs: FrfSet, *, band: tuple[float, float] | None = None, count: int = 4) -> pd.DataFrame:
    """Return the complex mode indicator functions: eigenvalues of H^H H at every line.

    Shih, Tsai, Allemang and Brown, Mech. Syst. Signal Process. 2 (1988) 367-377. H has a row for each response and a
    column for each reference; a peak of the first function is a mode, a peak of the second at the same line another
    one beside it. One reference, or one response, gives one function: the sum of |H|^2.

    Parameters
    ----------
    frfs : FrfSet
        FRFs between every response and every reference. Those of a response that lacks a reference are left out
        (or of a reference that lacks a response, if that costs fewer FRFs); an FRF that is there twice is averaged.
    band : tuple of float, optional
        Lines to evaluate [Hz].
    count : int
        How many functions at the most [-].

    Returns
    -------
    DataFrame
        Rows are lines [Hz], columns the functions 1, 2, ..., largest first [unit of the FRFs squared];
        ``attrs["left_out"]`` names the degrees of freedom left out.

    Raises
    ------
    InputError
        If no response has every reference, or the band holds no line.
    """
    chosen = frfs if band is None else frfs.band(*band)
    matrix, left_out = full_matrix(chosen)
    values = np.asarray(np.linalg.svd(matrix, compute_uv=False)[:, :count] ** 2, dtype=np.float64)
    return indicators(chosen, values, "CMIF", left_out)
