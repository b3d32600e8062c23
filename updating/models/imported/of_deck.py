"""A deck as the matrices that CalculiX makes of it."""

from __future__ import annotations

from updating.models.imported.decks.model import DeckModel
from updating.models.imported.matrices import Imported
from updating.models.imported.units import places_in_si


def imported(deck: DeckModel, *, divided: bool = True) -> Imported:
    """Return the matrices of a deck.

    Parameters
    ----------
    deck : DeckModel
        The deck.
    divided : bool
        Whether there is a part of each region beside the whole.

    Raises
    ------
    StudyError
        If CalculiX does not solve the deck, or its matrices are those of no structure.
    """
    whole = deck.whole  # first: what is wrong with the deck is no fault of a part
    parts = [deck.part(i) for i in range(len(deck.division.regions))] if divided else []
    return Imported(
        *whole,
        places_in_si(deck.table, deck.units),
        tuple(stiffness for stiffness, _ in parts),
        tuple(mass for _, mass in parts),
        str(deck.path),
        deck,
    )
