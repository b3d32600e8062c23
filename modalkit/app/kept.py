"""Results that need not be computed again."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from contextlib import AbstractContextManager, nullcontext
from typing import Generic, TypeVar

Value = TypeVar("Value")


class Kept(Generic[Value]):
    """The results of the last few keys.

    Parameters
    ----------
    size : int
        How many are kept.
    step : function
        Returns a context in which one of them is built.
    """

    def __init__(self, size: int, step: Callable[[], AbstractContextManager[None]] = nullcontext) -> None:
        """Begin with none."""
        self._size, self._step = size, step
        self._found: dict[Hashable, Value] = {}

    def __contains__(self, key: Hashable) -> bool:
        """Return whether something is kept under a key."""
        return key in self._found

    def get(self, key: Hashable, build: Callable[[], Value]) -> Value:
        """Return what is kept under a key, built if it is not; the key used last stays longest."""
        if key in self._found:
            value = self._found.pop(key)
        else:
            with self._step():
                value = build()
        self._found[key] = value
        if len(self._found) > self._size:
            self._found.pop(next(iter(self._found)))
        return value
