"""Formats of others: readers that a session registers or an installed package offers, by file ending."""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path

from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from acquisition.hits.hammer import HammerTest
from acquisition.modal_data import ModalData

Found = HammerTest | FrfSet | ModalData
"""What a file of a test may hold."""

Reader = Callable[[Path], Found]
GROUP = "modalkit.readers"

_REGISTERED: dict[str, Reader] = {}


def register_reader(ending: str, reader: Reader) -> None:
    """Make the files of an ending readable wherever files of a test are: in `read`, `read_test`, `read_modes`, a study.

    Parameters
    ----------
    ending : str
        Of the files' names, ``".abc"``. A reader registered for it before is replaced.
    reader : callable
        A function from a path to hits, FRFs or modes.
    """
    _REGISTERED[with_dot(ending)] = reader


def installed_readers() -> dict[str, Reader]:
    """Return the readers of others by file ending: those that installed packages offer, and those registered.

    A package offers one as an entry point of the group ``modalkit.readers`` whose name is the ending, as
    ``".abc"``, and whose object is a function from a path to a `HammerTest`, `FrfSet` or `ModalData`.
    """
    offered = {point.name.lower(): point.load() for point in entry_points(group=GROUP)}
    return offered | _REGISTERED


def read_by(reader: Reader, path: Path) -> Found:
    """Return what a reader of others makes of a file.

    Raises
    ------
    InputError
        If it is none of what a file of a test may hold.
    """
    result = reader(path)
    if not isinstance(result, Found):
        raise InputError(
            f"{path}: its reader returned {type(result).__name__}; a reader returns a HammerTest, an FrfSet or a "
            "ModalData"
        )
    return result


def with_dot(ending: str) -> str:
    """Return a file ending in small letters, with its dot."""
    return ending.lower() if ending.startswith(".") else f".{ending.lower()}"
