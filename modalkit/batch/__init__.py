"""Many studies at once: a folder of studies in, a table of modes, factors and causes out."""

from modalkit.batch.find import Found, find_studies
from modalkit.batch.part import SCHEMA, part_document
from modalkit.batch.run import BatchResult, Part, run_batch
from modalkit.batch.tables import tables
from modalkit.batch.writing import table_places, write_tables

__all__ = [
    "SCHEMA",
    "BatchResult",
    "Found",
    "Part",
    "find_studies",
    "part_document",
    "run_batch",
    "table_places",
    "tables",
    "write_tables",
]
