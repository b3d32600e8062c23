"""Structures that come as matrices of another program: one reader per format, one table of nodes."""

from updating.models.imported.matrices import Imported
from updating.models.imported.nodes import NodeTable, read_deck_table, read_table
from updating.models.imported.read import READERS, Names, read_imported, read_matrix
from updating.models.imported.units import SI, UNITS

__all__ = [
    "READERS",
    "SI",
    "UNITS",
    "Imported",
    "Names",
    "NodeTable",
    "read_deck_table",
    "read_imported",
    "read_matrix",
    "read_table",
]
