"""All terms of a model's stiffness and mass on some columns of its basis, in one array."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.models.base import Term


@dataclass(frozen=True, eq=False)
class StackedTerms:
    """Terms with their matrices over the whole structure.

    Parameters
    ----------
    terms : tuple of n_terms Term
        Those of the stiffness, then those of the mass.
    matrices : (n_terms, n, n) array
        On the leading n columns of the basis, no factor applied [SI].
    """

    terms: tuple[Term, ...]
    matrices: FloatArray

    @classmethod
    def of(cls, terms: Sequence[tuple[Term, FloatArray]], n: int) -> StackedTerms:
        """Return terms with their matrices on the leading n columns."""
        ordered = sorted(terms, key=lambda one: one[0].kind == "mass")
        return cls(tuple(term for term, _ in ordered), np.array([matrix[:n, :n] for _, matrix in ordered]))

    @cached_property
    def heavy(self) -> BoolArray:
        """Which terms are of the mass, (n_terms,)."""
        return np.array([term.kind == "mass" for term in self.terms])

    def scales(self, factors: Mapping[str, float]) -> FloatArray:
        """Return what factors make of every term, (n_terms,) [-]."""
        return np.array([term.scale(factors) for term in self.terms])

    def add_to(self, stiffness: FloatArray, mass: FloatArray, factors: Mapping[str, float]) -> None:
        """Add all terms under some factors to stiffness and mass, (n, n) each [SI]."""
        scales = self.scales(factors).tolist()
        for heavy, scale, matrix in zip(self.heavy.tolist(), scales, self.matrices, strict=True):
            total = mass if heavy else stiffness
            total += matrix if scale == 1.0 else matrix * scale
