"""Complex modal constants as real ones, and by how much each measurement chain turned them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Turned:
    """Complex modal constants as real ones and by how much each chain turned them; see :func:`turn`.

    Parameters
    ----------
    real, imaginary : (n_frf, n_modes) arrays
        Along and across the direction to which most of a mode's constants point [1/kg].
    phase, phase_sigma : (n_chains, n_modes) arrays
        That direction, within a quarter turn of all chains' together so that no sign is lost between them, and its
        standard deviation [rad].
    channel_group : (n_frf,) int array
        Which chain measured each FRF.
    """

    real: FloatArray
    imaginary: FloatArray
    phase: FloatArray
    phase_sigma: FloatArray
    channel_group: IntArray

    def widened(self, sigma: FloatArray, known: FloatArray | float = 0.0) -> FloatArray:
        """Widen standard deviations (n_frf, n_modes) to what the imaginary parts show.

        The constants of real modes are real; what disturbs an FRF turns them as much as it stretches them, so the
        scatter of the imaginary parts of a mode measures the error of its real parts. ``known`` (n_modes,) is the
        part of it that other causes explain [1/kg^2].
        """
        excess = np.mean(self.imaginary**2, axis=0) - np.mean(sigma**2, axis=0) - known
        return np.asarray(np.sqrt(sigma**2 + np.maximum(excess, 0.0)))


def chain_phases(constants: ComplexArray, channel_group: IntArray) -> FloatArray:
    """Return the direction to which most of the constants of a mode point, chain by chain, (n_chains, n_modes) [rad].

    Within a quarter turn of all chains' together, which is within one of the real axis.
    """
    member = (channel_group == np.arange(int(channel_group.max()) + 1)[:, None]).astype(float)
    common = np.angle(np.sum(constants**2, axis=0)) / 2
    return np.asarray(common + np.angle((member @ constants**2) * np.exp(-2j * common)) / 2)


def turn(constants: ComplexArray, sigma: FloatArray, seen: IntArray, hit: IntArray) -> Turned:
    """Turn complex modal constants to the real axis, chain by chain and mode by mode.

    A real mode's constants are real. A chain that delays turns all those of a mode alike, by -omega times the
    delay; what reversed signs there are does not change that direction.

    Parameters
    ----------
    constants : (n_frf, n_modes) complex array
        Modal constants [1/kg].
    sigma : (n_frf, n_modes) array
        Their standard deviations [1/kg].
    seen, hit : (n_frf,) int arrays
        Point of the response and of the force of each FRF; a response transducer that stays is a chain, one that
        roves is one chain in all.
    """
    transducers, channel_group = np.unique(seen, return_inverse=True)
    if len(transducers) > len(np.unique(hit)):
        channel_group = np.zeros(len(seen), dtype=np.int64)
    member = (channel_group == np.arange(int(channel_group.max()) + 1)[:, None]).astype(float)
    phase = chain_phases(constants, channel_group)
    real, imaginary = (part(constants * np.exp(-1j * phase[channel_group])) for part in (np.real, np.imag))
    power = np.maximum(member @ real**2, 1e-300)
    excess = np.maximum(np.mean(imaginary**2, axis=0) - np.mean(sigma**2, axis=0), 0.0)
    phase_sigma = np.sqrt(member @ (real**2 * (sigma**2 + excess))) / power
    return Turned(np.asarray(real), np.asarray(imaginary), phase, phase_sigma, channel_group.astype(np.int64))
