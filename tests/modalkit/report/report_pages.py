"""What several of the tests beside it need."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from figure_cases import case_of

from modalkit.report import diagnosis_report
from modalkit.report.page import page as html
from modalkit.study.read import Study, read_study
from modalkit.workflow.case import Session
from updating import Diagnosis
from updating.diagnosis.answer.result import Gap
from updating.effects import Lack, Obstacle

NOON = datetime(2026, 3, 1, 12, tzinfo=UTC)


ROOT = Path(__file__).resolve().parents[3]


VOID = {"meta", "br", "img"}


SCRIPTS = {"style", "script"}


class Reader(HTMLParser):
    """Reads a page, and fails where its elements do not nest."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(page)
        self.close()
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not SCRIPTS & set(self.open):
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())

    def values(self, name: str) -> list[str]:
        return [v for _, attributes in self.tags for k, v in attributes.items() if k == name and v]


def session_of(kind: str, folder: Path, *, title: str = "A case") -> Session:
    path = folder / "study.toml"
    path.write_text(f'title = """{title}"""\n[test]\nmodes = "modes.csv"\n', encoding="utf-8")
    (folder / "modes.csv").write_text("frequency\n20\n", encoding="utf-8")
    study: Study = read_study(path)
    return Session(
        study, replace(case_of(kind, factor=0.95), title=title), None, None, ("a warning <of> the session",)
    )


def complete(diagnosis: Diagnosis, title: str = "A case") -> Diagnosis:
    """Give a diagnosis made by hand what a real one has."""
    modes = diagnosis.gap.modes.assign(
        study=title, MAC=0.99, **{"model [Hz]": 100.0, "test damping": 0.01, "model damping": np.nan}
    )
    modes.index = pd.RangeIndex(1, len(modes) + 1, name="mode")
    gap = Gap(modes, 3.2, 0.1, np.ones(3))
    out = {
        "shear": Obstacle(Lack.MODEL, "plates are modelled as thin"),
        "damping_patch": Obstacle(Lack.EXPECTATION, "nothing says what damping to expect"),
    }
    return replace(diagnosis, title=title, gap=gap, not_examined=out, warnings=("mind the <gap>",))


def diagnosis_page(diagnosis: Diagnosis, sessions: Sequence[Session], *, when: datetime) -> str:
    """Return the report of a diagnosis as HTML."""
    return html(diagnosis_report(diagnosis, sessions, when=when))


def data_of(page: str) -> dict[str, Any]:
    """Return what the figures of a page are made of."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, flags=re.DOTALL)
    assert found is not None
    return json.loads(found[1])
