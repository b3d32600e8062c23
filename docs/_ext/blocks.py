"""Blocks of a page that are run: which there are, and whether what they print is what stands on the page.

A page is Markdown. A block ``console`` holds commands, each on a line that begins with ``$ ``, and what they print;
``python`` is executed, all blocks of a page in one namespace. A comment on the line before a block says more:

* ``<!-- printed -->``: what the Python before it prints;
* ``<!-- file: NAME -->``: written to a file before what follows is run;
* ``<!-- slow -->``: too long for every build, run by ``pytest --slow`` and by ``--refresh --slow``;
* ``<!-- needs ccx -->``: run where that program is;
* ``<!-- hidden -->``: run, and not shown: what draws a figure;
* ``<!-- shown -->``: not run at all.

Blocks of other kinds (``sh``, ``toml``) are there to be read. ``...`` on a line of its own stands for any lines.
"""

from __future__ import annotations

import difflib
import re
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

FENCE = re.compile(
    r"(?:^<!-- (?P<mark>[^\n]*) -->\n)?^```(?P<kind>console|python|text|toml)\n(?P<body>.*?)^```$",
    flags=re.MULTILINE | re.DOTALL,
)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w])")
OMITTED = "..."


@dataclass(frozen=True)
class Block:
    """A block of a page that is run, written to a file, or compared.

    Parameters
    ----------
    kind, mark, body : str
        Kind of the fence, the comment before it (empty: none), what it holds.
    line : int
        Line of the page on which the body begins, from 1.
    span : tuple of int
        Where the body stands in the text of the page.
    """

    kind: str
    mark: str
    body: str
    line: int
    span: tuple[int, int]

    @property
    def file(self) -> str | None:
        """Name of the file that the block is written to, if it is."""
        return self.mark.removeprefix("file: ") if self.mark.startswith("file: ") else None

    def runs(self, *, slow: bool) -> bool:
        """Say whether the block is run: here, and now."""
        needed = re.findall(r"needs (\w+)", self.mark)
        missing = [program for program in needed if shutil.which(program) is None]
        return self.mark != "shown" and not missing and (slow or "slow" not in self.mark)

    def commands(self) -> list[tuple[str, str]]:
        """Return the commands of a console with what each prints."""
        parts = re.split(r"^\$ (.*)\n", self.body, flags=re.MULTILINE)[1:]
        return list(zip(parts[::2], parts[1::2], strict=True))


def blocks(text: str) -> Iterator[Block]:
    """Yield the blocks of a page in their order."""
    for found in FENCE.finditer(text):
        start = found.start("body")
        line = text.count("\n", 0, start) + 1
        yield Block(found["kind"], found["mark"] or "", found["body"], line, (start, found.end("body")))


ROUNDED = Decimal("0.03")
"""How far apart, relative to their size, two numbers are that print the same result [-]."""


MEASURED = re.compile(r" (%|sigma)")
"""What follows a whole number that is no count."""


STATED = re.compile(r"(Cause|Where|Sure):")
"""Lines of an answer on which per cents are probabilities."""


SAMPLED = Decimal(5)
"""How far apart two probabilities are that print the same result [%]: a hundred samples leave the logarithm of each
evidence off by a tenth, and other samples are drawn where rounding differs."""


MORE = re.compile(r"or \d+ more")
"""How many less probable sets a line leaves out: those of a per cent come and go with their probabilities."""


PRECISE = 5
"""From so many digits on a number is a measurement's, and has its last digit [-]."""


def alike(written: str, printed: str) -> bool:
    """Say whether a line prints the same: every word, numbers to one unit of their last digit, of few digits to 3 %.

    So much another processor's rounding moves: a search that rests a step earlier, a sample more or less. Whole numbers
    are counts, and equal, but those of per cent and sigma. Widths of columns follow from the numbers and do not matter.
    Probabilities of an answer are sampled.
    """
    if written == printed:
        return True
    written, printed = MORE.sub("or more", written), MORE.sub("or more", printed)
    sampled = STATED.match(written) is not None
    words = [NUMBER.sub("#", line).split() for line in (written, printed)]
    numbers = [list(NUMBER.finditer(line)) for line in (written, printed)]
    return words[0] == words[1] and all(
        _near(a.group(), b.group(), counted=MEASURED.match(written, a.end()) is None)
        or (sampled and written.startswith(" %", a.end()) and _as_probable(a.group(), b.group()))
        for a, b in zip(*numbers, strict=True)
    )


def _as_probable(a: str, b: str) -> bool:
    return abs(Decimal(a) - Decimal(b)) <= SAMPLED


def _near(a: str, b: str, *, counted: bool) -> bool:
    if a == b:
        return True
    if counted and not set(a + b) & set(".e"):
        return False
    one, other = Decimal(a), Decimal(b)
    unit = max(Decimal(1).scaleb(int(d.as_tuple().exponent)) for d in (one, other))
    few = min(len(d.as_tuple().digits) for d in (one, other)) < PRECISE
    return abs(one - other) <= max(unit, few * ROUNDED * max(abs(one), abs(other)))


def same(written: str, printed: str) -> bool:
    """Say whether what is printed is what is written, ``...`` standing for any lines."""
    return _matches(written.rstrip().splitlines(), printed.rstrip().splitlines())


def _matches(written: list[str], printed: list[str]) -> bool:
    if not written:
        return not printed
    if written[0] == OMITTED:
        return any(_matches(written[1:], printed[k:]) for k in range(len(printed) + 1))
    return bool(printed) and alike(written[0], printed[0]) and _matches(written[1:], printed[1:])


def renewed(written: str, printed: str) -> str:
    """Return what is printed now, in the place of what is written, shortened where that was."""
    if same(written, printed):
        return written
    lines, old = printed.rstrip().splitlines(), written.rstrip().splitlines()
    if OMITTED not in old:
        return printed.rstrip() + "\n"
    parts = "\n".join(old).split(f"{OMITTED}")
    kept = [part.strip("\n").splitlines() for part in parts]
    out, place = [], 0
    for number, part in enumerate(kept):
        if number:
            out.append(OMITTED)
            place = _place(part, lines, place) if part else len(lines)
            if number == len(kept) - 1 and part:
                place = max(place, 0)
        out += lines[place : place + len(part)]
        place += len(part)
    return "\n".join(out) + "\n"


def _place(part: list[str], lines: list[str], place: int) -> int:
    """Return the line most like the first of a part, from some place on."""

    def likeness(k: int) -> float:
        return difflib.SequenceMatcher(None, NUMBER.sub("#", part[0]), NUMBER.sub("#", lines[k])).ratio()

    return max(range(place, len(lines)), key=likeness, default=place)


def page_name(page: Path, root: Path) -> str:
    """Return the name under which a page's files are kept: its path below ``docs``, without ending."""
    inside = page.relative_to(root / "docs") if page.is_relative_to(root / "docs") else page.relative_to(root)
    return inside.with_suffix("").as_posix()
