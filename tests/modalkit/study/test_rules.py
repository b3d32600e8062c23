"""A file of rules: those named are taken, the rest are the defaults, and what is none is refused with advice."""

import json
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import pytest
from conforming import departures

from acquisition.errors import StudyError
from modalkit.output.schemas import DiagnosisDocument
from modalkit.samples import sample_file
from modalkit.study.rules import read_rules
from updating import DecisionRules

Run = Callable[..., tuple[int, str, str]]


def written(folder: Path, text: str) -> Path:
    (folder / "rules.toml").write_text(text)
    return folder / "rules.toml"


def test_rules_that_are_named_are_taken(tmp_path: Path) -> None:
    assert read_rules(written(tmp_path, "split_sigma = 4\nrival_share = 0.1\n")) == DecisionRules(
        split_sigma=4, rival_share=0.1
    )
    assert read_rules(written(tmp_path, "")) == DecisionRules()
    every = "\n".join(f"{one.name} = {one.default}" for one in fields(DecisionRules))
    assert read_rules(written(tmp_path, every)).changed == {}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("significant_gab = 0.1", r"no rule 'significant_gab' \(is 'significant_gap' meant\?\); there are"),
        ("[rules]\nclose_fits = 4.0", "no rule 'rules'"),
        ("close_fits = true", "close_fits = True: must be a number"),
        ('close_fits = "4"', "close_fits = '4': must be a number"),
        ("credible_share = 2", "rule credible_share = 2: must be above 0 and at most 1"),
        ("split_sigma = nan", "rule split_sigma = nan: must be finite"),
        ("split_sigma 4", "not a valid TOML file"),
    ],
)
def test_what_is_no_rule_is_refused_with_advice(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(StudyError, match=message):
        read_rules(written(tmp_path, text))
    with pytest.raises(StudyError, match="give the path of a file of rules"):
        read_rules(tmp_path / "nowhere.toml")


@pytest.mark.long
def test_a_diagnosis_is_decided_by_the_file_and_records_it(run: Run, tmp_path: Path) -> None:
    """The gap of the beam is beyond doubt; a rule by which no chance is small enough, and no effect, leaves none."""
    target, study = tmp_path / "d.json", sample_file("beam_dry/published.toml")
    rules = written(tmp_path, "significant_gap = 1e-300\neffect_shows_gap = 1e6\nchance_of_a_fit = 1e-300\n")
    code, out, message = run("diagnose", study, "--without", "shear", "--rules", rules, "--json", target)
    assert not code, message
    document = json.loads(target.read_text())
    assert not departures(document, DiagnosisDocument)
    assert document["cause"]["verdict"] == "none"
    assert not document["significant"]
    assert document["rules"] == {
        "significant_gap": 1e-300,
        "effect_shows_gap": 1e6,
        "chance_of_a_fit": 1e-300,
    }
    assert "rules that differ from the defaults: significant_gap = 1e-300 (default: 0.005)" in out
