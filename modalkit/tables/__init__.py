"""The tables of the papers, through the whole chain from universal files, our value beside the published one."""

from modalkit.tables.paper_a import tables_a
from modalkit.tables.render import PaperTable, render, tables

__all__ = ["PaperTable", "render", "tables", "tables_a"]
