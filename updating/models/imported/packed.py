"""What packed files of matrices unpack to, never more than in proportion to what they are."""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path

from acquisition.archives import allowed
from acquisition.errors import StudyError


def too_much(path: Path, packed: int) -> StudyError:
    """Return the error of a file that becomes too much."""
    return StudyError(
        f"{path}: {packed} bytes that decompress to more than {allowed(packed)}; unpack it first, or save it without "
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
        raise StudyError(f"{path}: not a whole .gz ({error}); compress it again") from error
    return content
