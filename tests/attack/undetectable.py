"""What no reader can see, by construction: a valid file of the format that says something else.

Nothing here knows our readers. Two contents are compared line by line and word by word: where one number stands for
another, or a line of a table without count or index is missing, any reader must take the file as it is.
"""

from __future__ import annotations

import io
import json
import re
import tomllib
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

import numpy as np

NUMBER = re.compile(rb"[+-]?(\d+(?:\.\d*)?|\.\d+)([eEdD][+-]?\d+|[+-]\d+)?")
DOF = re.compile(rb"^\s*\d+[+-]R?[XYZ]\s*$")
"""A heading that names a point and a direction, each as good as any other where none is given twice."""
SEPARATORS = re.compile(rb"[\s,;]+")
Judge = Callable[[bytes, bytes], bool]


def cells(original: bytes, mutant: bytes) -> bool:
    """Judge a table of commas: lines missing or moved, cells at a line's end or numbers missing, others for numbers."""
    first, second = (
        [line.split(b",") for line in lines_of(c) if not line.startswith(b"#")] for c in (original, mutant)
    )

    def alike(one: Sequence[bytes], two: Sequence[bytes]) -> bool:
        two = b",".join(two).split(b"#")[0].split(b",")
        return len(two) <= len(one) and all(
            a == b
            or (
                NUMBER.fullmatch(a.strip()) is not None
                and (NUMBER.fullmatch(b.strip() or b"0") or b.strip() == b"nan")
            )
            for a, b in zip(one, two, strict=False)
        )

    heads = [rows[0] if rows else [] for rows in (first, second)]
    heading, other = ([DOF.sub(b"1+Z", cell) for cell in head] for head in heads)
    return (
        heading == other
        and len(set(heads[1])) == len(set(heads[0]))
        and all(any(alike(a, b) for a in first) for b in second[1:])
    )


def number_for_number(one: bytes, two: bytes) -> bool:
    """Tell whether two lines hold the same words but for numbers in the places of numbers."""
    first, second = ([w for w in SEPARATORS.split(line) if w] for line in (one, two))
    return len(first) == len(second) and all(
        a == b or (NUMBER.fullmatch(a) is not None and NUMBER.fullmatch(b) is not None)
        for a, b in zip(first, second, strict=True)
    )


def lines_of(content: bytes) -> list[bytes]:
    """Return the lines that are not blank."""
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        content = content.decode("utf-16", errors="replace").encode()
    return [line for line in content.splitlines() if line.strip()]


def text(
    *,
    free: Callable[[int, bytes], bool] = lambda number, line: False,
    rows: bool = False,
    ends: bool = False,
    decimal: bytes = b".",
    outer: bool = False,
) -> Judge:
    """Return the judge of a text format.

    Parameters
    ----------
    free : callable
        Whether a line, by its number from 0 and content, holds words that mean nothing to a reader.
    rows : bool
        Whether lines may be missing, doubled or moved, for nothing counts or numbers them.
    decimal : bytes
        The decimal sign.
    outer : bool
        Whether the first and last lines of numbers may be missing, for nothing counts them.
    ends : bool
        Whether words at the end of a line may be missing, for they may be left out.
    """

    def alike(one: bytes, two: bytes) -> bool:
        one, two = _pointed([one, two], decimal)
        if ends:
            words = [w for w in SEPARATORS.split(two) if w]
            one = b" ".join([w for w in SEPARATORS.split(one) if w][: len(words)])
        return number_for_number(one, two)

    def judge(original: bytes, mutant: bytes) -> bool:
        first, second = lines_of(original), lines_of(mutant)
        if outer:
            rows_of = [
                line for line in second[1:] if any(NUMBER.fullmatch(w) for w in SEPARATORS.split(line))
            ]
            if rows_of and NUMBER.fullmatch(rows_of[0].replace(decimal, b".").strip()):
                del rows_of[0]  # a number alone above a table may be anything
            heading = second[:1] == first[:1] or free(0, first[0])
            return heading and any(
                all(
                    number_for_number(*pair)
                    for pair in zip(*(_pointed(x, decimal) for x in (first[skip:], rows_of)), strict=False)
                )
                for skip in range(1, len(first) - len(rows_of) + 1)
            )
        if rows:
            known = set(first)
            second = [line for line in second if line not in known and not free(-1, line)]
            return all(any(alike(a, b) for a in first) for b in second)
        return len(first) == len(second) and all(
            alike(a, b) or free(i, a) for i, (a, b) in enumerate(zip(first, second, strict=True)) if a != b
        )

    return judge


