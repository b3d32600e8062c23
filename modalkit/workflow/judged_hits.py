"""Hits of a test before and after anybody decided on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from acquisition import (
    Dof,
    HammerTest,
    HitVerdict,
    InputError,
    UffContent,
    decide,
    holds_several_hits,
    judge_hits,
    pulses_alone,
    split_hits,
    state_window,
)
from acquisition.display import Displayed
from modalkit.workflow.hit_warnings import on_window
from modalkit.workflow.processing_options import ProcessingOptions
from modalkit.workflow.references import with_references

if TYPE_CHECKING:
    import pandas as pd

SAME_DECAY = 1e-3  # relative difference of decays that are the same


@dataclass(frozen=True, eq=False)
class Judged(Displayed):
    """A test with what is thought of its hits.

    Parameters
    ----------
    test : HammerTest
        Records, one a hit.
    verdicts : tuple of HitVerdict
        On each hit, the user's decisions included.
    """

    test: HammerTest
    verdicts: tuple[HitVerdict, ...]

    def _headline(self) -> str:
        return f"{self.test._headline()}; {sum(not v.used for v in self.verdicts)} left out"

    def _frame(self) -> pd.DataFrame:
        return self.test.table()


@dataclass(frozen=True, eq=False)
class Proposals:
    """Hits as they are before anybody decided on them; they do not depend on decisions or on the estimator.

    Parameters
    ----------
    tests : tuple of HammerTest
        Records, one a hit, with the window stated and forces without the noise beside their pulses.
    verdicts : tuple of tuple of HitVerdict
        What is proposed of the hits of each test, numbered through.
    warnings : tuple of str
        What was found.
    """

    tests: tuple[HammerTest, ...]
    verdicts: tuple[tuple[HitVerdict, ...], ...]
    warnings: tuple[str, ...]


def proposals_of(content: UffContent, processing: ProcessingOptions) -> Proposals:
    """Return what is proposed of the hits of files, as :func:`from_content` takes it.

    Parameters
    ----------
    content : UffContent
        What the files hold.
    processing : ProcessingOptions
        How records are treated; decisions and estimator do not matter.
    """
    chosen = with_references(content, processing.references) if processing.references else content
    return proposed(chosen.tests, processing)


def proposed(tests: Sequence[HammerTest], processing: ProcessingOptions) -> Proposals:
    """Split long records, state the window, judge the hits, and take the noise beside pulses out."""
    warnings: list[str] = []
    split = []
    for test in tests:
        one = test
        if holds_several_hits(one):
            one, notes = split_hits(replace(one, decay=one.decay or processing.decay))
            warnings += notes
        split.append(stated(one, processing, warnings))
    verdicts = numbered([judge_hits(test) for test in split])
    cleared = [pulses_alone(test) for test in split]
    warnings += [text for _, notes in cleared for text in notes]
    return Proposals(tuple(test for test, _ in cleared), tuple(verdicts), tuple(warnings))


def decided(proposals: Proposals, processing: ProcessingOptions, warnings: list[str]) -> tuple[Judged, ...]:
    """Return tests with what the user decided on their hits."""
    warnings += proposals.warnings
    every = tuple(v for verdicts in proposals.verdicts for v in verdicts)
    decided = iter(decide(every, use=processing.use, leave=processing.leave) if every else ())
    return tuple(
        Judged(test, tuple(next(decided) for _ in verdicts))
        for test, verdicts in zip(proposals.tests, proposals.verdicts, strict=True)
    )


def stated(test: HammerTest, processing: ProcessingOptions, warnings: list[str]) -> HammerTest:
    """Return a test with the window stated that was applied; warn of one that is not stated.

    Parameters
    ----------
    test : HammerTest
        Records, one a hit.
    processing : ProcessingOptions
        What the user states about the window.
    warnings : list of str
        What was found is added to it.

    Raises
    ------
    InputError
        If the file states another window.
    """
    if processing.decay and test.decay:
        check_decay(test.source, test.decay, processing.decay)
    elif processing.decay:
        test, notes = state_window(test, decay=processing.decay, on=processing.window_on)
        warnings += notes
    else:
        warnings += on_window(test)
    return test


def check_decay(source: str, stated: float, given: float) -> None:
    """Raise an InputError where a file and what is given differ in the decay of the exponential window [1/s]."""
    if abs(stated - given) > SAME_DECAY * stated:
        raise InputError(
            f"{source}: the file states an exponential window of {stated:g} 1/s, but {given:g} 1/s is "
            "given; leave one out or correct the other"
        )


def numbered(tests: Sequence[tuple[HitVerdict, ...]]) -> list[tuple[HitVerdict, ...]]:
    """Return the verdicts on the hits of several tests, the hits at each point numbered through.

    Parameters
    ----------
    tests : sequence of tuple of HitVerdict
        Verdicts of `judge_hits` on each test.
    """
    seen: dict[Dof, int] = {}
    answer = []
    for verdicts in tests:
        before = dict(seen)
        answer.append(tuple(replace(v, hit=before.get(v.point, 0) + v.hit) for v in verdicts))
        for v in verdicts:
            seen[v.point] = seen.get(v.point, 0) + 1
    return answer
