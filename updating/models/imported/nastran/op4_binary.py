"""Binary files of OUTPUT4: which matrices they hold, and whether their records are whole.

A record of four whole numbers and a name begins a matrix. A record follows for each column that is not empty: column,
first row, number of words, and the words. With a first row of zero the words are strings, each behind its length and
its row. A column behind the last one ends the matrix. (MSC Nastran, *DMAP Programmer's Guide*, module OUTPUT4.)
"""

from __future__ import annotations

from dataclasses import replace

from updating.models.imported.nastran.contents import WIDEST, Held
from updating.models.imported.nastran.records import Records, whole_numbers

_HEADERS = (24, 48)
"""Bytes of the record that begins a matrix, in words of 4 or 8 bytes [-]."""


def contents(raw: bytes) -> list[Held]:
    """Return the matrices of a file.

    Raises
    ------
    ValueError
        If a record is not whole, or does not belong where it is.
    """
    records = Records(raw, _HEADERS)
    word, found = (4 if records.first == _HEADERS[0] else 8), list[Held]()
    while records.left:
        header = records.take()
        if len(header) != records.first:
            raise ValueError(f"a record of {len(header)} bytes where a matrix should begin")
        columns, rows, _, kind = whole_numbers(records.order, word, header, 4)
        name = bytes(header[4 * word :]).decode("latin-1").replace("\0", "").replace(" ", "")
        held = Held(name, abs(rows), columns, kind)
        found.append(replace(held, entries=_entries(held, records, word, wide=rows < 0 or rows >= WIDEST)))
    return found


def _entries(held: Held, records: Records, word: int, *, wide: bool) -> int:
    """Return the number of entries of a matrix, all its columns checked [-]."""
    before, entries, strings = 0, 0, None
    per_value = 1 if held.type % 2 else 8 // word
    while True:
        record = records.take()
        column, row, words = whole_numbers(records.order, word, record, 3)
        if not held.check_column(column, before):
            return entries
        if len(record) != (3 + words) * word or (strings is not None and strings != (row == 0)):
            raise ValueError(f"{held.name}: column {column} has {len(record)} bytes for {words} words")
        before, strings = column, row == 0
        if not held.real:
            continue
        if row:
            count, odd = divmod(words, per_value)
            held.check_rows(row, count + odd, 0)
            entries += count
        else:
            numbers = whole_numbers(records.order, word, record, 3 + words)
            entries += _strings(held, numbers[3:], per_value, wide=wide)


def _strings(held: Held, words: tuple[int, ...], per_value: int, *, wide: bool) -> int:
    """Return the number of entries in the strings of a column [-]."""
    at, end, entries = 0, 0, 0
    while at < len(words):
        if wide and at + 1 < len(words):
            size, row = words[at] - 1, words[at + 1]
        else:
            size, row = (words[at] >> 16) - 1, words[at] & 0xFFFF
        at += (2 if wide else 1) + size
        end = held.check_rows(row, size // per_value, end)
        entries += size // per_value
    if at != len(words):
        raise ValueError(f"{held.name}: strings of {at} words in a column of {len(words)}")
    return entries
