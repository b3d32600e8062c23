"""The lines of an input deck and of the files it includes: none includes itself, and none is read over and over."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from acquisition.errors import StudyError

OVER = 10
"""How often the files of a deck may be read on average [-]: a part may be included for each of its copies; twice as
often would let ten small files ask for twice the time."""

DEEPEST = 50
"""Files that may include one another in a row [-]; far more would fill the program's stack."""


@dataclass
class _Work:
    """What has been read: the size of each file, and of all that was read."""

    sizes: dict[Path, int] = field(default_factory=dict)
    done: int = 0

    def read(self, path: Path, where: str) -> str:
        """Return the text of a file, if that is within what the files allow."""
        try:
            text = path.read_text(encoding="latin-1")
        except OSError as error:
            raise StudyError(f"{where}{path}: cannot be read ({error.strerror})") from error
        except ValueError as error:
            raise StudyError(f"{where}{str(path)[:80]!r} is not a file name; correct the *INCLUDE") from error
        self.sizes[path.resolve()] = len(text)
        self.done += len(text)
        if self.done > OVER * sum(self.sizes.values()):
            raise StudyError(f"{where}{path} is included too many times; include every file once")
        return text


def is_include(line: str) -> bool:
    """Return whether a line stands for the text of a file."""
    return line.split(",", maxsplit=1)[0].rstrip().upper() == "*INCLUDE"


def deck_lines(path: Path) -> Iterator[tuple[str, str]]:
    """Yield every card and data line of a deck without blanks around it, and where it stands.

    Raises
    ------
    StudyError
        If a file cannot be read, includes itself, or is included over and over.
    """
    yield from _lines(path, _Work(), (), "")


def _lines(path: Path, work: _Work, above: tuple[Path, ...], where: str) -> Iterator[tuple[str, str]]:
    chain = (*above, path.resolve())
    for number, raw in enumerate(work.read(path, where).split("\n"), start=1):
        line, here = raw.strip(), f"{path}, line {number}"
        if not line or line.startswith("**"):
            continue
        if odd := [c for c in line if c < " " and c != "\t"][:1]:
            raise StudyError(f"{here}: holds the character {odd[0]!r}; the file is damaged")
        yield line, here
        if not is_include(line):
            continue
        other = path.parent / line.partition("=")[2].strip().strip("\"'")
        if other.resolve() in chain or len(chain) == DEEPEST:
            why = "includes itself" if len(chain) < DEEPEST else f"is included by {DEEPEST} files in a row"
            raise StudyError(f"{here}: {other} {why}; leave the *INCLUDE out")
        yield from _lines(other, work, chain, f"{here}: ")
