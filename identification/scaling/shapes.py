"""Mode shapes with their covariance."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.display import Displayed
from acquisition.dof import Dof
from acquisition.modal_data import ModalData


@dataclass(frozen=True, eq=False, kw_only=True)
class Shapes(Displayed):
    """Mode shapes of the measured degrees of freedom.

    Parameters
    ----------
    dofs : tuple of Dof
        Degrees of freedom, directions positive.
    shapes : (n_dofs, n_modes) complex array
        Mode shapes, turned to be as real as they can be [kg^-1/2 where scaled, else 1/kg: the constants of
        the reference].
    sigma : (n_dofs, n_modes) array
        Standard deviation of the real part of each component, that of the scale included [as ``shapes``].
    scaled : bool
        Whether they are mass-normalised.
    warnings : tuple of str
        What stood in the way.
    own : (n_dofs, n_modes) array
        Variance each component has for itself [as ``shapes`` squared].
    common : (n_dofs, n_factors, n_modes) complex array
        What components have in common, the scale above all: see :meth:`covariance` [as ``shapes``].
    phase : (n_modes,) array
        By how much each shape was turned: A_ij = phi_i phi_j exp(-2i phase). Near 0 for real modes [rad].
    """

    dofs: tuple[Dof, ...]
    shapes: ComplexArray
    sigma: FloatArray
    scaled: bool
    warnings: tuple[str, ...]
    own: FloatArray
    common: ComplexArray
    phase: FloatArray

    def covariance(self, mode: int) -> FloatArray:
        """Return the covariance of the real parts of one shape, (n_dofs, n_dofs) [as ``shapes`` squared].

        Parameters
        ----------
        mode : int
            Number of the mode, counted from 0.
        """
        shared = self.common[:, :, mode]
        return np.asarray(np.diag(self.own[:, mode]) + (shared @ shared.conj().T).real)


def real_modes(modes: ModalData) -> ModalData:
    """Return modes whose shapes are the nearest real ones.

    Each shape is turned so that the sum of its squares is real and positive, which makes its imaginary part
    as small as it can be, and that part is dropped. The scale stays; where the modes are truly complex (a low
    MPC) it holds as far as they are nearly real.

    Parameters
    ----------
    modes : ModalData
        Modes, with shapes or without.
    """
    if modes.shapes is None:
        return modes
    return replace(modes, shapes=turned(modes.shapes)[0].real.astype(complex))


def turned(shapes: ComplexArray) -> tuple[ComplexArray, FloatArray]:
    """Turn each shape to be as real as possible, its largest component positive; return it and the angle."""
    angle = -0.5 * np.angle(np.sum(shapes**2, axis=0))
    straight = shapes * np.exp(1j * angle)
    largest = straight[np.abs(straight).argmax(axis=0), np.arange(shapes.shape[1])]
    flip = largest.real < 0
    return np.asarray(straight * np.where(flip, -1.0, 1.0)), np.asarray(angle)
