"""Progress of long work: its stages, and how much of each is done."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

Item = TypeVar("Item")


@dataclass(frozen=True)
class SingleCause:
    """A single cause as far as it is compared, before the causes together are.

    Parameters
    ----------
    name : str
        Name of the effect; "" for no cause.
    log_evidence : float
        Logarithm of its evidence over that of no cause, by the forms compared so far; its samples are not evaluated
        yet, and its prior is not in it [-].
    p_value : float
        How well its best form fits [-].
    """

    name: str
    log_evidence: float
    p_value: float


def _unheeded(_: object) -> None:
    """Do nothing."""


@dataclass(frozen=True, eq=False)
class Steps:
    """Where the steps of long work are announced.

    Parameters
    ----------
    begin : function
        Called with the name of every stage as it begins.
    done : function
        Called with how much of a stage is done, from 0 to 1.
    found : function
        Called with every single cause when a form of it has been compared.
    """

    begin: Callable[[str], None] = _unheeded
    done: Callable[[float], None] = _unheeded
    found: Callable[[SingleCause], None] = _unheeded

    @classmethod
    def to(
        cls,
        begin: Callable[[str], None] | None,
        done: Callable[[float], None] | None,
        found: Callable[[SingleCause], None] | None = None,
    ) -> Steps:
        """Return the steps that are announced to functions; None is for those that nobody wants to know of."""
        return cls(begin or _unheeded, done or _unheeded, found or _unheeded)

    def each(self, items: Sequence[Item], costs: Iterable[float] | None = None) -> Iterator[Item]:
        """Yield items, and announce before each how much of all is done.

        Parameters
        ----------
        items : sequence
            What is worked on, one after the other.
        costs : iterable of float, optional
            How long each takes, in any unit; left out, all alike.
        """
        shares = [1.0] * len(items) if costs is None else list(costs)
        whole, past = sum(shares), 0.0
        for item, share in zip(items, shares, strict=True):
            self.done(past / whole)
            yield item
            past += share


SILENT = Steps()
"""Steps that nobody wants to know of."""
