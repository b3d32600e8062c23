"""What an exponential window that nobody took out makes of a pole: it decays faster and rings as before."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray


def with_window(frequency: FloatArray, damping: FloatArray, decay: float) -> tuple[FloatArray, FloatArray]:
    """Return natural frequencies [Hz] and damping ratios [-] as they are read from poles moved by -decay.

    Parameters
    ----------
    frequency : (n_modes,) array
        Those of the structure [Hz].
    damping : (n_modes,) array
        Its damping ratios, nan where none is expected [-].
    decay : float
        Decay of the window [1/s].

    Returns
    -------
    frequency, damping : (n_modes,) arrays
        The modulus of the pole over 2 pi, and its real part over the modulus.
    """
    if not decay:
        return frequency, damping
    omega, known = 2 * np.pi * frequency, np.nan_to_num(damping)
    real = known * omega + decay
    size = np.hypot(real, omega * np.sqrt(1.0 - np.minimum(known, 1.0) ** 2))
    return size / (2 * np.pi), np.where(np.isnan(damping), np.nan, real / size)


def window_turns(frequency: FloatArray, decay: float, power: int) -> FloatArray:
    """Return by how much such a window turns modal constants, (n_modes,) [rad].

    A response that was recorded as the ``power``-th derivative has residues p^q R, whatever the window. Read at the
    pole p - decay they are divided by (p - decay)^q.

    Parameters
    ----------
    frequency : (n_modes,) array
        Natural frequencies [Hz].
    decay : float
        Decay of the window [1/s].
    power : int
        2 of accelerations, 1 of velocities, 0 of displacements [-].
    """
    return np.asarray(-power * np.arctan2(decay, 2 * np.pi * frequency))
