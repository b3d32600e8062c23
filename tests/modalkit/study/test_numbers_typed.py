"""Every number that is typed is refused in one line where it is none, or out of range."""

from __future__ import annotations

import inspect
import sys
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest

from acquisition import InputError
from identification.fit.search.manual_selection import nearest_modes
from modalkit.cli import main
from modalkit.cli.on_demand import ENTRIES, loaded
from modalkit.workflow.processing_options import ProcessingOptions, sensor_mass

SAMPLE = Path(__file__).resolve().parents[3] / "sample_data" / "beam_wet"
WORDS = {
    "frf": ("frf", str(SAMPLE / "beam_wet.uff"), "-o", "out.uff"),
    "inspect": ("inspect", str(SAMPLE / "beam_wet.uff")),
    "identify": ("identify", str(SAMPLE / "beam_wet.uff")),
    "simulate": ("simulate", str(SAMPLE / "published.toml"), "-o", "out.uff"),
    "update": ("update", str(SAMPLE / "study.toml")),
    "blind": ("blind",),
    "batch": ("batch", str(SAMPLE), "-o", "out.csv"),
}
OUT_OF_RANGE = """
identify --drop -3
identify --drop 0
identify --add -4
identify --band -10 500
identify --band 500 5
identify --band 0 1e300
identify --order 0
identify --order 1000000000
identify --decay -8
identify --decay 1e300
identify --window 1e300
frf --window -1
frf --sensor-mass 1+Z=-1
simulate --points -1
simulate --points 1000000000
simulate --samples 1000000000000
simulate --hits 1000000000
simulate --rate 1e300
simulate --rate 1e-3
simulate --noise 1e300
simulate --seed -1
simulate --effect E:factor=1e300
update --bootstrap -1
update --bootstrap 1000000000000
update --seed -1
blind --trials 0
blind --trials 1000000000000
blind --workers 0
blind --workers 1000000
blind --seed -4
batch --workers -1
batch --workers 1000000
"""


def floats() -> list[tuple[str, str, int]]:
    """Return every option that takes floating-point numbers, by command, and how many at a time."""
    found = []
    for entry in ENTRIES:
        command = loaded(entry.module)[entry.name]
        hints = get_type_hints(inspect.unwrap(command.callback))
        for parameter in command.params:
            if "float" in str(hints.get(parameter.name)):
                found.append((entry.name, max(parameter.opts, key=len), parameter.nargs))
    return found


@pytest.fixture
def refused(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], tmp_path: Path):
    monkeypatch.chdir(tmp_path)

    def call(*words: str) -> str:
        monkeypatch.setattr(sys, "argv", ["modalkit", *words])
        with pytest.raises(SystemExit) as ended:
            main()
        message = capfd.readouterr().err.strip()
        assert ended.value.code == 2, message
        assert list(tmp_path.iterdir()) == []
        assert "internal error" not in message
        assert "Warning:" not in message
        return message

    return call


@pytest.mark.parametrize("value", ["nan", "inf", "-inf"])
@pytest.mark.parametrize(("command", "option", "count"), floats())
def test_what_is_no_finite_number_is_refused(refused, command, option, count, value) -> None:
    message = refused(*WORDS[command], *((option, value) if count == 1 else (option, "5", value)))
    assert option in message


@pytest.mark.parametrize("line", OUT_OF_RANGE.strip().splitlines())
def test_what_is_out_of_range_is_refused(refused, line: str) -> None:
    command, *words = line.split()
    assert len(refused(*WORDS[command], *words).splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "unit"),
    [("--band 5mm 500", "Hz"), ("--drop 3rad/s", "Hz"), ("--decay 3kg", "1/s"), ("--band 5Hz", "--band")],
)
def test_a_unit_of_another_kind_is_refused(refused, words: str, unit: str) -> None:
    message = refused(*WORDS["identify"], *words.split())
    assert unit in message and words.split(maxsplit=1)[0] in message and len(message.splitlines()) == 1


def test_units_are_understood_as_in_a_study() -> None:
    """A band in kHz, a decay per millisecond, a sensor in grams."""
    command = loaded("measuring")["identify"]
    words = [
        "a.uff",
        "--band",
        "5Hz",
        "1.2kHz",
        "--drop",
        "0.1 kHz",
        "--decay",
        "0.002 1/ms",
        "--window",
        "3",
    ]
    values = command.make_context("identify", words).params
    assert (values["band"], list(values["drop"])) == ((5.0, 1200.0), [100.0])
    assert (values["decay"], values["window"]) == (2.0, 3.0)
    assert sensor_mass("25+Z=8.6g") == ("25+Z", 0.0086)


def test_the_options_are_found() -> None:
    assert {"--band", "--add", "--drop", "--decay", "--window", "--rate", "--noise"} <= {
        o for _, o, _ in floats()
    }


def test_no_mode_is_near_what_is_no_number() -> None:
    poles = np.array([-1 + 100j, -1 + 200j])
    with pytest.raises(InputError, match="no mode near nan Hz"):
        nearest_modes(poles, [float("nan")], np.ones(2, dtype=bool), 0.1)
    for value in (float("nan"), float("inf"), -1.0):
        with pytest.raises(InputError, match="decay rates must be between 0 and"):
            ProcessingOptions(decay=value)


def test_too_little_memory_is_an_error_in_one_line(
    refused, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    def full(*_: object, **__: object) -> None:
        raise MemoryError("Unable to allocate 7.28 TiB")

    there = tmp_path_factory.mktemp("whole") / "a.uff"
    there.touch()
    monkeypatch.setattr("modalkit.cli.measuring.read_files", full)
    assert "there is not enough memory (Unable to allocate 7.28 TiB)" in refused("inspect", str(there))
