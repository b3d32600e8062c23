"""What every way to localise an error shares: it takes a test beside a model, and gives each region a score."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Literal

import numpy as np

from acquisition.arrays import FloatArray
from updating.problem.specimen import SpecimenProblem

Kind = Literal["stiffness", "mass", "damping"]
"""What of a region may be wrong."""

KINDS: tuple[Kind, ...] = ("stiffness", "mass", "damping")
"""All of them."""


class Localiser(ABC):
    """A way to find the region in which a model errs.

    A subclass states the class variables and implements :meth:`scores`.
    """

    summary: ClassVar[str]
    """One sentence on what it compares."""
    needs: ClassVar[str]
    """One sentence on the data that it needs."""
    misleads: ClassVar[str]
    """One sentence on when its first region is the wrong one."""
    source: ClassVar[str]
    """Where it is published."""
    kinds: ClassVar[tuple[Kind, ...]] = ("stiffness",)
    """What of a region it can suspect."""
    needs_shapes: ClassVar[bool] = True
    """Whether it can do nothing with frequencies and damping alone."""

    @abstractmethod
    def scores(self, problem: SpecimenProblem, *, kind: Kind = "stiffness") -> FloatArray:
        """Return how suspect each region is.

        Parameters
        ----------
        problem : Problem
            A test beside a model.
        kind : {"stiffness", "mass", "damping"}
            What of the regions may be wrong.

        Returns
        -------
        (n_regions,) array
            Not negative, the greater the more suspect; all zero where the data are not informative [-].
        """

    def obstacle(self, problem: SpecimenProblem, *, kind: Kind = "stiffness") -> str | None:
        """Return why the method cannot be used on these data, or None."""
        if kind not in self.kinds:
            return f"compares {' and '.join(self.kinds)} alone"
        if self.needs_shapes and not problem.measured.has_shapes:
            return "needs mode shapes at points of the model; this test has none"
        if kind == "damping" and not len(problem.damping_known):
            return "needs damping, both measured and expected of the model"
        return None


def areas(problem: SpecimenProblem) -> FloatArray:
    """Return how large each region is relative to all: of area on a plate, of mass on imported matrices.

    Returns
    -------
    (n_regions,) array
        Summing to 1 [-].
    """
    spec = problem.predictor.spec
    if spec.imported is not None:
        return _masses(problem)
    size = np.array([_area(r.x, r.y, spec.width) for r in spec.regions])
    return np.asarray(size / size.sum())


def _area(x: Sequence[float], y: Sequence[float] | None, width: float) -> float:
    return (x[1] - x[0]) * (width if y is None else y[1] - y[0])


def _masses(problem: SpecimenProblem) -> FloatArray:
    """Return the share of each region in the mass; equal shares where no parts of the mass are given."""
    reduced = problem.predictor.reduced
    parts = [p for t, p in zip(reduced.structure.terms, reduced.parts, strict=True) if t.kind == "mass"]
    size = np.sum([np.trace(p[:-1], axis1=1, axis2=2) for p in parts], axis=0)
    if not size.sum() > 0:
        size = np.ones(len(size))
    return np.asarray(size / size.sum())
