"""Two thousand damaged files of every family: none crashes, hangs, swells, or changes a number without a word."""

from __future__ import annotations

import os

import pytest
from corpus import families
from judge import BAD, Judge

FAMILIES = {family.name: family for family in families()}
MUTANTS = int(os.environ.get("ATTACK_MUTANTS", "2000"))


@pytest.mark.parametrize("name", FAMILIES)
def test_damage_is_refused_said_or_beyond_any_reader(name: str) -> None:
    judge = Judge(FAMILIES[name], seed=20)
    verdicts = [judge.judge(index) for index in range(MUTANTS)]
    assert [v for v in verdicts if v.outcome in BAD] == []
    assert sum(v.outcome == "refused" for v in verdicts) > MUTANTS // 20


@pytest.mark.parametrize("name", FAMILIES)
def test_whole_files_are_read_without_a_word_that_is_new(name: str) -> None:
    family = FAMILIES[name]
    first, second = Judge(family, seed=1), Judge(family, seed=1)
    assert [r.digest for r in first.whole] == [r.digest for r in second.whole]
    assert first.mutant(7) == second.mutant(7)
