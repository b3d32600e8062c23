"""Where the points of a test lie on a model whose length, or width, is not what the study states.

The test's coordinates are measured; a longer model is the nominal one stretched. Points keep their distance from the
free end; between two ends of a kind, from the middle.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.spec import Spec


@dataclass(frozen=True, eq=False)
class Stretch:
    """How factors stretch a model along its axes, and the study's coordinates on it.

    Parameters
    ----------
    spec : Spec
        The nominal model.
    """

    spec: Spec

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Factors that stretch the model, one for each axis that has one."""
        return ("length", "width") if self.spec.kind == "plate" else ("length",)

    @cached_property
    def sizes(self) -> FloatArray:
        """What they stretch, (n_axes,) [m]."""
        return np.array([self.spec.length, self.spec.width][: len(self.names)])

    @cached_property
    def growths(self) -> FloatArray:
        """How far the origin moves per unit of stretch along each axis, (n_axes,) [m]."""
        axes = "xy"[: len(self.names)]
        clamped = [{edge for edge in self.spec.clamped if edge[0] == axis} for axis in axes]
        share = [0.5 if len(edges) != 1 else float(edges < {"x0", "y0"}) for edges in clamped]
        return np.asarray(np.array(share) * self.sizes)

    def by(self, factors: Mapping[str, float]) -> FloatArray:
        """Return the stretch along each axis, (n_axes,), 1 where a state has none [-]."""
        return np.array([factors.get(name, 1.0) for name in self.names])

    def undone(self, points: FloatArray, stretch: FloatArray) -> FloatArray:
        """Return where points of the study lie on the model before it was stretched, (n, dim) [m]."""
        before, axes = np.array(points), len(stretch)
        before[:, :axes] = (before[:, :axes] + self.growths * (stretch - 1)) / stretch
        return before

    def unstretched(self, values: Mapping[str, Any], factors: Mapping[str, float]) -> dict[str, Any]:
        """Return values of an effect whose places ``x`` and ``y`` are those of the model before it was stretched.

        Regions, and the bodies that the study states, stretch with the model.

        Parameters
        ----------
        values : mapping
            The effect's parameters, places as the study has its coordinates [m].
        factors : mapping
            What the model's factors are.
        """
        found = dict(values)
        for place, size, growth, stretch in zip(
            "xy", self.sizes, self.growths, self.by(factors), strict=False
        ):
            if place in found and stretch != 1.0:
                before = (found[place] + growth * (stretch - 1)) / stretch
                found[place] = float(np.clip(before, 0.0, size))
        return found


def is_placed(values: Mapping[str, Any]) -> bool:
    """Return whether an effect has a place in the study's coordinates, which others may stretch under it."""
    return bool({"x", "y"} & values.keys())
