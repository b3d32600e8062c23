"""Column text as measurement: CSV, tabs, LabVIEW files, with rate, units and points from a small layout file."""

from acquisition.columns.layout import Column, Layout, layout_from, read_layout
from acquisition.columns.proposal import propose_layout
from acquisition.columns.read import read_columns
from acquisition.columns.read_frfs import read_frf_columns
from acquisition.columns.rules import FileRule

__all__ = [
    "Column",
    "FileRule",
    "Layout",
    "layout_from",
    "propose_layout",
    "read_columns",
    "read_frf_columns",
    "read_layout",
]
