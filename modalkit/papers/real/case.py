"""A test of a real structure of which more is known than the diagnosis is given."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

MEASURED = "measured"
PUBLISHED = "published numbers"
SYNTHETIC = "synthetic"
Sets = tuple[frozenset[str], ...]


def sets(*names: str) -> Sets:
    """Return sets of effects from their names, those of a pair joined by `` + ``."""
    return tuple(frozenset(name.split(" + ")) for name in names)


@dataclass(frozen=True)
class Fact:
    """A number that is known of the structure.

    Parameters
    ----------
    parameter : str
        Under the contract's name, ``effect.parameter``.
    low, high : float
        What it lies between; the same where it is known well [unit of the parameter].
    text : str
        As it is printed.
    """

    parameter: str
    low: float
    high: float
    text: str


@dataclass(frozen=True)
class Source:
    """A study, and what of it the diagnosis is given.

    Parameters
    ----------
    path : Path, optional
        Study file, from the folder of the samples or of the data; where the study is given as text, the file of
        measured data that its modes were identified from, or none where everything is given here.
    text : str
        The study itself, where there is no such file.
    tables : tuple of (str, str)
        Files that the study names, with what stands in them, where those are no files either.
    drop : tuple of str
        Tables of the study that are left out, ``baseline`` for instance.
    """

    path: Path | None = None
    text: str = ""
    tables: tuple[tuple[str, str], ...] = ()
    drop: tuple[str, ...] = ()


@dataclass(frozen=True)
class Case:
    """A test whose cause is known, and withheld.

    Parameters
    ----------
    name : str
        Short and unique.
    kind : str
        Whether the data were measured by others, are numbers that a paper prints, or are synthetic, made from them.
    sources : tuple of Source
        The studies, diagnosed together.
    withheld : str
        What the diagnosis is not given.
    known : str
        What is truly known, in a few words.
    source : str
        Where that is written, and how well it is known.
    accepted : tuple of frozenset of str
        Sets of effects that are the right answer; one empty set where nothing is missing.
    equivalent : tuple of frozenset of str
        Sets that these data cannot separate from the right one, so that a class may list them.
    stands_in : tuple of frozenset of str
        Sets that say the same under another name, where the right ones are not in the library.
    why : str
        Why those are equivalent, or stand in.
    facts : tuple of Fact
        Numbers that an answer has to meet.
    places : tuple of (low, high)
        Stretches of x one of which the answer has to point to [m]; empty where it has no place.
    shared : tuple of str
        Effects of one size in all studies.
    removed : tuple of str
        Effects taken out of the library.
    in_data : bool
        Whether the sources with a path lie in the folder of data, not in that of the samples.
    """

    name: str
    kind: str
    sources: tuple[Source, ...]
    withheld: str
    known: str
    source: str
    accepted: Sets
    equivalent: Sets = ()
    stands_in: Sets = ()
    why: str = ""
    facts: tuple[Fact, ...] = ()
    places: tuple[tuple[float, float], ...] = ()
    shared: tuple[str, ...] = ()
    removed: tuple[str, ...] = field(default=())
    in_data: bool = False

    def left_out(self, *also: str) -> Case:
        """Return the same test with its true effects taken out of the library.

        Parameters
        ----------
        *also : str
            Effects that are taken out as well, exact equivalents for instance.
        """
        names = {name for accepted in self.accepted for name in accepted} | set(also)
        shared = tuple(name for name in self.shared if name not in names)
        return replace(
            self,
            name=f"{self.name}, left out",
            removed=tuple(sorted(names)),
            facts=(),
            places=(),
            shared=shared,
        )
