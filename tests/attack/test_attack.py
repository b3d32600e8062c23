"""Two thousand damaged files of every family: none crashes, hangs, swells, or changes a number without a word."""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np
import pytest
from corpus import families
from judge import BAD, Judge

from updating.models.imported import market

pytestmark = pytest.mark.long

FAMILIES = {family.name: family for family in families()}
MUTANTS = int(os.environ.get("ATTACK_MUTANTS", "2000"))


@pytest.mark.parametrize("name", FAMILIES)
def test_damage_is_refused_warned_of_or_beyond_any_reader(name: str, tmp_path: Path) -> None:
    judge = Judge(FAMILIES[name], 20, tmp_path)
    verdicts = [judge.judge(index) for index in range(MUTANTS)]
    assert [v for v in verdicts if v.outcome in BAD] == []
    assert sum(v.outcome == "refused" for v in verdicts) > MUTANTS // 20


@pytest.mark.parametrize("name", FAMILIES)
def test_whole_files_and_mutants_are_the_same_every_time(name: str, tmp_path: Path) -> None:
    family = FAMILIES[name]
    places = tmp_path / "first", tmp_path / "second"
    for place in places:
        place.mkdir()
    first, second = (Judge(family, 1, place) for place in places)
    assert [r.digest for r in first.whole] == [r.digest for r in second.whole]
    assert first.mutant(7) == second.mutant(7)


def test_a_reader_that_drops_exponents_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another number in a number's place no reader can see; that one reads but a part of it, this must."""
    read = market.columns_of

    def careless(text: bytes, kinds: str, path: Path, *, first: int = 1) -> list[np.ndarray]:
        return read(re.sub(rb"[dD][+-]?\d+", b"", text), kinds, path, first=first)

    judge = Judge(FAMILIES["MatrixMarket"], 20, tmp_path)
    monkeypatch.setattr(market, "columns_of", careless)
    assert any(judge.judge(index).outcome == "changed" for index in range(1500))
