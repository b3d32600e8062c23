"""The multivariate mode indicator function: at which lines some force makes the structure move in quadrature with it.

At a natural frequency there are forces that let the structure move as in a normal mode, a quarter period behind them.
The part of the motion in phase with real forces F, |Re(H F)|^2 of |H F|^2, is then small. Its smallest value over all F
is the smallest eigenvalue of

    H_r^T H_r F = lambda (H_r^T H_r + H_i^T H_i) F,    H = H_r + i H_i .

Williams, Crowley and Vold, The multivariate mode indicator function in modal analysis, Proc. 3rd IMAC (1985) 66-70.
The matrix on the right is not formed: with the singular vectors U of H_r over H_i, the eigenvalues are those of
U_r^T U_r, which keeps all digits.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.poles.frf_matrix import full_matrix, indicators


def mvmif(frfs: FrfSet, *, band: tuple[float, float] | None = None, count: int = 4) -> pd.DataFrame:
    """Return the multivariate mode indicator functions: parts of the motion in phase with forces, smallest first.

    A minimum of the first function is a mode; a minimum of the second at the same line is another one beside it. There
    are as many functions as references, or as responses where those are fewer: then the structure is taken as
    reciprocal, forces at the responses.

    Parameters
    ----------
    frfs : FrfSet
        FRFs between every response and every reference; what lacks one is left out, as by :func:`cmif`. Of mobilities
        the part in quadrature with the force is taken.
    band : tuple of float, optional
        Lines to evaluate [Hz].
    count : int
        How many functions at the most [-].

    Returns
    -------
    DataFrame
        Rows are lines [Hz], columns the functions 1, 2, ..., from 0 to 1 [-]; NaN where all FRFs are zero.
        ``attrs["left_out"]`` names the degrees of freedom left out.

    Raises
    ------
    InputError
        If no response has every reference, or the band holds no line.
    """
    chosen = frfs if band is None else frfs.band(*band)
    matrix, left_out = full_matrix(chosen)
    if matrix.shape[2] > matrix.shape[1]:
        matrix = matrix.swapaxes(1, 2)
    values = in_phase(1j * matrix if chosen.form == "mobility" else matrix)[:, :count]
    return indicators(chosen, values, "MvMIF", left_out)


def in_phase(matrix: ComplexArray) -> FloatArray:
    """Return the parts of the motion in phase with real forces, smallest first, shape (n_lines, n_references) [-].

    Forces that set nothing in motion count as 1.

    Parameters
    ----------
    matrix : array, shape (n_lines, n_responses, n_references)
        Receptances or accelerances, as many responses as references or more [any unit].
    """
    responses, references = matrix.shape[1:]
    stacked = np.concatenate([matrix.real, matrix.imag], axis=1)
    vectors, sizes, _ = np.linalg.svd(stacked, full_matrices=False)
    least = np.finfo(np.float64).eps * 2 * responses * sizes[:, :1]
    still = (sizes <= least)[:, None, :]
    real = np.where(still, 0.0, vectors[:, :responses])
    square = real.swapaxes(1, 2) @ real + np.eye(references) * still
    values = np.clip(np.linalg.eigvalsh(square), 0.0, 1.0)
    values[sizes[:, 0] == 0] = np.nan
    return np.asarray(values, dtype=np.float64)
