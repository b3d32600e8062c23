"""Two thousand damaged files of every family: none crashes, hangs, swells, or changes a number without a word."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from corpus import families
from judge import BAD, Judge

FAMILIES = {family.name: family for family in families()}
MUTANTS = int(os.environ.get("ATTACK_MUTANTS", "2000"))


@pytest.mark.parametrize("name", FAMILIES)
def test_damage_is_refused_said_or_beyond_any_reader(name: str, tmp_path: Path) -> None:
    judge = Judge(FAMILIES[name], 20, tmp_path)
    verdicts = [judge.judge(index) for index in range(MUTANTS)]
    assert [v for v in verdicts if v.outcome in BAD] == []
    assert sum(v.outcome == "refused" for v in verdicts) > MUTANTS // 20


@pytest.mark.parametrize("name", FAMILIES)
def test_whole_files_are_read_without_a_word_that_is_new(name: str, tmp_path: Path) -> None:
    family = FAMILIES[name]
    places = tmp_path / "first", tmp_path / "second"
    for place in places:
        place.mkdir()
    first, second = (Judge(family, 1, place) for place in places)
    assert [r.digest for r in first.whole] == [r.digest for r in second.whole]
    assert first.mutant(7) == second.mutant(7)
