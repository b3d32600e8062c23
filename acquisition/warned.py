"""Warnings: which of them change a number, and in which order they are shown."""

from __future__ import annotations

from collections.abc import Iterable


class Consequential(str):
    """A warning of something that makes a number of the result another one; equal to any text of the same words."""

    __slots__ = ()


def in_order(warnings: Iterable[str]) -> tuple[str, ...]:
    """Return warnings once each, those that change a number first, else in the order given.

    Parameters
    ----------
    warnings : iterable of str
        Any, `Consequential` among them.
    """
    once = dict.fromkeys(sorted(warnings, key=lambda w: not isinstance(w, Consequential)))
    return tuple(once)


def prefixed(prefix: str, warning: str) -> str:
    """Return a warning behind a prefix, as consequential as it was."""
    text = f"{prefix}{warning}"
    return Consequential(text) if isinstance(warning, Consequential) else text
