"""What files hold, as a digest: whatever is kept of a study belongs to its files as they were."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

FILES = 256
"""Files whose digests are kept: a study of matrices with a part per region names some dozens."""

CARD = b"*"
"""What an input deck begins with, which may include other files, and no other file that a study names."""

INCLUDE = re.compile(rb"^[ \t]*\*INCLUDE[^\n=]*=[ \t]*[\"']?([^\"'\r\n]+)", re.IGNORECASE | re.MULTILINE)


def digest_of(paths: Iterable[Path]) -> str:
    """Return a digest of what files hold, those they include and the ``.dof`` beside a matrix among them.

    A file is read anew only where its size, its place on the disk or one of its times is another.

    Parameters
    ----------
    paths : iterable of Path
        The files; one that cannot be read counts as such.
    """
    found: list[str] = []
    waiting, known = [path.resolve() for path in paths], set[Path]()
    while waiting:
        path = waiting.pop(0)
        content, included = _content(path)
        found.append(content)
        known.add(path)
        others = [(path.parent / name).resolve() for name in included]
        if (beside := path.with_suffix(".dof")).is_file():
            others.append(beside)
        waiting += [other for other in dict.fromkeys(others) if other not in known]
    return hashlib.sha256("\n".join(found).encode()).hexdigest()[:16]


def _content(path: Path) -> tuple[str, tuple[str, ...]]:
    """Return the digest of a file and the names that it includes."""
    try:
        now = path.stat()
        return _read(path, now.st_ino, now.st_size, now.st_mtime_ns, now.st_ctime_ns)
    except (OSError, ValueError) as error:
        return type(error).__name__, ()


@lru_cache(FILES)
def _read(path: Path, *stamp: int) -> tuple[str, tuple[str, ...]]:
    """Return the same of a file with this stamp."""
    with path.open("rb") as stream:
        if stream.read(64).lstrip()[:1] != CARD:
            stream.seek(0)
            return hashlib.file_digest(stream, "sha256").hexdigest(), ()
    content = path.read_bytes()
    names = (name.decode("latin-1").strip() for name in INCLUDE.findall(content))
    return hashlib.sha256(content).hexdigest(), tuple(names)
