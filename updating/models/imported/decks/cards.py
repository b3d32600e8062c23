"""The cards of an input deck: its model, in one piece, without comments, included files or steps."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from acquisition.errors import StudyError
from updating.models.imported.include import deck_lines, is_include

UNFOLLOWED = {
    "*NODAL THICKNESS": "give the thickness on the *SHELL SECTION",
    "*SUBSTRUCTURE GENERATE": 'take its matrices with type = "matrices"',
    "*CYCLIC SYMMETRY MODEL": "model the whole circle",
    "*PART": "write the deck flat, without parts and instances",
    "*INSTANCE": "write the deck flat, without parts and instances",
}
"""Cards of a model whose matrices CalculiX does not store, or whose numbers stand elsewhere; and what to do."""


@dataclass(frozen=True)
class Card:
    """A card with its data lines.

    Parameters
    ----------
    name : str
        ``*ELEMENT``, in capitals.
    options : mapping of str to str
        In capitals; empty where an option has no value.
    head : str
        The line of the card as it is written.
    lines : tuple of str
        Its data lines.
    where : str
        File and line, for messages.
    """

    name: str
    options: Mapping[str, str]
    head: str
    lines: tuple[str, ...] = ()
    where: str = ""

    def rows(self) -> list[list[str]]:
        """Return the words of every data line, empty ones at its end left out."""
        return [[word.strip() for word in line.rstrip(", ").split(",")] for line in self.lines]

    def with_number(self, line: int, column: int, value: float) -> Card:
        """Return the card with another number in a line and column, both from 0."""
        words = self.lines[line].split(",")
        words[column] = number_word(value)
        return replace(self, lines=(*self.lines[:line], ",".join(words), *self.lines[line + 1 :]))

    def number(self, line: int, column: int) -> float:
        """Return the number in a line and column, both from 0.

        Raises
        ------
        StudyError
            If there is none.
        """
        try:
            return float(self.rows()[line][column].upper().replace("D", "E"))
        except (IndexError, ValueError) as error:
            raise StudyError(
                f"{self.where}: {self.head[:60]}: no number {column + 1} in its line {line + 1}"
            ) from error


Cards = tuple[Card, ...]


def number_word(value: float) -> str:
    """Return a number in the 20 characters that CalculiX reads of one."""
    return f"{value:.13e}"


def card(head: str, *lines: str, where: str = "") -> Card:
    """Return a card from its lines."""
    name, *options = (" ".join(part.split()).upper() for part in head.split(","))
    pairs = (option.partition("=") for option in options if option)
    return Card(
        name, MappingProxyType({key.strip(): value.strip() for key, _, value in pairs}), head, lines, where
    )


def text_of(cards: Iterable[Card]) -> str:
    """Return the text of a deck."""
    return "\n".join(line for one in cards for line in (one.head, *one.lines)) + "\n"


def read_cards(path: Path) -> Cards:
    """Read the model of a deck: the cards before and between its steps, and the supports of its steps.

    Raises
    ------
    StudyError
        If a file cannot be read, the first line is not a card, or a card is not followed.
    """
    found, head, lines, where = list[Card](), "", list[str](), ""
    for line, here in deck_lines(path):
        if not line.startswith("*"):
            if not head:
                raise StudyError(
                    f"{here}: {line[:40]!r} comes before the first card; is this a CalculiX deck?"
                )
            lines.append(line)
            continue
        if is_include(line):
            continue  # its text stands here: the card before it goes on
        if head:
            found.append(card(head, *lines, where=where))
        head, lines, where = line, [], here
    if head:
        found.append(card(head, *lines, where=where))
    for one in found:
        if one.name in UNFOLLOWED:
            raise StudyError(f"{one.where}: {one.name} is not supported; {UNFOLLOWED[one.name]}")
    return tuple(_model(found))


def _model(cards: Iterable[Card]) -> Iterable[Card]:
    """Yield the cards of the model; a support in a step becomes one of the model."""
    in_step = False
    for one in cards:
        if one.name in ("*STEP", "*END STEP"):
            in_step = one.name == "*STEP"
        elif in_step and one.name == "*BOUNDARY" and "BASE MOTION" not in one.options:
            yield replace(one, head="*BOUNDARY", options=MappingProxyType({}))
        elif not in_step:
            yield one
