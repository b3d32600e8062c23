"""Results that need not be computed again."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Kept(Generic[Value]):
    """The results of the last few keys.

    Parameters
    ----------
    size : int
        How many are kept.
    """

    def __init__(self, size: int) -> None:
        """Begin with none."""
        self._size = size
        self._found: dict[Hashable, Value] = {}

    def get(self, key: Hashable, build: Callable[[], Value]) -> Value:
        """Return what is kept under a key, built if it is not; the key used last stays longest."""
        value = self._found.pop(key) if key in self._found else build()
        self._found[key] = value
        if len(self._found) > self._size:
            self._found.pop(next(iter(self._found)))
        return value
