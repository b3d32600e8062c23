"""How the noise of a test fades along its records, which an exponential window makes it do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from identification.fit.fit import Fitted
from identification.fit.noise.window_shaped import STRONGEST, ratio_of_differences, steepness


@dataclass(frozen=True)
class Fading:
    """The ratio of differences of noise from line to line, which grows with the decay of the noise.

    Parameters
    ----------
    log_ratio : float
        Logarithm of the mean square of second differences over that of fourth ones; 0 of steady noise [-].
    count : int
        Number of values.
    duration : float
        Length of a record [s].
    decay : float
        Decay of the stated window, already out of the poles [1/s].
    """

    log_ratio: float
    count: int
    duration: float
    decay: float

    def expected(self, further: float = 0.0) -> float:
        """Return the logarithm of the ratio that a window with so much more decay [1/s] makes [-]."""
        return _log_ratio((self.decay + further) * self.duration)

    def sigma(self, further: float = 0.0, *, of_form: float = 0.05) -> float:
        """Return the standard deviation of the logarithm of the ratio [-].

        Parameters
        ----------
        further : float
            Decay of the window beside what is stated [1/s].
        of_form : float
            How far the ratio is off where it is large, relative [-]: twice what 24 simulated tests showed.
        """
        steady = np.exp(-self.expected(further))
        return float(np.hypot(1.0 / np.sqrt(self.count), of_form * (1.0 - steady)))


def _log_ratio(fade: float) -> float:
    return float(np.log(steepness(min(fade, STRONGEST))))


def noise_fading(fitted: Fitted, *, most_left: float = 2.0) -> Fading | None:
    """Return how the noise of a fit to FRFs of hits fades; None where what the fit leaves is no noise.

    Parameters
    ----------
    fitted : Fitted
        The fit.
    most_left : float
        Power that the fit leaves over that of the noise up to which it is noise [-].
    """
    frfs = fitted.frfs
    if frfs.variance is None or frfs.line_shape is not None or fitted.excess() > most_left:
        return None
    ratio = ratio_of_differences(fitted.residual)
    if ratio is None:
        return None
    largest: FloatArray = np.array([1.0 / steepness(STRONGEST), steepness(STRONGEST)])
    clipped = float(np.clip(ratio, *largest))
    return Fading(float(np.log(clipped)), fitted.residual.size, 1.0 / frfs.df, frfs.decay)
