"""What a forecast asks of a structure and its test: effects solved, data chosen, doubts, and what might be changed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Protocol

from acquisition.arrays import FloatArray, IntArray
from modalkit.planning.changes import Change, Gain
from modalkit.planning.curves import Curve
from modalkit.planning.design import Design
from modalkit.planning.family import Family

if TYPE_CHECKING:
    from modalkit.blind.answer import Answer
    from modalkit.planning.case import Case


class Bench(Protocol):
    """A structure and the test of it, as planned or as made."""

    @property
    def basis(self) -> str:
        """What solves the effects, in words."""

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Where each figure comes from."""

    @property
    def left_out(self) -> tuple[str, ...]:
        """What the study states and the forecast does not use."""

    @property
    def not_forecast(self) -> Mapping[str, str]:
        """Effects that are not asked about, and why."""

    @property
    def families(self) -> tuple[Family, ...]:
        """Effects that are asked about."""

    @property
    def design(self) -> Design:
        """The test as it is."""

    def solve(self, family: Family) -> Curve:
        """Return an effect at all its severities and places."""

    def columns(self, design: Design) -> IntArray:
        """Return which entries of a row of data a test has."""

    def whitener(self, design: Design) -> FloatArray:
        """Return W (n_data, n_data) with ``W @ data`` of unit covariance, all doubts counted in."""

    def changes(self, design: Design, worth: Gain) -> Iterator[Change]:
        """Give all changes of the test that are worth a look."""

    def follows(self, change: Change) -> bool:
        """Return whether a trial can follow a change of the test."""

    def right(self, case: Case) -> frozenset[str]:
        """Return the names that are right answers to a case."""

    def attempt(self, case: Case, change: Change | None, seed: list[int]) -> Answer:
        """Hide a case in the structure, test it by a seed as it is or with a change followed, and have it diagnosed."""
