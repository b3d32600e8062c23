"""Rules for file names: where the hammer or a transducer was in a file, and in which unit it was recorded."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase, translate
from functools import cache
from pathlib import Path

from acquisition.errors import InputError

NODE, DIRECTION = "{node}", "{direction}"
_WORDS = {
    NODE: ("NODEPLACE", r"(?<!\d)(?P<node>\d{1,18})(?!\d)"),
    DIRECTION: ("DIRECTIONPLACE", r"(?P<direction>[+-]?[rR]?[xyzXYZ])"),
}
"""What stands for a node and a direction in a pattern; all digits that stand together are the node."""


@dataclass(frozen=True)
class FileRule:
    """What differs in some of the files: the point of the hammer that roves, or a unit.

    Parameters
    ----------
    match : str
        Pattern of file names, as ``point_07_*.csv``; ``{node}`` and ``{direction}`` stand for what the name states,
        ``P{node}_*.csv``. With folders, ``P{node}/*.csv``, the folders count too.
    node : int or None
        Node in these files; None for that in the name, or that of the column.
    direction : str
        Direction in these files; "" for that in the name, or that of the column.
    column : str or int
        Heading or number of the column; "" for the force. Of FRFs either column of the two, whose response it
        places.
    unit : str
        Unit in these files; "" for that of the column.
    scale : float or None
        What the numbers in these files are multiplied by first [-]; None for the scale of the column.
    """

    match: str
    node: int | None = None
    direction: str = ""
    column: str | int = ""
    unit: str = ""
    scale: float | None = None

    @property
    def named(self) -> bool:
        """Whether the node is in the name of each file."""
        return NODE in self.match

    def of(self, path: Path) -> FileRule | None:
        """Return the rule with the point that a file's name states; None if it is not for this file."""
        name = "/".join(path.parts[-1 - self.match.count("/") :])
        if NODE not in self.match and DIRECTION not in self.match:
            return self if fnmatchcase(name, self.match) else None
        found = _pattern(self.match).match(name)
        if found is None:
            return None
        stated = found.groupdict()
        node = int(stated["node"]) if stated.get("node") else self.node
        return replace(self, node=node, direction=stated.get("direction") or self.direction)


@cache
def _pattern(match: str) -> re.Pattern[str]:
    for word, (place, _) in _WORDS.items():
        match = match.replace(word, place)
    pattern = translate(match)
    for place, meaning in _WORDS.values():
        pattern = pattern.replace(place, meaning)
    return re.compile(pattern)


def check_rule(rule: FileRule, where: str) -> None:
    """Check that a rule states something, each thing once.

    Raises
    ------
    InputError
        If it does not.
    """
    for word, given in ((NODE, rule.node is not None), (DIRECTION, bool(rule.direction))):
        count = rule.match.count(word)
        if count > 1 or (count and given):
            raise InputError(
                f"{where}: {word} may occur once in match, and not together with the key of that name; correct the rule"
            )
    placed = rule.named or rule.node is not None or rule.direction or DIRECTION in rule.match
    if not (placed or rule.unit or rule.scale is not None):
        raise InputError(
            f"{where}: states nothing about these files; add node = ..., unit or scale, or write {{node}} into match, "
            'as "P{node}_*.csv"'
        )


def rules_for(rules: Sequence[FileRule], path: Path) -> list[FileRule]:
    """Return the rules that are for a file, with the points that its name states; the first counts most."""
    return [found for rule in rules if (found := rule.of(path)) is not None]


def check_rules(rules: Sequence[FileRule], files: Sequence[Path], source: str) -> None:
    """Refuse files that no rule places while a rule is idle, or takes nodes from names: one of them is misspelt.

    Raises
    ------
    InputError
        If there are such.
    """
    lost = [f for f in files if not rules_for(rules, f)]
    idle = [rule.match for rule in rules if not any(rule.of(f) for f in files)]
    named = [rule.match for rule in rules if rule.named]
    if lost and (idle or named):
        what = (
            f"the rule {idle[0]!r} matches no file"
            if idle
            else f"{named[0]!r} takes the nodes from the names"
        )
        raise InputError(
            f"{lost[0]}: no [[file]] rule of {source} matches it, and {what}, so the hit point would be a guess; "
            "correct the rule or the name"
        )
