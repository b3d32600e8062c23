"""Files of OUTPUT2: the matrices that they hold, their records followed to the end of the file.

Every record of data stands behind a key: a record of one number that is the number of words to follow, or zero and
less at an end. In a column of a matrix the number of its first row comes in front of these words. A data block is a
name, a trailer of seven numbers (the second is the number of columns, the third that of rows, the fifth the type), a
second name, and the records of a table or the columns of a matrix. (MSC Nastran, *DMAP Programmer's Guide*, module
OUTPUT2.)
"""

from __future__ import annotations

from dataclasses import replace

from updating.models.imported.nastran.contents import Held, Run
from updating.models.imported.nastran.records import Matrix, Records, reals, size_of, whole_numbers

_DATE, _TRAILER = 3, 7
"""Words of the date that may begin a file, and of a trailer [-]."""


class _Blocks:
    """The records of a file with their keys."""

    def __init__(self, raw: bytes) -> None:
        self.records = Records(raw, (4, 8))
        self.word = self.records.first

    def numbers(self, content: memoryview, count: int) -> tuple[int, ...]:
        """Return the first whole numbers of a record."""
        return whole_numbers(self.records.order, self.word, content, count)

    def key(self) -> int:
        """Return the next key."""
        at, content = self.records.at, self.records.take()
        if len(content) != self.word:
            raise ValueError(f"the record at byte {at} has {len(content)} bytes and is no key")
        return self.numbers(content, 1)[0]

    def keys(self, count: int) -> None:
        """Pass so many keys."""
        for _ in range(count):
            self.key()

    def data(self, words: int) -> memoryview:
        """Return the next record, which has so many words."""
        at, content = self.records.at, self.records.take()
        if len(content) != words * self.word:
            raise ValueError(f"the record at byte {at} has {len(content)} bytes for {words} words")
        return content


def contents(raw: bytes) -> list[Matrix]:
    """Return the matrices of a file; tables are passed over.

    Raises
    ------
    ValueError
        If a record is not whole, or does not belong where it is.
    """
    blocks, found = _Blocks(raw), list[Matrix]()
    _pass_label(blocks)
    while blocks.records.left and (words := blocks.key()):
        name = bytes(blocks.data(words)).decode("latin-1").replace("\0", "").replace(" ", "")
        blocks.keys(1)
        trailer = blocks.numbers(blocks.data(blocks.key()), _TRAILER)
        blocks.keys(4)
        blocks.records.take()
        blocks.keys(2)
        if blocks.key() > 0:
            held = Held(name, trailer[2], trailer[1], trailer[4])
            held = replace(held, runs=tuple(_runs(held, blocks)))
            found.append((held, reals(blocks.records.order, size_of(held, blocks.word))))
        else:
            _pass_table(blocks)
    return found


def _pass_label(blocks: _Blocks) -> None:
    """Pass the date and the label that may begin a file."""
    if blocks.key() != _DATE:
        blocks.records.at = 0
        return
    blocks.data(_DATE)
    for _ in range(2):
        blocks.keys(1)
        blocks.records.take()
    blocks.keys(2)


def _runs(held: Held, blocks: _Blocks) -> list[Run]:
    """Return the entries of a matrix, all its columns checked."""
    column, runs, more = 0, list[Run](), 1
    size = size_of(held, blocks.word)
    while more > 0:
        column += 1
        end, words = 0, blocks.key()
        while words > 0:
            held.check_column(column, column - 1)
            content = blocks.data(1 + words)
            count, odd = divmod(len(content) - blocks.word, size)
            if odd:
                raise ValueError(f"{held.name}: column {column} has {words} words in numbers of {size} bytes")
            row = blocks.numbers(content, 1)[0]
            end = held.check_rows(row, count, end)
            runs.append(Run(column, row, count, content[blocks.word :]))
            words = blocks.key()
        blocks.keys(1)
        more = blocks.key()
    if column != held.columns:
        raise ValueError(f"{held.name}: {column} columns of {held.columns}")
    if blocks.records.left:
        blocks.keys(1)
    return runs


def _pass_table(blocks: _Blocks) -> None:
    while blocks.records.left and (words := blocks.key()):
        while words > 0:
            blocks.data(words)
            words = blocks.key()
        blocks.keys(2)
