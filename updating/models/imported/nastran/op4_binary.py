"""Binary files of OUTPUT4: the matrices that they hold, their records followed to the end of the file.

A record of four whole numbers and a name begins a matrix. A record follows for each column that is not empty: column,
first row, number of words, and the words. With a first row of zero the words are strings, each behind its length and
its row. A column behind the last one ends the matrix. (MSC Nastran, *DMAP Programmer's Guide*, module OUTPUT4.)
"""

from __future__ import annotations

from dataclasses import replace

from updating.models.imported.nastran.contents import WIDEST, Held, Run
from updating.models.imported.nastran.records import Matrix, Records, reals, size_of, whole_numbers

_HEADERS = (24, 48)
"""Bytes of the record that begins a matrix, in words of 4 or 8 bytes [-]."""


def contents(raw: bytes) -> list[Matrix]:
    """Return the matrices of a file.

    Raises
    ------
    ValueError
        If a record is not whole, or does not belong where it is.
    """
    records = Records(raw, _HEADERS)
    word, found = (4 if records.first == _HEADERS[0] else 8), list[Matrix]()
    while records.left:
        header = records.take()
        if len(header) != records.first:
            raise ValueError(f"a record of {len(header)} bytes where a matrix should begin")
        columns, rows, _, kind = whole_numbers(records.order, word, header, 4)
        name = bytes(header[4 * word :]).decode("latin-1").replace("\0", "").replace(" ", "")
        held = Held(name, abs(rows), columns, kind)
        held = replace(held, runs=tuple(_runs(held, records, word, wide=rows < 0 or rows >= WIDEST)))
        found.append((held, reals(records.order, size_of(held, word))))
    return found


def _runs(held: Held, records: Records, word: int, *, wide: bool) -> list[Run]:
    """Return the entries of a matrix, all its columns checked; none of a complex one."""
    before, runs, strings = 0, list[Run](), None
    while True:
        record = records.take()
        column, row, words = whole_numbers(records.order, word, record, 3)
        if not held.check_column(column, before):
            return runs
        if len(record) != (3 + words) * word or (strings is not None and strings != (row == 0)):
            raise ValueError(f"{held.name}: column {column} has {len(record)} bytes for {words} words")
        before, strings = column, row == 0
        if held.real:
            content = record[3 * word :]
            stated = [(row, content)] if row else _strings(held, content, (records.order, word), wide=wide)
            runs += _of_column(held, column, stated, size_of(held, word))


def _of_column(held: Held, column: int, stated: list[tuple[int, memoryview]], size: int) -> list[Run]:
    """Return the runs of a column from first rows and bytes."""
    end, runs = 0, list[Run]()
    for row, content in stated:
        count, odd = divmod(len(content), size)
        if odd:
            raise ValueError(f"{held.name}: column {column} has {len(content)} bytes in numbers of {size}")
        end = held.check_rows(row, count, end)
        runs.append(Run(column, row, count, content))
    return runs


def _strings(
    held: Held, content: memoryview, form: tuple[str, int], *, wide: bool
) -> list[tuple[int, memoryview]]:
    """Return first rows and bytes of the strings of a column."""
    order, word = form
    words = whole_numbers(order, word, content, len(content) // word)
    at, found = 0, list[tuple[int, memoryview]]()
    while at < len(words):
        if wide and at + 1 < len(words):
            size, row = words[at] - 1, words[at + 1]
        else:
            size, row = (words[at] >> 16) - 1, words[at] & 0xFFFF
        first = at + (2 if wide else 1)
        at = first + size
        if size < 1 or at > len(words):
            raise ValueError(f"{held.name}: a string of {size} words in a column of {len(words)}")
        found.append((row, content[first * word : at * word]))
    return found
