"""The tables of the papers, through the whole chain from universal files, our value beside the published one."""

from modalkit.tables.collect import FluidWork, Work, fluid_work, tables, work
from modalkit.tables.fluid_a import fluid_tables
from modalkit.tables.joint import joint_table
from modalkit.tables.paper_a import tables_a
from modalkit.tables.paper_b import tables_b
from modalkit.tables.render import PaperTable, render

__all__ = [
    "FluidWork",
    "PaperTable",
    "Work",
    "fluid_tables",
    "fluid_work",
    "joint_table",
    "render",
    "tables",
    "tables_a",
    "tables_b",
    "work",
]
