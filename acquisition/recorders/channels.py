"""Named channels of one record, whatever kind of file holds them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from acquisition.arrays import FloatArray
from acquisition.errors import InputError

SAME_RATE = 1e-4
"""Rates that differ by less than this part are one: programs write them with five digits or more [-]."""

LISTED = 12
"""So many names of channels are listed in a message."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Channels(ABC):
    """Channels side by side: one hit, one long record, or one table of FRFs.

    Parameters
    ----------
    path : Path
        The file.
    names : tuple of str
        Names of the channels, as a layout gives them; empty where there are none.
    rates : mapping of int to float
        Sampling rates that the file states, by channel [Hz].
    units : mapping of int to str
        Units that the file states, by channel.
    counts : mapping of int to int
        Numbers of samples that the file states, by channel.
    """

    path: Path
    names: tuple[str, ...] = ()
    rates: Mapping[int, float] = field(default_factory=dict)
    units: Mapping[int, str] = field(default_factory=dict)
    counts: Mapping[int, int] = field(default_factory=dict)

    @property
    @abstractmethod
    def width(self) -> int:
        """How many channels there are."""

    @property
    @abstractmethod
    def where(self) -> str:
        """The file, and the place in it where there is one, for messages."""

    @property
    def where_names(self) -> str:
        """The place of the names, for messages."""
        return self.where

    def line(self, sample: int) -> str:
        """Return the file and the place of a sample in it, for messages."""
        return f"{self.where}, sample {sample}"

    @property
    def needs_scale(self) -> bool:
        """Whether the layout has to state what the numbers are multiplied by."""
        return False

    @abstractmethod
    def numbers(self, index: Sequence[int]) -> FloatArray:
        """Return channels as numbers, shape (n_samples, len(index)).

        Raises
        ------
        InputError
            If their lengths differ, or an entry is not a finite number.
        """

    def index_of(self, column: int | str | None, label: str) -> int:
        """Return the number of a channel given by number or name.

        Raises
        ------
        InputError
            If there is no such channel, or several.
        """
        if isinstance(column, int):
            if not 0 <= column < self.width:
                raise InputError(
                    f"{self.where}: there is no {label}; there are {self.width} columns, counted from 0"
                )
            return column
        places = [i for i, name in enumerate(self.names) if name == column]
        if len(places) != 1:
            found = "given twice" if places else "missing"
            known = [name for name in self.names if name]
            heads = ", ".join(map(repr, known[:LISTED])) + (", ..." if len(known) > LISTED else "")
            raise InputError(f"{self.where_names}: {label} is {found}; the headings are {heads or 'none'}")
        return places[0]

    def rate_of(self, index: Sequence[int]) -> float | None:
        """Return the sampling rate that the file states for channels [Hz], None where it states none.

        Raises
        ------
        InputError
            If it is not the same for all of them.
        """
        rates = {i: self.rates[i] for i in index if i in self.rates}
        if rates and max(rates.values()) - min(rates.values()) > SAME_RATE * max(rates.values()):
            slow, fast = min(rates, key=rates.__getitem__), max(rates, key=rates.__getitem__)
            raise InputError(
                f"{self.where}: channels sampled at different rates, {self.label(slow)} at {rates[slow]:g} Hz and "
                f"{self.label(fast)} at {rates[fast]:g} Hz; name channels of one rate in the layout"
            )
        return next(iter(rates.values()), None)

    def count_of(self, index: Sequence[int]) -> int | None:
        """Return how many samples the file states for channels, None where it states none.

        Raises
        ------
        InputError
            If it is not the same for all of them, or 0.
        """
        counts = {i: self.counts[i] for i in index if i in self.counts}
        self.of_one_length(counts)
        return next(iter(counts.values()), None)

    def of_one_length(self, counts: Mapping[int, int]) -> None:
        """Refuse channels without samples, or with different numbers of them.

        Raises
        ------
        InputError
            If there are such.
        """
        if counts and not min(counts.values()):
            empty = min(counts, key=counts.__getitem__)
            raise InputError(
                f"{self.where}: {self.label(empty)} has no samples, the channel was not recorded; leave it out of the "
                "layout"
            )
        if len(set(counts.values())) > 1:
            short, long = min(counts, key=counts.__getitem__), max(counts, key=counts.__getitem__)
            raise InputError(
                f"{self.where}: {self.label(short)} has {counts[short]} samples and {self.label(long)} "
                f"{counts[long]}; name channels of one length in the layout"
            )

    def label(self, index: int) -> str:
        """Return how messages call a channel."""
        named = index < len(self.names) and self.names[index]
        return f"column {self.names[index]!r}" if named else f"column {index}"
