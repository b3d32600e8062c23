"""What packed files unpack to, never more than in proportion to what they are."""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path

from acquisition.errors import StudyError

RATIO = 30
"""Bytes that one packed byte may become [-]: numbers as text shrink three- to twentyfold; twice as much would
fill twice the memory."""

SMALL = 10_000_000
"""Bytes that any packed file may become, however small it is [-]: less than the libraries take that read it."""


def allowed(packed: int) -> int:
    """Return the bytes that so many packed bytes may become."""
    return max(SMALL, RATIO * packed)


def too_much(path: Path, packed: int) -> StudyError:
    """Return the error of a file that becomes too much."""
    return StudyError(
        f"{path}: {packed} bytes that unpack to more than {allowed(packed)}; unpack it first, or save it without "
        "compression"
    )


def unpacked(path: Path) -> bytearray:
    """Return the content of a ``.gz``.

    Raises
    ------
    StudyError
        If it is damaged, cut short, or becomes too much.
    """
    packed, content = path.stat().st_size, bytearray()
    try:
        with gzip.open(path) as file:
            while part := file.read(1 << 20):
                content += part
                if len(content) > allowed(packed):
                    raise too_much(path, packed)
    except (OSError, EOFError, zlib.error) as error:
        raise StudyError(f"{path}: not a whole .gz ({error}); pack it anew") from error
    return content
