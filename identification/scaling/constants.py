"""Residues of any form of FRF as modal constants."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import AnyArray, ComplexArray
from acquisition.errors import InputError
from acquisition.form import FORMS, Form


def modal_constants(residues: AnyArray, poles: AnyArray, form: Form = "receptance") -> ComplexArray:
    """Turn residues of receptance, mobility or accelerance into modal constants A = phi_i phi_j.

    A = 2i Im(p) R of the receptance, whose residue is that of the mobility over p and that of the accelerance
    over p^2 (Ewins, Modal Testing, 2nd ed., Sec. 2.3: FRFs of one another's derivatives). A is real for
    real modes of unit modal mass.

    Parameters
    ----------
    residues : (n_frf, n_modes) complex array
        Residues at the poles with Im > 0 [m/(N s), m/(N s^2) or m/(N s^3), by ``form``].
    poles : (n_modes,) complex array
        Poles [rad/s].
    form : {"receptance", "mobility", "accelerance"}
        What the residues belong to.

    Returns
    -------
    (n_frf, n_modes) complex array
        Modal constants [1/kg].

    Raises
    ------
    InputError
        If the form is unknown or a pole is not underdamped.
    """
    if form not in FORMS:
        raise InputError(f"unknown FRF form {form!r}; use one of {', '.join(FORMS)}")
    p = np.asarray(poles, dtype=complex)
    if np.any(p.imag <= 0):
        raise InputError("modal constants need poles with a positive imaginary part: underdamped modes")
    return np.asarray(np.asarray(residues, dtype=complex) * 2j * p.imag / p ** FORMS.index(form))
