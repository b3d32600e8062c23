"""How plainly a hidden effect stands in the data, by the rig's own model: a check on what may be asked."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.blind.reading import SHAPE_SIGMA, Scales, scales
from modalkit.blind.signatures import signatures
from modalkit.simulator.scene import Scene


@dataclass(frozen=True, eq=False)
class Shown:
    """What an effect does to the data.

    Parameters
    ----------
    change : (n,) array
        Change of the data in standard deviations [-].
    scatter : float
        Squared: what scatters from hit to hit more than hits do, which no effect of the library makes [-].
    scales : Scales
        Of the test.
    """

    change: FloatArray
    scatter: float
    scales: Scales

    @property
    def length(self) -> float:
        """Mahalanobis length of the whole change [-]."""
        return float(np.sqrt(self.change @ self.change + self.scatter))

    def left(self, without: Sequence[str] = ()) -> float:
        """Return the length of what the best single effect of the rig's library leaves of the change [-].

        Parameters
        ----------
        without : sequence of str
            Effects that the library lacks in this trial.
        """
        left = [signature.left(self.change) for signature in signatures(self.scales, without)]
        return float(np.sqrt(min(left, default=float(self.change @ self.change)) + self.scatter))


def shown(scene: Scene, before: Scene) -> Shown:
    """Return by how many standard deviations an effect moves the data off what tolerances allow.

    Parameters
    ----------
    scene, before : Scene
        The same specimen with and without the effect.

    Returns
    -------
    Shown
        In the scales of :func:`modalkit.blind.reading.scales`. What scatters from hit to hit counts by its
        scatter over that of the hits.
    """
    setup, chain = scene.setup, scene.chain
    of = scales(setup)
    scatter = len(setup.points) * (0.5 * chain.tilt**2 / SHAPE_SIGMA) ** 2
    return Shown(of.change(scene, before), float(scatter), of)