def _pointed(lines: list[bytes], decimal: bytes) -> list[bytes]:
    return [line.replace(decimal, b".") for line in lines]


THIRD_AXIS = 11
"""Line of a function's header for an axis that functions of one abscissa do not have."""


def universal(titles: Mapping[bytes, int], headers: Mapping[bytes, int]) -> Judge:
    """Return the judge of universal files: data sets missing, numbers for numbers, other words where words are free.

    Parameters
    ----------
    titles, headers : mapping of kind to int
        Lines of each kind of data set that are titles, and that begin with numbers and go on with names.
    """

    def sets(content: bytes) -> list[list[bytes]]:
        found: list[list[bytes]] = [[]]
        for line in content.splitlines():
            if line.strip() == b"-1":
                found.append([])
            else:
                found[-1].append(line.rstrip())
        return [one for one in found if any(one)]

    def alike(one: list[bytes], two: list[bytes]) -> bool:
        kind = one[0].split()[:1]
        first, last = (table.get(kind[0] if kind else b"", 0) for table in (titles, headers))
        if kind == [b"15"]:
            two = [line for line in two if line.strip()]
            return all(any(number_for_number(a, b) for a in one) for b in two)
        return (
            len(one) == len(two)
            and number_for_number(one[0], two[0])
            and all(
                number_for_number(_numbers_of(a), _numbers_of(b)) if i <= last else number_for_number(a, b)
                for i, (a, b) in enumerate(zip(one, two, strict=True))
                if i > first and not (i == THIRD_AXIS and kind[:1] in ([b"58"], [b"58b"]))
            )
        )

    def judge(original: bytes, mutant: bytes) -> bool:
        whole = sets(original)
        return all(any(alike(a, b) for a in whole) for b in sets(mutant))

    return judge


def _numbers_of(line: bytes) -> bytes:
    return b" ".join(w for w in line.split() if NUMBER.fullmatch(w))


_EXPONENT = re.compile(rb"(?<![\w.+-])[+-]?(\d+\.?\d*|\.\d+)[eEdD][+-]?\d+(?![\w.+-])")


def without_exponents(content: bytes) -> bytes:
    """Return a text of free columns with every number that has an exponent written without one, to the last bit."""

    def plain(found: re.Match[bytes]) -> bytes:
        number = float(found[0].upper().replace(b"D", b"E"))
        return found[0] if not np.isfinite(number) else np.format_float_positional(number).encode()

    return content if content[:2] == b"\x1f\x8b" else _EXPONENT.sub(plain, content)


def payload(spans: Sequence[tuple[int, int]], size: int, otherwise: Judge) -> Judge:
    """Return the judge of a format with numbers in binary at spans of a file of a size, and text elsewhere."""

    def judge(original: bytes, mutant: bytes) -> bool:
        if len(original) == len(mutant):
            changed = np.flatnonzero(np.frombuffer(original, "u1") != np.frombuffer(mutant, "u1"))
            shifts = 0, len(original) - size  # where another damage moved them
            if any(all(any(a <= at - by < b for a, b in spans) for at in changed.tolist()) for by in shifts):
                return True
        return otherwise(_without(original, spans, original), _without(mutant, spans, original))

    return judge


def _without(content: bytes, spans: Sequence[tuple[int, int]], original: bytes) -> bytes:
    """Return a content without the original's binary spans that stand in it unchanged; others fit nothing."""
    for a, b in spans:
        place = content.find(original[a:b])
        if place >= 0:
            content = content[:place] + content[place + b - a :]
    return content


def _keys(document: Any) -> Any:
    """Return a table without the numbers that are keys: one number is as good as another."""
    if isinstance(document, dict) and document and all(str(k).isdigit() for k in document):
        return list(document.values())
    return document


def _leaves(one: Any, two: Any, *, fewer: bool) -> bool:
    """Tell whether two documents have the same structure, but for numbers and words in their places."""
    one, two = _keys(one), _keys(two)
    if fewer and isinstance(one, list) and two == {}:
        return True
    if isinstance(one, dict) and isinstance(two, dict):
        return (set(two) <= set(one) if fewer else set(one) == set(two)) and all(
            _leaves(one[k], two[k], fewer=fewer) for k in two
        )
    if isinstance(one, list) and isinstance(two, list):
        if fewer and all(isinstance(part, dict) for part in one):
            one = [{k: v for table in one for k, v in table.items()}] * len(one)
        same = len(two) <= len(one) if fewer else len(one) == len(two)
        return same and all(_leaves(a, b, fewer=fewer) for a, b in zip(one, two, strict=False))
    numbers = (int, float)
    if isinstance(one, bool) or isinstance(two, bool):
        return isinstance(one, bool) and isinstance(two, bool)
    return (isinstance(one, numbers) and isinstance(two, numbers)) or type(one) is type(two)


