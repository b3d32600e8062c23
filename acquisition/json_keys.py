"""The keys of a JSON record: none twice, none misspelt, in all records of a list the same."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping, Sequence
from typing import Any

from acquisition.errors import InputError

# How like a known key an unknown one must be to count as misspelt, by difflib's ratio [-]: one wrong or missing
# letter of the shortest, "node", gives 0.75. Nearer to 1 lets more of them pass for keys of other programs.
_RESEMBLES = 0.75


def once(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """Return an object of JSON; for ``json.loads(object_pairs_hook=...)``.

    Raises
    ------
    InputError
        If a key is given twice, of which a parser keeps the last.
    """
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise InputError(f"the key {twice[:40]!r} is given twice in one record; take one out")
    return found


def check_keys(record: Mapping[str, Any], known: Collection[str], where: str) -> None:
    """Check that no key is a known one misspelt; others may stand there.

    Raises
    ------
    InputError
        If one is.
    """
    for key in record:
        missing = [name for name in known if name not in record]
        close = [] if key in known else difflib.get_close_matches(key[:40], missing, n=1, cutoff=_RESEMBLES)
        if close:
            raise InputError(f"{where}: unknown key {key[:40]!r}; {close[0]!r} is probably meant")


def check_same_keys(records: Sequence[Mapping[str, Any]], where: str) -> None:
    """Check that the records of a list have the same keys.

    Raises
    ------
    InputError
        If one has others than the first.
    """
    for number, record in enumerate(records[1:], start=2):
        odd = sorted(set(record) ^ set(records[0]))
        if odd:
            raise InputError(
                f"{where}: {odd[0][:40]!r} is missing from some records (1 and {number} differ); give all the same keys"
            )
