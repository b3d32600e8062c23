"""Decks as models: CalculiX makes the matrices, of all, of each element set, and for other numbers in it."""

from updating.models.imported.decks.model import (
    KNOWN,
    DeckModel,
    deck_matrices,
    parameter_matrices,
    read_deck_model,
)
from updating.models.imported.decks.parameters import DeckParameter

__all__ = [
    "KNOWN",
    "DeckModel",
    "DeckParameter",
    "deck_matrices",
    "parameter_matrices",
    "read_deck_model",
]
