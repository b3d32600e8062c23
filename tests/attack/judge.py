"""What became of a mutant: one word for it."""

from __future__ import annotations

import contextlib
import resource
import signal
import warnings
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import numpy as np
from family import Case, Family, Reading
from mutators import KINDS, mutate

from acquisition.errors import ModalkitError

OUTCOMES = (
    "refused", "same", "warned", "undetectable", "changed", "foreign", "long", "hang", "memory", "crash",
)  # fmt: skip
BAD = ("changed", "foreign", "long", "hang", "memory", "crash")
"""Outcomes that must not be: ``changed`` is without a word, ``long`` a message of several lines."""

SECONDS = 5.0
"""CPU time after which a mutant of some kilobytes hangs [s]; the whole file takes milliseconds."""

TWICE = 0.2
"""Share of mutants that are damaged in a second place [-]."""

FLOOR, TIMES = 100_000_000, 10
"""Memory that reading may take beyond what the process has: a floor for libraries and allocators [bytes], and what a
file's size is multiplied by [-]."""


@dataclass(frozen=True)
class Verdict:
    """What became of one mutant."""

    family: str
    index: int
    case: str
    damage: str
    outcome: str
    message: str


class Hang(BaseException):
    """The time is up; no reader catches it."""


class Judge:
    """Makes mutants of a family and judges them; the whole files are read once.

    Every case has a folder of its own in the one given, where each mutant takes the place of the one before.
    """

    def __init__(self, family: Family, seed: int, folder: Path) -> None:
        self.family, self.seed, self.folder = family, seed, folder
        self.whole = [self._reading(case, case.content) for case in family.cases]

    def mutant(self, index: int) -> tuple[int, str, bytes]:
        """Return number of the case, damage and content of a mutant: always the same for a seed and an index."""
        number, damage, steps = self._steps(index)
        return number, damage, steps[-1]

    def _steps(self, index: int) -> tuple[int, str, list[bytes]]:
        """Return number of the case, damage, and the content after each damage."""
        rng = np.random.default_rng([self.seed, zlib.crc32(self.family.name.encode()), index])
        number = int(rng.integers(0, len(self.family.cases)))
        case, kind = self.family.cases[number], KINDS[index % len(KINDS)]
        name, content = mutate(case.content, case.head, kind, rng)
        steps = [content]
        if rng.random() < TWICE:
            second, content = mutate(content, len(content) // 2, "bytes", rng)
            name = f"{name} + {second}"
            steps.append(content)
        return number, f"{kind}: {name}", steps

    def judge(self, index: int) -> Verdict:
        """Make a mutant, read it, and say what became of it."""
        number, damage, steps = self._steps(index)
        case = self.family.cases[number]
        outcome, message = self._outcome(case, steps[-1], self.whole[number])
        if outcome == "changed" and len(steps) == 2 and self._each(case, steps, self.whole[number]):
            outcome = "undetectable"
        return Verdict(self.family.name, index, case.name, damage, outcome, message)

    def _outcome(self, case: Case, content: bytes, whole: Reading) -> tuple[str, str]:
        path = self._written(case, content)
        try:
            with limits(len(content)), warnings.catch_warnings():
                warnings.simplefilter("error")
                found = self.family.reading(path)
        except ModalkitError as error:
            text = str(error)
            return ("long" if "\n" in text.strip() else "refused"), text
        except Hang:
            return "hang", ""
        except MemoryError:
            return "memory", ""
        except Exception as error:  # noqa: BLE001 - the very thing that is looked for
            return "foreign", f"{type(error).__name__}: {error}"
        if found.digest == whole.digest:
            return "same", ""
        if set(found.warnings) - set(whole.warnings):
            return "warned", next(iter(set(found.warnings) - set(whole.warnings)))
        hidden = case.undetectable(case.content, content) or self._in_numbers(case, content, whole)
        return ("undetectable" if hidden and self._as_written(case, content, found) else "changed"), ""

    def _as_written(self, case: Case, content: bytes, found: Reading) -> bool:
        """Tell whether what was made of a mutant is what is made of the same numbers in other digits."""
        other = content if case.plainly is None else case.plainly(content)
        try:
            return other == content or self._reading(case, other).digest == found.digest
        except ModalkitError:
            return False

    def _each(self, case: Case, steps: list[bytes], whole: Reading) -> bool:
        """Tell whether each of two damages alone changes nothing, or what no reader could see."""
        first, _ = self._outcome(case, steps[0], whole)
        if first not in ("same", "undetectable"):
            return False
        if case.undetectable(steps[0], steps[1]):
            return True
        before, after = (self._reading(case, step).digest for step in steps)
        return before == after

    def _in_numbers(self, case: Case, content: bytes, whole: Reading) -> bool:
        """Tell whether a mutant says what the whole file says but for its numbers in binary."""
        if not case.spans:
            return False
        try:
            return self._reading(case, case.repaired(content)).digest == whole.digest
        except ModalkitError:
            return False

    def _reading(self, case: Case, content: bytes) -> Reading:
        return self.family.reading(self._written(case, content))

    def _written(self, case: Case, content: bytes) -> Path:
        """Write a content in place of the attacked file, the others beside it where they are not yet."""
        folder = self.folder / str(self.family.cases.index(case))
        if not folder.exists():
            folder.mkdir()
            for name, whole in case.files.items():
                (folder / name).write_bytes(whole)
        (folder / case.name).write_bytes(content)
        return folder / case.name


@contextlib.contextmanager
def limits(size: int) -> Iterator[None]:
    """Limit CPU time and memory while a file of a size [bytes] is read."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    before = signal.signal(signal.SIGPROF, _ring)
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + FLOOR + TIMES * size, hard))
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
        signal.signal(signal.SIGPROF, before)


def _ring(number: int, frame: FrameType | None) -> None:
    raise Hang


def count(verdicts: list[Verdict]) -> Counter[str]:
    """Return how many mutants came to each outcome."""
    return Counter(verdict.outcome for verdict in verdicts)
