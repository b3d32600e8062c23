"""Node sets: names that the modeller gave to groups of nodes."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from acquisition.arrays import IntArray
from updating.models.imported.deck import Deck

NodeSets = Mapping[str, IntArray]
"""Numbers of the nodes of every set, in rising order, by the set's name."""

_BETWEEN = re.compile(r"[\s;|]+")
"""What stands between two names in a node table."""


def sets_of_table(node: IntArray, names: Sequence[str]) -> NodeSets:
    """Return the node sets of a table: per line the node (n,) and the names of its sets, spaces between them."""
    members: dict[str, set[int]] = {}
    for number, named in zip(node.tolist(), names, strict=True):
        for name in filter(None, _BETWEEN.split(named.strip())):
            members.setdefault(name, set()).add(number)
    return _frozen(members)


def sets_of_deck(deck: Deck) -> NodeSets:
    """Return the node sets of a deck, those that hold every node, or none, left out."""
    members = {
        name: {node for numbers in ranges for node in _known(numbers, deck)}
        for name, ranges in deck.sets.items()
    }
    return _frozen({name: nodes for name, nodes in members.items() if 0 < len(nodes) < len(deck.nodes)})


def _known(numbers: range, deck: Deck) -> Sequence[int]:
    """Return the nodes among some numbers, in as many steps as there are numbers or nodes, whichever are fewer."""
    if len(numbers) < len(deck.nodes):
        return [n for n in numbers if n in deck.nodes]
    return [n for n in deck.nodes if n in numbers]


def _frozen(members: Mapping[str, set[int]]) -> NodeSets:
    return MappingProxyType(
        {name: np.array(sorted(nodes), dtype=np.int64) for name, nodes in members.items()}
    )
