"""Whether records of numbers keep to their lines: an exchange of two lines leaves every count as it was."""

from __future__ import annotations

from collections.abc import Collection

from acquisition.errors import InputError
from acquisition.uff.text.numbers import numbers_of


def check_record_lines(text: bytes, *, columns: int, first: Collection[int]) -> None:
    """Check that all records end their lines at the same places.

    Parameters
    ----------
    text : bytes
        Records of numbers, and nothing else.
    columns : int
        Numbers of a record [-].
    first : collection of int
        How many of them its first line may hold [-].

    Raises
    ------
    InputError
        If one breaks elsewhere.
    """
    lines = [line for line in text.split(b"\n") if line.strip()]
    counts = [len(line.split()) for line in lines]
    if sum(counts) != len(numbers_of(text)):  # numbers touch
        counts = [len(numbers_of(line)) for line in lines]
    usual: list[int] = []
    record: list[int] = []
    for line, count in zip(lines, counts, strict=True):
        record.append(count)
        held, due = sum(record), usual[: len(record)]
        if held > columns or (due and record != due) or record[0] not in first:
            raise InputError(
                f"its line {line.strip()[:80].decode('latin-1')!r} is not where a record has it: a line is lost, "
                "moved or broken"
            )
        if held == columns:
            usual, record = record, []
