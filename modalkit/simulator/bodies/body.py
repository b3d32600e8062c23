"""What every body on the rig offers, be it a beam or a plate."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from acquisition.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Loss:
    """Something whose damping depends on frequency.

    Parameters
    ----------
    matrix : (n_modes, n_modes) array
        Symmetric; the damping between modes i and j is ``matrix[i, j] (omega_i omega_j)^(power / 2)``
        [1/s (rad/s)^-power].
    power : float
        -1 for structural damping, 1/2 for a viscous fluid's boundary layer [-].
    inertia : bool
        Whether it adds its damping over omega as mass, as the oscillating boundary layer does.
    """

    matrix: FloatArray
    power: float
    inertia: bool = False


class Body(Protocol):
    """A body that can be hit."""

    @property
    def gradients(self) -> tuple[str, ...]:
        """Names of the derivatives of the deflection along the in-plane axes, as ``rows`` takes them."""
        ...

    @property
    def rigid_modes(self) -> int:
        """Number of rigid-body modes [-]."""
        ...

    @property
    def mass(self) -> float:
        """Mass of the body alone [kg]."""
        ...

    def real_modes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest undamped modes: omega (count,) [rad/s], shapes (n_dofs, count) [kg^-1/2]."""
        ...

    def rows(self, places: FloatArray, quantity: str) -> FloatArray:
        """Return rows, (n, n_dofs), that read ``w`` or a derivative of it at places (n, dim) [m]."""
        ...

    def modal_damping(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the damping that the modeller expects, and what else is viscous, (n_modes, n_modes) [1/s]."""
        ...

    def modal_losses(self, shapes: FloatArray) -> tuple[Loss, ...]:
        """Return what damps by a law of its own."""
        ...
