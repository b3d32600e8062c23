"""A report as a Word document: its text, its tables, and its charts as pictures."""

from __future__ import annotations

import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from acquisition.libraries import library
from modalkit.figures.chart import chart_figure
from modalkit.figures.save import RESOLUTION
from modalkit.figures.style import WIDTH
from modalkit.output.destinations import Kind
from modalkit.report.document import Document, Part
from modalkit.report.html import Raw
from modalkit.views.chart import Chart

if TYPE_CHECKING:
    from docx.document import Document as WordDocument
    from docx.text.paragraph import Paragraph

MAKER = "modalkit"
"""What the document's properties name as its author."""

PICTURE, LINE = 6.3, 8
"""Width of a picture [in], and size of the text in tables and listings [pt]."""


def _is_ours(path: Path) -> bool:
    try:
        with zipfile.ZipFile(path) as archive:
            return f"<dc:creator>{MAKER}</dc:creator>".encode() in archive.read("docProps/core.xml")
    except (OSError, KeyError, zipfile.BadZipFile):
        return False


WORD = Kind("a report written by modalkit", "report", ".docx", _is_ours)
"""Reports for a word processor."""


def check_word(path: Path) -> None:
    """See that the library that writes Word documents is there.

    Raises
    ------
    InputError
        If it is not installed.
    """
    library("docx", path, extra="word", does="written")


def word(document: Document) -> bytes:
    """Return a report as the content of a Word file.

    Parameters
    ----------
    document : Document
        The report; charts and structures in space become pictures.
    """
    import docx
    from docx.shared import Inches

    whole = docx.Document()
    whole.core_properties.author = MAKER
    whole.core_properties.title = f"{document.title}: {document.kind}"
    for page in whole.sections:
        page.left_margin = page.right_margin = Inches(1.0)
    _Markup(whole).add(document.head)
    for section in document.shown:
        whole.add_heading(section.title, level=2)
        for part in section.shown:
            _add(whole, part)
    content = BytesIO()
    whole.save(content)
    return content.getvalue()


def _add(whole: WordDocument, part: Part) -> None:
    from docx.shared import Inches

    if isinstance(part, Raw):
        _Markup(whole).add(part)
        return
    figure = chart_figure(part.on_paper()) if isinstance(part, Chart) else part.still()
    picture = BytesIO()
    figure.savefig(picture, format="png", dpi=RESOLUTION)
    share = float(figure.get_size_inches()[0]) / WIDTH
    whole.add_picture(BytesIO(picture.getvalue()), width=Inches(PICTURE * min(share, 1.0)))


@dataclass
class _Table:
    """A table as it is read: rows of cells, whether a row heads the others, and its caption."""

    rows: list[list[str]] = field(default_factory=list)
    heads: int = 0
    caption: str = ""


class _Markup(HTMLParser):
    """Read the elements of a report and add what they hold to a document.

    Parameters
    ----------
    whole : docx Document
        What is added to.
    """

    HEADINGS = ("h1", "h2", "h3")
    BLOCKS = ("p", "li", "dt", "dd", "summary", "pre", "caption", "th", "td", *HEADINGS)

    def __init__(self, whole: WordDocument) -> None:
        super().__init__(convert_charrefs=True)
        self.whole = whole
        self.table: _Table | None = None
        self.runs: list[tuple[str, str]] = []  # text, and the mark-up it is in
        self.inside: list[str] = []
        self.block = ""

    def add(self, markup: Raw) -> None:
        """Add a piece of markup."""
        self.feed(markup.markup)
        self.close()

    def handle_starttag(self, tag: str, attrs: Sequence[tuple[str, str | None]]) -> None:
        """Begin an element."""
        if tag == "br":
            self.runs.append(("\n", ""))
        elif tag in ("strong", "code"):
            self.inside.append(tag)
        elif tag == "table":
            self.table = _Table()
        elif tag == "tr" and self.table is not None:
            self.table.rows.append([])
        elif tag in self.BLOCKS:
            self.block, self.runs = tag, []

    def handle_data(self, data: str) -> None:
        """Take text; blanks between elements are none."""
        if self.block:
            self.runs.append((data, self.inside[-1] if self.inside else ""))

    def handle_endtag(self, tag: str) -> None:
        """End an element and add it."""
        if tag in ("strong", "code") and self.inside:
            self.inside.pop()
        elif tag == "thead" and self.table is not None:
            self.table.heads = len(self.table.rows)
        elif tag == "table" and self.table is not None:
            _add_table(self.whole, self.table)
            self.table = None
        elif tag == self.block:
            self._end(tag)
            self.block = ""

    def _end(self, tag: str) -> None:
        text = "".join(run for run, _ in self.runs)
        if self.table is not None and tag in ("th", "td"):
            self.table.rows[-1].append(text)
        elif self.table is not None and tag == "caption":
            self.table.caption = text
        elif tag in self.HEADINGS:
            self.whole.add_heading(text, level={"h1": 0, "h2": 2, "h3": 3}[tag])
        elif text.strip():
            self._paragraph(tag)

    def _paragraph(self, tag: str) -> None:
        from docx.shared import Inches, Pt

        found = self.whole.add_paragraph(style="List Bullet" if tag == "li" else None)
        for text, within in self.runs:
            run = found.add_run(text)
            run.bold = tag in ("dt", "summary") or within == "strong"
            if tag == "pre" or within == "code":
                run.font.name, run.font.size = "Courier New", Pt(LINE)
        if tag == "dt":
            found.paragraph_format.space_after = Pt(0)
            found.paragraph_format.keep_with_next = True
        elif tag == "dd":
            found.paragraph_format.left_indent = Inches(0.3)


def _add_table(whole: WordDocument, table: _Table) -> None:
    if table.caption:
        whole.add_paragraph(table.caption, style="Caption").paragraph_format.keep_with_next = True
    if not table.rows:
        return
    columns = max(map(len, table.rows))
    made = whole.add_table(rows=0, cols=columns, style="Light List Accent 1")
    for k, row in enumerate(table.rows):
        cells = made.add_row().cells
        for cell, text in zip(cells, row, strict=False):
            _small(cell.paragraphs[0], text, bold=k < table.heads)
    whole.add_paragraph()


def _small(paragraph: Paragraph, text: str, *, bold: bool) -> None:
    from docx.shared import Pt

    run = paragraph.add_run(text)
    run.bold, run.font.size = bold, Pt(LINE)
    paragraph.paragraph_format.space_after = Pt(0)
