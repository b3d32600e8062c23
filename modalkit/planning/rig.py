"""A beam under its test: the blind rig's own body stands for it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from acquisition.arrays import FloatArray, IntArray
from modalkit.blind.answer import Answer, read_answer
from modalkit.blind.diagnoser import diagnosers
from modalkit.planning.bench import Attempt
from modalkit.planning.cases import Case
from modalkit.planning.changes import Change, Gain, changes
from modalkit.planning.curves import Curve, solve_curve
from modalkit.planning.design import Design, columns, present, whitener
from modalkit.planning.effects import NOT_FORECAST, families
from modalkit.planning.family import Family
from modalkit.planning.known import KnownTest
from modalkit.planning.responses import Stations
from modalkit.planning.writing import write_case


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

    follows = True

    def right(self, case: Case) -> frozenset[str]:
        """Return the names that are right answers to a case."""
        return case.accepted(self.known_test.setup)

    @contextmanager
    def attempts(self, *, noise: float | None, workers: int) -> Iterator[Attempt]:
        """Give what makes trials: raw hits of the rig, and a process that is given these and the study alone."""
        own = self.known_test
        if noise is not None:
            own = replace(own, setup=replace(own.setup, noise=noise))

        with diagnosers(workers) as diagnose:

            def attempt(case: Case, change: Change | None, seed: list[int]) -> Answer:
                test = own if change is None else _followed(own, change)
                with tempfile.TemporaryDirectory(prefix="test-", ignore_cleanup_errors=True) as name:
                    return read_answer(diagnose(write_case(case, test, Path(name), seed=seed), ()))

            yield attempt


def _followed(known_test: KnownTest, change: Change) -> KnownTest:
    """Return a test with a change of it followed."""
    design = change.design
    setup = change.follow(known_test.setup)
    return replace(known_test, setup=setup, shapes=design.shapes, absolute=design.absolute)
