"""What the modeller thinks may be so: another stiffness, another mass, another value of a parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.checks import symmetric
from updating.models.imported.shifted import Shifted

if TYPE_CHECKING:
    from updating.models.imported.decks import DeckParameter

SAME = 1e-9
"""A change below this share of the matrix's largest entry is rounding of the file's digits [-]."""


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A change of the model, to be taken up in part, in full, or beyond.

    Parameters
    ----------
    name : str
        As the study calls it.
    why : str
        Why it may be so.
    low, high : float
        How far towards it the model may go, 0 as it stands and 1 all the way [-]; of a parameter its range [its unit].
    stiffness, mass : (n, n) sparse array, optional
        What it changes: the difference from the model's own [SI].
    factor : str
        Factor of the model that a parameter moves, ``E`` or ``density``; empty for matrices.
    region : int
        The region whose factor that is; -1 is the whole structure.
    nominal : float
        The parameter's value in the model [its unit].
    unit : str
        Unit of the parameter, ``-`` where the model has no material.
    of_deck : DeckParameter, optional
        The number of a deck that the parameter is.
    changes : tuple of (stiffness, mass)
        What that number changes at the ends of its range: static answers to it join the basis [SI].
    """

    name: str
    why: str
    low: float
    high: float
    stiffness: Sparse | None = None
    mass: Sparse | None = None
    factor: str = ""
    region: int = -1
    nominal: float = 1.0
    unit: str = "-"
    of_deck: DeckParameter | None = None
    changes: tuple[tuple[Sparse, Sparse], ...] = ()

    @property
    def of_parameter(self) -> bool:
        """Whether it is another value of a parameter, not other matrices."""
        return bool(self.factor) or self.of_deck is not None

    @property
    def as_modelled(self) -> float:
        """Value of the parameter where the model stands: none of how far nodes are moved [its unit]."""
        return self.nominal * (1.0 if self.of_deck is None else self.of_deck.start)

    @property
    def differences(self) -> tuple[Sparse, ...]:
        """Every matrix by which it differs from the model; none of a modulus or a density [SI]."""
        known = [matrix for matrix in (self.stiffness, self.mass) if matrix is not None]
        return (*known, *(matrix for pair in self.changes for matrix in pair))


def change_of(own: Sparse, other: Sparse, what: str) -> Sparse:
    """Return by how much another matrix differs from the model's own.

    Parameters
    ----------
    own, other : sparse arrays
        Of the model, and if the hypothesis were so [SI].
    what : str
        For messages: the hypothesis and the file.

    Raises
    ------
    StudyError
        If the other is of another order, not symmetric, or the same.
    """
    if other.shape != own.shape:
        raise StudyError(
            f"{what} is of order {other.shape[0]} and the model of order {own.shape[0]}; export both from one "
            "mesh with the same supports"
        )
    change = _change(own, symmetric(other, what))
    if not change.nnz:
        raise StudyError(
            f"{what} is identical to the model's own, so the hypothesis changes nothing; export it with the change"
        )
    return change


def same_as(own: Sparse, other: Sparse) -> bool:
    """Return whether another matrix is the model's own, but for the digits of its file."""
    return own.shape == other.shape and not _change(own, other).nnz


def _change(own: Sparse, other: Sparse) -> Sparse:
    change = Sparse(other - own)
    change.data[np.abs(change.data) <= SAME * float(np.abs(own.data).max(initial=0.0))] = 0.0
    change.eliminate_zeros()
    return change


def check_ends(hypothesis: Hypothesis, stiffness: Sparse, mass: Sparse) -> None:
    """See that the model can be at both ends of a hypothesis' range.

    Raises
    ------
    StudyError
        If a motion has negative stiffness there, or a degree of freedom no mass.
    """
    for end in (hypothesis.low, hypothesis.high):
        whole = f"hypothesis {hypothesis.name!r} at {end:g}"
        k = stiffness if hypothesis.stiffness is None else Sparse(stiffness + end * hypothesis.stiffness)
        m = mass if hypothesis.mass is None else Sparse(mass + end * hypothesis.mass)
        if not (m.diagonal() > 0).all():
            row = int(np.argmin(m.diagonal())) + 1
            raise StudyError(
                f"{whole}: row {row} has no mass, or a negative one; narrow its range, or check the matrix"
            )
        _ = Shifted(k, m, whole).factor
