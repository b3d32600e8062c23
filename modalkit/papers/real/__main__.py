"""Put the table of a record of real structures between the markers of a page: RECORD.json PAGE.md."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from modalkit.papers.real.document import put_between_markers, real_markdown


def main(record: str, page: str) -> None:
    """Rewrite the page."""
    table = real_markdown(json.loads(Path(record).read_text(encoding="utf-8")))
    target = Path(page)
    target.write_text(put_between_markers(target.read_text(encoding="utf-8"), table), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: python -m modalkit.papers.real RECORD.json PAGE.md")
    main(sys.argv[1], sys.argv[2])
