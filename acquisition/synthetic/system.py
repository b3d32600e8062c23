"""The structure under a synthetic test: poles and residues between degrees of freedom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, frozen_array
from acquisition.display import Displayed
from acquisition.dof import Dof
from acquisition.errors import InputError


@dataclass(frozen=True, eq=False)
class ModalSystem(Displayed):
    """Poles and residues of a linear structure, H(s) = sum_r R_r / (s - p_r) + conj(R_r) / (s - conj(p_r)).

    The residues hold between the listed degrees of freedom as they point: whoever lists a transducer in -z
    gives the residues of -z. Nothing is multiplied by the signs of the directions here.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles with positive imaginary part [rad/s].
    residues : (n_responses, n_points, n_modes) complex array
        Residues of the receptances [m/(N s)].
    responses : tuple of Dof, length n_responses
        Where the motion is measured.
    points : tuple of Dof, length n_points
        Where the hammer hits.
    gradients : (2, n_responses, n_points, n_modes) complex array, optional
        Derivatives of the residues with respect to the place of the hit along the two in-plane axes
        [1/(N s)]; needed for scatter of the position.

    Raises
    ------
    InputError
        If the shapes disagree, or a pole is unstable.
    """

    poles: ComplexArray
    residues: ComplexArray
    responses: tuple[Dof, ...]
    points: tuple[Dof, ...]
    gradients: ComplexArray | None = None

    def __post_init__(self) -> None:
        """Check the entries."""
        object.__setattr__(self, "poles", frozen_array(self.poles, np.complex128))
        object.__setattr__(self, "residues", frozen_array(self.residues, np.complex128))
        object.__setattr__(self, "responses", tuple(self.responses))
        object.__setattr__(self, "points", tuple(self.points))
        expected = (len(self.responses), len(self.points), len(self.poles))
        if self.residues.shape != expected:
            raise InputError(
                f"residues have shape {self.residues.shape}; {expected[0]} responses, {expected[1]} points "
                f"and {expected[2]} poles ask for {expected}"
            )
        if self.gradients is not None:
            object.__setattr__(self, "gradients", frozen_array(self.gradients, np.complex128))
            if self.gradients.shape != (2, *expected):
                raise InputError(f"gradients have shape {self.gradients.shape}, expected {(2, *expected)}")
        if np.any(self.poles.real > 0):
            raise InputError("a pole has a positive real part: the structure would be unstable")

    def with_frequencies(self, factor: FloatArray | float) -> ModalSystem:
        """Return the system with its poles multiplied by a factor, shapes and modal masses kept.

        Parameters
        ----------
        factor : (n_modes,) array or float
            New frequency over old [-].
        """
        wide = np.broadcast_to(np.asarray(factor, dtype=np.float64), self.poles.shape)
        slopes = None if self.gradients is None else self.gradients / wide
        return replace(self, poles=self.poles * wide, residues=self.residues / wide, gradients=slopes)

    def receptance(self, laplace: ComplexArray, point: int, offset: FloatArray | None = None) -> ComplexArray:
        """Return the receptances at all responses, shape (n_responses, n_lines) [m/N].

        Parameters
        ----------
        laplace : (n_lines,) complex array
            Where in the Laplace plane [rad/s].
        point : int
            Row number of the point that is hit.
        offset : (2,) array, optional
            How far beside the point the hammer lands [m].

        Raises
        ------
        InputError
            If an offset is asked for and the system has no gradients.
        """
        residues = self.residues[:, point]
        if offset is not None and np.any(offset):
            if self.gradients is None:
                raise InputError(
                    "position scatter needs the gradients of the residues; give ModalSystem.gradients"
                )
            residues = residues + np.tensordot(offset, self.gradients[:, :, point], axes=1)
        upper = 1.0 / (laplace - self.poles[:, None])
        lower = 1.0 / (laplace - self.poles.conj()[:, None])
        return np.asarray(residues @ upper + residues.conj() @ lower, dtype=np.complex128)


def modal_system(
    *,
    frequency: FloatArray,
    damping: FloatArray,
    response_shapes: FloatArray,
    point_shapes: FloatArray,
    responses: Sequence[Dof],
    points: Sequence[Dof],
) -> ModalSystem:
    """Return the system of proportionally damped modes with mass-normalised real shapes.

    Parameters
    ----------
    frequency, damping : (n_modes,) arrays
        Undamped natural frequencies [Hz] and damping ratios [-].
    response_shapes : (n_responses, n_modes) array
        Shapes at the responses [kg^-1/2].
    point_shapes : (n_points, n_modes) array
        Shapes at the points that are hit [kg^-1/2].
    responses, points : sequences of Dof
        The degrees of freedom.

    Notes
    -----
    R_r = phi_r phi_r^T / (2 i omega_d) (Ewins, Modal Testing, 2000, section 2.6).
    """
    omega = 2 * np.pi * np.asarray(frequency, dtype=np.float64)
    zeta = np.asarray(damping, dtype=np.float64)
    damped = omega * np.sqrt(1 - zeta**2)
    products = np.einsum("im,jm->ijm", response_shapes, point_shapes)
    return ModalSystem(
        poles=-zeta * omega + 1j * damped,
        residues=products / (2j * damped),
        responses=tuple(responses),
        points=tuple(points),
    )
