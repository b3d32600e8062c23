"""The document of real structures, ``modalkit.real/1``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, NotRequired, TypedDict


class CountsEntry(TypedDict):
    """Answers by grade."""

    right: Annotated[int, "right ones [-]"]
    partly: Annotated[int, "partly right ones [-]"]
    wrong: Annotated[int, "wrong ones [-]"]


class FactEntry(TypedDict):
    """A size that is known."""

    parameter: Annotated[str, "`effect.parameter`"]
    known: Annotated[Sequence[float], "what it lies between [SI]"]
    said: Annotated[Sequence[float | None], "stated value and 95 % interval; null for none [SI]"]
    covered: Annotated[bool, "whether the interval meets what is known"]


class CaseEntry(TypedDict):
    """One structure."""

    name: Annotated[str, "of the case"]
    data: Annotated[str, "measured, published numbers, or synthetic"]
    withheld: Annotated[str, "what the diagnosis is not given"]
    known: Annotated[str, "what is truly known"]
    source: Annotated[str, "from where"]
    accepted: Annotated[Sequence[Sequence[str]], "sets of effects that are right"]
    equivalent: Annotated[Sequence[Sequence[str]], "sets that do the same to these data"]
    why_equivalent: Annotated[str, "why they do"]
    without: Annotated[Sequence[str], "effects taken out of the library"]
    missing: Annotated[str | None, "data that are not there; null for a case that ran"]
    seconds: Annotated[float, "time of the diagnosis [s]"]
    row: Annotated[Mapping[str, str], "the case's row of the printed table, by its headings"]
    grade: NotRequired[Annotated[str, "right, partly or wrong; absent for a case that did not run"]]
    reason: NotRequired[Annotated[str, "why; absent likewise"]]
    facts: NotRequired[Annotated[Sequence[FactEntry], "known sizes beside the stated; absent likewise"]]
    diagnosis: NotRequired[
        Annotated[Mapping[str, Any], "the parts of `modalkit.diagnosis/1` that are judged; absent likewise"]
    ]


class RealDocument(TypedDict):
    """Written by `modalkit blind --real --json`."""

    schema: Annotated[Literal["modalkit.real/1"], "kind and version of the document"]
    rules: Annotated[Sequence[str], "how answers are judged"]
    counts: Annotated[CountsEntry, "answers by grade"]
    cases: Annotated[Sequence[CaseEntry], "case by case"]