def sealed(original: bytes, mutant: bytes) -> bool:
    """Judge the store of a blind run: what is beside the sealed statements, the diagnoses, may be another."""
    try:
        one, two = (
            [json.loads(line) for line in c.split(b"\n")[:-1] if line.strip()] for c in (original, mutant)
        )
        for line in (*one, *two):
            line["plan"] = None
            if "outcome" in line:
                line["outcome"]["document"] = None
    except (ValueError, TypeError, KeyError, RecursionError):
        return False
    return all(any(_leaves(a, b, fewer=False) for a in one) for b in two)


def toml(original: bytes, mutant: bytes) -> bool:
    """Judge TOML: other numbers and words in the places of numbers and words; a key that may be left out is."""
    try:
        one, two = (tomllib.loads(c.decode("utf-8-sig")) for c in (original, mutant))
    except (ValueError, RecursionError):
        return False
    return _leaves(one, two, fewer=True)


def json_lines(original: bytes, mutant: bytes) -> bool:
    """Judge one JSON document a line: the same documents, some missing or moved, but for numbers and words.

    A last line without its end is what a kill leaves: it is as good as none.
    """
    try:
        one, two = (
            [json.loads(line) for line in c.split(b"\n")[:-1] if line.strip()] for c in (original, mutant)
        )
    except (ValueError, RecursionError):
        return False
    return all(any(_leaves(a, b, fewer=False) for a in one) for b in two)


def json_document(optional: Collection[str], uncounted: str) -> Judge:
    """Return the judge of a JSON document: other numbers and words in their places, keys missing that may be.

    Of the list of the key ``uncounted``, whose entries nothing counts or numbers, entries may be missing too.
    """

    def completed(one: Any, two: Any) -> Any:
        if isinstance(one, dict) and isinstance(two, dict):
            missing = {k: v for k, v in one.items() if k in optional and k not in two}
            return {k: completed(one.get(k), v) for k, v in two.items()} | missing
        if isinstance(one, list) and isinstance(two, list):
            return [completed(a, b) for a, b in zip(one, two, strict=False)] + two[len(one) :]
        return one if two is None else two

    def judge(original: bytes, mutant: bytes) -> bool:
        try:
            one, two = (json.loads(c) for c in (original, mutant))
        except (ValueError, RecursionError):
            return False
        if isinstance(one, dict) and isinstance(two, dict) and isinstance(two.get(uncounted), list):
            one = {**one, uncounted: one[uncounted][: len(two[uncounted])]}
        return _leaves(one, completed(one, two), fewer=False)

    return judge


def archive(original: bytes, mutant: bytes) -> bool:
    """Judge an ``.npz`` or ``.npy``: arrays of the same names, shapes and kinds with other finite values in range."""
    try:
        one, two = _arrays(original), _arrays(mutant)
    except Exception:  # noqa: BLE001 - whatever numpy says of it, it is no archive
        return False
    if one.keys() != two.keys() or any(
        one[k].shape != two[k].shape or two[k].dtype.kind not in "fiu" + one[k].dtype.kind for k in one
    ):
        return False
    changed = [k for k in one if not np.array_equal(one[k], two[k])]
    return all(np.isfinite(two[k]).all() for k in changed if two[k].dtype.kind == "f") and _points_right(two)


def _arrays(content: bytes) -> dict[str, Any]:
    found = np.load(io.BytesIO(content), allow_pickle=False)
    return {"": found} if isinstance(found, np.ndarray) else dict(found.items())


def _points_right(arrays: dict[str, Any]) -> bool:
    """Tell whether pointers and indices of a compressed matrix lie where they may."""
    if "indptr" not in arrays or "shape" not in arrays:
        return True
    pointer, index = arrays["indptr"], arrays["indices"]
    return bool(
        pointer[0] == 0
        and pointer[-1] == len(index)
        and (np.diff(pointer) >= 0).all()
        and (index >= 0).all()
        and (index < arrays["shape"][1]).all()
    )
