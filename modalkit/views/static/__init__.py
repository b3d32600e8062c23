"""Drawings of the browser as plain modules and the style of charts: those that the app and the report share."""

from __future__ import annotations

from importlib.resources import files
from importlib.resources.abc import Traversable


def shared() -> dict[str, Traversable]:
    """Return the modules and the style by their names."""
    return {entry.name: entry for entry in files(__name__).iterdir() if entry.name.endswith((".js", ".css"))}
