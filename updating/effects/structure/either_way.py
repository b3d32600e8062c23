"""A place with more or with less of something than modelled: two forms of one effect, nothing in the middle."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.box import Place, extent_parameters, outline, place, where_alike
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.regions import region_centre
from updating.prediction.predict import Predictor

HALVES = (0.5, 1.0), (0.0, 0.5)
"""Quantiles of the two forms."""


class EitherWay(Effect):
    """On a stretch of a beam, a rectangle of a plate, or a region of matrices.

    The prior of the last parameter is uniform in the logarithm of the size that data determine, on either side.
    """

    keeps_clamps = True
    models = ("beam", "plate", "matrices")
    named = ("region",)
    repeats = True
    among: ClassVar[tuple[float, float]]
    """Range of the extents, relative to the side [-]."""
    why: ClassVar[str]
    """Why this range."""
    lacking: ClassVar[str]
    """What matrices without parts of regions lack."""
    upper: ClassVar[float]
    """Prior of the form in the upper half of the quantiles [-]."""

    @abstractmethod
    def changed(self, predictor: Predictor) -> Parameter:
        """Return the last parameter."""

    @abstractmethod
    def regions(self, predictor: Predictor) -> Sequence[str]:
        """Return the regions of matrices that may be changed."""

    @abstractmethod
    def size_range(self, predictor: Predictor, values: Values, *, upper: bool) -> tuple[float, float]:
        """Return the range of the size on one side [-]."""

    @abstractmethod
    def size(self, value: float) -> float:
        """Return the size that a value of the last parameter has, negative of the lower half [-]."""

    @abstractmethod
    def value(self, size: float) -> float:
        """Return the value of the last parameter that has a size: the inverse of :meth:`size`."""

    def two_sided(self, predictor: Predictor) -> bool:
        """Return whether the quantiles are those of the size."""
        return True

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return place, extents and change; of imported matrices the change of a region."""
        spec, last = predictor.spec, self.changed(predictor)
        if spec.kind == "matrices":
            return (last,)
        sides = extent_parameters(spec, *self.among, self.why, natural=("low",))
        return (*outline(predictor), *sides, last)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need regions with parts of their own where there are matrices."""
        if predictor.spec.kind != "matrices" or len(self.regions(predictor)) > 1:
            return None
        return Obstacle(Lack.MODEL, self.lacking)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return both forms, of imported matrices for each region."""
        regional = predictor.spec.kind == "matrices"
        known = [{"region": name} for name in self.regions(predictor)] if regional else [{}]
        if not self.two_sided(predictor):
            return tuple(Variant(own, 1 / len(known)) for own in known)
        name = self.changed(predictor).name
        halves = zip((self.upper, 1 - self.upper), HALVES, strict=True)
        return tuple(
            Variant(own, share / len(known), {name: half}) for share, half in halves for own in known
        )

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles to values; the last one is that of the size."""
        values = super().values(predictor, coordinates)
        if self.two_sided(predictor):
            u = coordinates[-1]
            low, high = self.size_range(predictor, values, upper=u >= 0.5)
            size = float(low * (high / low) ** abs(2 * u - 1))
            values[self.changed(predictor).name] = self.value(size if u >= 0.5 else -size)
        return values

    def quantiles(self, predictor: Predictor, values: Values) -> list[float]:
        """Take values to prior quantiles; of the last one that of its size."""
        found, name = super().quantiles(predictor, values), self.changed(predictor).name
        known = "extent" in values or predictor.spec.kind == "matrices"
        if self.two_sided(predictor) and name in values and known:
            size = self.size(float(values[name]))
            low, high = self.size_range(predictor, values, upper=size >= 0)
            half = float(np.clip(np.log(max(abs(size), low) / low) / np.log(high / low), 0.0, 1.0)) / 2
            found[-1] = 0.5 + half if size >= 0 else 0.5 - half
        return found

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the middle; where no shapes separate it from its mirror images, these too."""
        if predictor.spec.kind == "matrices":
            return (region_centre(predictor, values),)
        return where_alike(predictor, place(values))
