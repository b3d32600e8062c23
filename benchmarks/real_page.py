"""Put the tables of a record of real structures between the markers of a page.

modalkit blind --real --data ../shared/data --json real.json
python benchmarks/real_page.py real.json docs/trust/real.md
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

BEGIN, END = "<!-- real: begin -->", "<!-- real: end -->"


def real_markdown(document: Mapping[str, Any]) -> str:
    """Return the tables of the documentation from a document.

    Parameters
    ----------
    document : mapping
        ``modalkit.real/1``.

    Returns
    -------
    str
        Markdown: how many are right, the tables with the library whole and without the true effects, and what is
        withheld and known with its source.
    """
    whole = [c for c in document["cases"] if not c["without"]]
    left_out = [c for c in document["cases"] if c["without"]]
    parts = [
        *_stated("The library whole", whole),
        *_stated("The true effects taken out of the library", left_out),
    ]
    if whole:
        parts += ["### What is known, and from where", "", *_rows(_known(whole)), ""]
    return "\n".join(parts)


def _known(cases: Sequence[Mapping[str, Any]]) -> list[dict[str, str]]:
    """Return what is withheld and from where it is known, cases of which both are the same in one row."""
    names: dict[tuple[str, str], list[str]] = {}
    for case in cases:
        names.setdefault((case["withheld"], case["source"]), []).append(case["name"])
    return [{"case": "; ".join(n), "withheld": w, "known from": s} for (w, s), n in names.items()]


def _stated(heading: str, cases: Sequence[Mapping[str, Any]]) -> list[str]:
    if not cases:
        return []
    grades = [c.get("grade", "skipped") for c in cases]
    stated = [f"{grades.count(g)} {g}" for g in ("right", "partly", "wrong", "skipped") if g in grades]
    line = f"{len(cases)} cases: {', '.join(stated)}."
    return [f"### {heading}", "", line, "", *_rows([c["row"] for c in cases]), ""]


def _rows(rows: Sequence[Mapping[str, str]]) -> list[str]:
    names = list(rows[0])
    lines = [f"| {' | '.join(names)} |", f"|{' --- |' * len(names)}"]
    return lines + ["| " + " | ".join(row[name].replace("|", "\\|") for name in names) + " |" for row in rows]


def put_between_markers(page: str, table: str) -> str:
    """Return a page with what stands between its two markers replaced.

    Raises
    ------
    ValueError
        If it has no such markers.
    """
    head, begin, rest = page.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"no {BEGIN} ... {END} in the page")
    return f"{head}{BEGIN}\n\n{table}\n{END}{tail}"


def main(record: str, page: str) -> None:
    """Rewrite the page."""
    table = real_markdown(json.loads(Path(record).read_text(encoding="utf-8")))
    target = Path(page)
    target.write_text(put_between_markers(target.read_text(encoding="utf-8"), table), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: python benchmarks/real_page.py RECORD.json PAGE.md")
    main(sys.argv[1], sys.argv[2])
