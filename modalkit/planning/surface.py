"""All that an effect can do as a surface in the space of the data, and how far from it targets lie.

A diagnosis allows for an error of an effect's idealisation in each datum, in proportion to the change: the covariance
is C + D, with D diagonal and another at each point of the surface. With C whitened, D is not diagonal, and distances
that take it so fall where a test gets better. Axes in which both C and one D are diagonal exist (of the generalised
eigenproblem): here those of a place's typical D. Severities of one place change their data nearly in proportion, so
that along these axes what the doubts of two data have in common is small at all of them, and is left aside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Surface:
    """All that an effect can do.

    Parameters
    ----------
    cloud : (n_places, n_severities, n_data) array
        Points of the surface [-].
    fidelity : float
        How far the idealisation may be off in each datum, of the change [-].
    slack : (n_data,) array or None
        What is in doubt beside that, 1 sigma; None is nothing [-].
    joined : bool
        Whether the effect can also lie between two places.
    """

    cloud: FloatArray
    fidelity: float = 0.0
    slack: FloatArray | None = None
    joined: bool = False

    def distance(self, targets: FloatArray, white: FloatArray) -> FloatArray:
        """Return the Mahalanobis distance of targets from the surface, its own doubt counted in, (n,) [-].

        Parameters
        ----------
        targets : (n, n_data) array
            Points [-].
        white : (n_data, n_data) array
            What whitens the data.
        """
        colour = np.asarray(np.linalg.inv(white), dtype=np.float64)
        each = (self._from(place, targets, white, colour) for place in range(len(self.cloud)))
        return np.asarray(np.sqrt(np.min(list(each), axis=0)))

    def _from(self, place: int, targets: FloatArray, white: FloatArray, colour: FloatArray) -> FloatArray:
        """Return the squared distance of targets from the part of the surface about a place, (n,) [-].

        ``colour`` is the inverse of what whitens the data.

        The nearest point is sought over all severities, then moved within its cell with the doubt that it has there;
        the doubt of the point moved to is the one that counts.
        """
        turn = self._turn(place, white)
        axes, back = turn.T @ white, colour @ turn
        near = [_within(place + step, len(self.cloud)) for step in (-1, 0, 1)]
        seen, (before, points, behind) = targets @ axes.T, self.cloud[near] @ axes.T
        weight = self._weight(self.cloud[place], axes)
        square = np.sum(weight * points**2, axis=1) - 2 * seen @ (weight * points).T
        best = np.argmin(square + seen**2 @ weight.T, axis=1)
        root = np.sqrt(weight[best])
        still = (seen - points[best]) * root
        moved = still
        neighbours = [[points[_within(best + step, len(weight))] for step in (-1, 1)]]
        if self.joined:
            neighbours.append([before[best], behind[best]])
        for sides in neighbours:
            moved = _moved(moved, [(side - points[best]) * root for side in sides])
        left = moved / root
        there = self._weight(targets - left @ back.T, axes)
        return np.asarray(np.minimum(np.sum(still**2, axis=1), np.sum(there * left**2, axis=1)))

    def _turn(self, place: int, white: FloatArray) -> FloatArray:
        """Return what turns whitened data to axes along which a place's doubts are uncorrelated, too."""
        doubt = self._doubt(self.cloud[place])
        loudness = 1 + doubt @ np.sum(white**2, axis=0)  # what is louder than the data counts alike
        typical = np.mean(doubt / loudness[:, None], axis=0)
        return np.asarray(np.linalg.eigh((white * typical) @ white.T).eigenvectors)

    def _weight(self, change: FloatArray, axes: FloatArray) -> FloatArray:
        """Return one over the variance along axes, where a change (..., n_data) is as doubtful as it is [-]."""
        return np.asarray(1 / (1 + self._doubt(change) @ (axes**2).T))

    def _doubt(self, change: FloatArray) -> FloatArray:
        """Return the variance of data by how far the idealisation of a change of them may be off [-]."""
        slack = 0.0 if self.slack is None else self.slack
        return np.asarray((self.fidelity * change) ** 2 + slack**2)


def _within(index: IntArray | int, count: int) -> IntArray:
    return np.asarray(np.clip(index, 0, count - 1))


def _moved(left: FloatArray, tangents: list[FloatArray]) -> FloatArray:
    """Move along the one of the tangents that brings targets nearer, by no more than its length.

    Parameters
    ----------
    left : (n, m) array
        From the surface to each target.
    tangents : list of (n, m) arrays
        From there to neighbours on the surface.
    """
    best = left
    for tangent in tangents:
        size = np.einsum("ij,ij->i", tangent, tangent)
        share = np.einsum("ij,ij->i", left, tangent) / np.maximum(size, 1e-300)
        tried = left - np.clip(share, 0.0, 1.0)[:, None] * tangent
        nearer = np.linalg.norm(tried, axis=1) < np.linalg.norm(best, axis=1)
        best = np.where(nearer[:, None], tried, best)
    return best
