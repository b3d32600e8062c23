"""From rows, one for each trial, to rates with intervals and tables of confusions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar

import numpy as np
from scipy.stats import binomtest

Row = dict[str, Any]
T = TypeVar("T")


def wilson(hits: int, total: int) -> tuple[float, float]:
    """Return the 95 % interval of a share (Wilson 1927), nan where there are no trials."""
    if not total:
        return float("nan"), float("nan")
    interval = binomtest(hits, total).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


def share(rows: Sequence[T], test: Callable[[T], bool]) -> str:
    """Write a share of the rows with its interval [%]."""
    hits, total = sum(bool(test(r)) for r in rows), len(rows)
    if not total:
        return "-"
    low, high = wilson(hits, total)
    return f"{100 * hits / total:.1f} [{100 * low:.0f}, {100 * high:.0f}] ({hits}/{total})"


def answered(row: Row) -> bool:
    """Tell whether the answer is one name or a class."""
    return row["verdict"] in ("named", "class")


def holds(row: Row) -> bool:
    """Tell whether the answer, up to the class it states, holds the truth."""
    return answered(row) and any(_same(s, row) for s in row["sets"])


def first(row: Row) -> bool:
    """Tell whether the most probable set is the truth itself."""
    return answered(row) and bool(row["sets"]) and _same(row["sets"][0], row)


def _same(names: Sequence[str], row: Row) -> bool:
    return sorted(names) in [list(r) for r in row["right"]]


ALIKE = {"section_scale": "calibration_gain", "exponential_window": "uniform_damping"}
"""Effects that change the data in exactly the same way, so that no more than both can be named."""


def commits(row: Row) -> bool:
    """Tell whether the answer is one name, or names that are the same by construction."""
    different = {tuple(sorted(ALIKE.get(n, n) for n in names)) for names in row["sets"]}
    return answered(row) and len(different) == 1


def groups(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Return rows by what the diagnosis had, for specimens with one hidden cause of the library."""
    inside = [r for r in rows if r["right"] and len(r["names"]) == 1 and not r.get("left_out")]
    split: dict[str, Callable[[Row], bool]] = {
        "clear, level": lambda r: r["severity"] == "clear" and r["absolute"] and not r["baseline"],
        "clear, level and baseline": lambda r: r["severity"] == "clear" and r["absolute"] and r["baseline"],
        "clear, shapes only": lambda r: r["severity"] == "clear" and not r["absolute"],
        "mild, level": lambda r: r["severity"] == "mild" and r["absolute"] and not r["baseline"],
        "mild, level and baseline": lambda r: r["severity"] == "mild" and r["absolute"] and r["baseline"],
    }
    named = {name: [r for r in inside if keep(r)] for name, keep in split.items()}
    for kind in ("beam", "plate"):
        named[f"clear, level, {kind}s"] = [r for r in named["clear, level"] if r["kind"] == kind]
    pairs = [r for r in rows if r["right"] and len(r["names"]) == 2 and not r.get("left_out")]
    return named | {
        "pairs, no baseline": [r for r in pairs if not r["baseline"]],
        "pairs, baseline": [r for r in pairs if r["baseline"]],
    }


def summary(rows: Sequence[Row]) -> str:
    """Return the rates as a table in markdown."""
    lines = [
        "| specimens | top-1 | truth in the class | mean class | right when it commits | commits | seconds (max) |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, group in groups(rows).items():
        if not group:
            continue
        sizes = [len(r["sets"]) for r in group if answered(r)]
        named = [r for r in group if commits(r)]
        lines.append(
            f"| {name} | {share(group, first)} | {share(group, holds)} | {np.mean(sizes) if sizes else 0:.2f} | "
            f"{share(named, holds)} | {share(group, commits)} | "
            f"{np.mean([r['seconds'] for r in group]):.1f} ({max(r['seconds'] for r in group):.1f}) |"
        )
    return "\n".join([*lines, "", *_others(rows)])


def _others(rows: Sequence[Row]) -> Iterable[str]:
    nothing = [r for r in rows if not r["names"]]
    outside = [r for r in rows if r["names"] and not r["right"] and not r.get("left_out")]
    left = [r for r in rows if r.get("left_out")]
    yield f"- false alarms on none: {share(nothing, lambda r: r['verdict'] != 'none')} %"
    yield f"- outside the library, called unknown: {share(outside, lambda r: r['verdict'] == 'unknown')} %"
    yield f"- left out of the library, called unknown: {share(left, lambda r: r['verdict'] == 'unknown')} %"
    yield f"- failed: {sum(r['verdict'] == 'failed' for r in rows)} of {len(rows)}"
    inside = [c for r in rows if first(r) for c in r.get("covered", {}).values()]
    yield f"- severity within its 95 % interval: {share(inside, bool)} %"
    away = [r["place_error"] for r in rows if first(r) and r.get("place_error") is not None]
    if away:
        near = share(away, lambda a: a < 0.05)
        yield f"- place: median error {100 * np.median(away):.1f} % of the span, within 5 % in {near} %"
    stated = [r for r in rows if answered(r) and None not in (r.get("closed"), r.get("truly_closed"))]
    separation = [r["closed"] - r["truly_closed"] for r in stated]
    if separation:
        near = share(separation, lambda a: abs(a) <= 10)
        yield f"- shrinkage predicted less true: median {np.median(separation):+.1f} points, within 10 in {near} %"


def by_effect(rows: Sequence[Row]) -> str:
    """Return what became of every hidden cause, in markdown."""
    lines = [
        "| hidden | trials | first | in class | mean class | answers |",
        "|---|---|---|---|---|---|",
    ]
    for name in dict.fromkeys("+".join(r["names"]) or "none" for r in rows):
        group = [r for r in rows if ("+".join(r["names"]) or "none") == name]
        answers = Counter(answer(r) for r in group).most_common(6)
        sizes = [len(r["sets"]) for r in group if answered(r)]
        lines.append(
            f"| {name} | {len(group)} | {sum(map(first, group))} | {sum(map(holds, group))} | "
            f"{np.mean(sizes) if sizes else 0:.1f} | {', '.join(f'{a} {n}' for a, n in answers)} |"
        )
    return "\n".join(lines)


def answer(row: Row) -> str:
    """Return the answer in a word."""
    if not answered(row):
        return str(row["verdict"])
    return "+".join(row["sets"][0]) + ("..." if len(row["sets"]) > 1 else "")
