"""Warnings: which of them change a number, which are of one kind, and in which order they are shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable


class Consequential(str):
    """A warning of something that makes a number of the result another one; equal to any text of the same words."""

    __slots__ = ()


class Located(str):
    """A warning of something found at one place of a file, equal to any text of the same words.

    Parameters
    ----------
    place : str
        Where it was found.
    finding : str
        What was found and what follows: the same words at every place of the same kind.
    """

    place: str
    finding: str

    def __new__(cls, place: str, finding: str) -> Located:
        """Join place and finding."""
        text = super().__new__(cls, f"{place}: {finding}")
        text.place, text.finding = place, finding
        return text

    def __reduce__(self) -> tuple[type[Located], tuple[str, str]]:
        """Return what a copy is made from."""
        return Located, (self.place, self.finding)


def in_order(warnings: Iterable[str]) -> tuple[str, ...]:
    """Return warnings once each, those that change a number first, else in the order given.

    Warnings that were found alike at several places are one, which has the first place and the number of the others.

    Parameters
    ----------
    warnings : iterable of str
        Any, `Consequential` and `Located` among them.
    """
    once = dict.fromkeys(sorted(warnings, key=lambda w: not isinstance(w, Consequential)))
    places = Counter(w.finding for w in once if isinstance(w, Located))
    kinds = {w.finding if isinstance(w, Located) else w: w for w in reversed(once)}
    first = [w for w in once if kinds[w.finding if isinstance(w, Located) else w] is w]
    return tuple(_counted(w, places[w.finding]) if isinstance(w, Located) else w for w in first)


def _counted(first: Located, places: int) -> str:
    """Return a warning with the number of places at which the same was found."""
    if places == 1:
        return first
    others = "1 other place" if places == 2 else f"{places - 1} other places"
    return f"{first.place} and {others}: {first.finding}"


def prefixed(prefix: str, warning: str) -> str:
    """Return a warning behind a prefix, of the same kind as it was."""
    if isinstance(warning, Located):
        return Located(f"{prefix}{warning.place}", warning.finding)
    text = f"{prefix}{warning}"
    return Consequential(text) if isinstance(warning, Consequential) else text
