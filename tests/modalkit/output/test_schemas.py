"""The fields of the JSON documents: each says what it is, and the page of reference has them all."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

import pytest
from conforming import departures

from modalkit.output.schemas import DOCUMENTS
from modalkit.output.schemas.correlation import NumberedMode
from modalkit.output.schemas.diagnosis import SOMETHING_ELSE, NextTestEntry
from updating.diagnosis.answer import in_no_library

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "docs" / "_ext"))

import json_fields  # noqa: E402
from reference import documents  # noqa: E402

OWN = {"modalkit.part/1", "modalkit.app/1", "modalkit.batchrun/1", "modalkit.blindrun/2"}
"""Files that the program alone reads again: what the app keeps, stores of runs, the part of a fleet in one."""

EARLIER = {"modalkit.blind/1"}
"""Versions that are still read and are written no more: the page describes the latest."""


@pytest.mark.parametrize("document", DOCUMENTS, ids=json_fields.document_name)
def test_every_field_says_what_it_is(document: type) -> None:
    found = list(json_fields.fields(document))
    assert not [f.path for f in found if not f.sentence]
    assert not [f.path for f in found if json_fields.holds_numbers(f.kind) != bool(f.unit)]
    assert not [f.path for f in found if json_fields.may_be_null(f.kind) and "null" not in f.sentence]
    page = documents()
    assert not [f.path for f in found if f"| `{f.path}` |" not in page]


def test_every_document_is_on_the_page() -> None:
    code = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "modalkit").rglob("*.py"))
    assert set(re.findall(r"modalkit\.[a-z]+/\d", code)) == OWN | EARLIER | {
        json_fields.document_name(d) for d in DOCUMENTS
    }


def test_the_nomenclature_speaks_of_fields_that_there_are_and_says_each_once() -> None:
    page = (ROOT / "docs" / "reference" / "nomenclature.md").read_text(encoding="utf-8")
    rows = [
        [cell.strip() for cell in line.split("|")[1:-1]]
        for line in page.splitlines()
        if line.startswith("| ")
    ]
    named = {field for row in rows if len(row) == 3 for field in re.findall(r"`(\w+)`", row[1])}
    there = {
        re.split(r"[.\[]", f.path.removesuffix("[]"))[-1] for d in DOCUMENTS for f in json_fields.fields(d)
    }
    assert len(named) > 40
    assert not named - there
    assert len({row[0] for row in rows}) == len(rows)


@pytest.mark.parametrize(
    ("value", "kind", "where"),
    [
        ({"mode": 1, "frequency_hz": 2.0}, NumberedMode, []),
        ({"mode": 1}, NumberedMode, [".frequency_hz: is not there"]),
        ({"mode": 1, "frequency_hz": 2.0, "new": 1}, NumberedMode, [".new: is not declared"]),
        ({"mode": True, "frequency_hz": 2}, NumberedMode, [".mode: True is no <class 'int'>"]),
        ({"measure": "", "separates": ["E"], "expected_sigma": None}, NextTestEntry, []),
        ({"measure": "", "separates": "E", "expected_sigma": 1.5}, NextTestEntry, [".separates: 'E' is no"]),
        (
            {"measure": "", "separates": [], "expected_sigma": "1"},
            NextTestEntry,
            [".expected_sigma: '1' is no"],
        ),
    ],
)
def test_a_departure_from_what_is_declared_is_found(value: Any, kind: type, where: list[str]) -> None:
    found = departures(value, kind)
    assert len(found) == len(where)
    assert all(one.startswith(start) for one, start in zip(found, where, strict=True))


def test_a_cause_in_no_library_has_one_name() -> None:
    assert in_no_library.SOMETHING_ELSE == SOMETHING_ELSE
