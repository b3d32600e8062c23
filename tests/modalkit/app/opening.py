"""The app's state as the command opens it."""

from __future__ import annotations

from pathlib import Path

from modalkit.app.controller import Controller
from modalkit.app.opened import open_path
from modalkit.app.store import Store

FAINT = 260.0
"""Frequency of a mode that the noise of a fixture all but hides [Hz]."""


def opened(path: Path) -> Controller:
    """Return it."""
    return Controller(open_path(path), Store.beside(path))
