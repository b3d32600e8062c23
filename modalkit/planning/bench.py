"""What a forecast asks of a structure and its test: effects solved, data chosen, doubts, and what might be changed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

from acquisition.arrays import FloatArray, IntArray
from modalkit.planning.changes import Change, Gain, changes
from modalkit.planning.curves import Curve, solve_curve
from modalkit.planning.design import Design, columns, present, whitener
from modalkit.planning.effects import NOT_FORECAST, families
from modalkit.planning.family import Family
from modalkit.planning.known import KnownTest
from modalkit.planning.responses import Stations


class Bench(Protocol):
    """A structure and the test of it, as planned or as made."""

    @property
    def basis(self) -> str:
        """What solves the effects, in words."""

    @property
    def statement(self) -> tuple[str, ...]:
        """Where each figure comes from."""

    @property
    def left_out(self) -> tuple[str, ...]:
        """What the study says and the forecast does not know of."""

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


@dataclass(frozen=True, eq=False)
class RigBench:
    """A beam: the rig's own body stands for it.

    Parameters
    ----------
    known_test : KnownTest
        The test.
    """

    known_test: KnownTest
    basis = "the rig's own body"

    @property
    def statement(self) -> tuple[str, ...]:
        """Where each figure comes from."""
        return self.known_test.statement

    @property
    def left_out(self) -> tuple[str, ...]:
        """What the study says and the rig cannot do."""
        return self.known_test.left_out

    @property
    def not_forecast(self) -> Mapping[str, str]:
        """Effects that are not asked about, and why."""
        without = dict.fromkeys(self.known_test.without, "the study rules it out")
        return {**NOT_FORECAST, **without}

    @cached_property
    def stations(self) -> Stations:
        """Where it is or might be hit."""
        return Stations(self.known_test.setup)

    @cached_property
    def families(self) -> tuple[Family, ...]:
        """Effects that the rig can have and the data can show."""
        return families(self.known_test)

    @property
    def design(self) -> Design:
        """The test as it is."""
        return present(self.known_test)

    def solve(self, family: Family) -> Curve:
        """Return an effect at all its severities and places."""
        return solve_curve(family, self.stations.change)

    def columns(self, design: Design) -> IntArray:
        """Return which entries of a row of data a test has."""
        return columns(design, self.stations)

    def whitener(self, design: Design) -> FloatArray:
        """Return W with ``W @ data`` of unit covariance, all doubts counted in."""
        return whitener(design, self.known_test, self.stations)

    def changes(self, design: Design, worth: Gain) -> Iterator[Change]:
        """Give all changes of the test that are worth a look."""
        return changes(design, self.stations, worth)
