"""No process runs a Python file that lies in the current folder or beside a study."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from acquisition import EstimationError
from modalkit.papers.real.running import diagnose_together_by
from modalkit.simulator.bodies.solid.deck import program
from modalkit.workers import WarmProcess
from modalkit.workers.pool import warm_pool

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = [str(Path(sys.executable).parent / "modalkit")]
MODULE = [sys.executable, "-m", "modalkit"]
MARK = "executed.txt"
DECOY = """\
import pathlib
with open(pathlib.Path(__file__).with_name("executed.txt"), "a") as file:
    file.write(__name__ + chr(10))
raise SystemExit("a file beside the study was executed: " + __name__)
"""
OURS = {"modalkit", "acquisition", "identification", "updating"}
NAMES = (set(sys.stdlib_module_names) | set(packages_distributions())) - OURS


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a study, and a file for every module that there is."""
    for name in [*sorted(n for n in NAMES if n.isidentifier()), "sitecustomize", "usercustomize"]:
        (tmp_path / f"{name}.py").write_text(DECOY, encoding="utf-8")
    shutil.copy(ROOT / "sample_data/beam_wet/beam_wet.uff", tmp_path / "test.uff")
    (tmp_path / "modes.csv").write_text("frequency,sigma\n10.5,0.01\n65.1,0.02\n", encoding="utf-8")
    (tmp_path / "study.toml").write_text('[test]\nmodes = "modes.csv"\n', encoding="utf-8")
    return tmp_path


def run(folder: Path, words: list[str], **variables: str) -> str:
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"} | variables
    done = subprocess.run(
        words, cwd=folder, env=environment, capture_output=True, text=True, timeout=600, check=False
    )
    assert not (folder / MARK).exists(), (folder / MARK).read_text(encoding="utf-8")
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.long
def test_commands_run_nothing_of_the_current_folder(folder: Path) -> None:
    assert "75 hits" in run(folder, [*SCRIPT, "inspect", "test.uff"])
    run(folder, [*SCRIPT, "effects", "--json", "effects.json"])
    assert (folder / "effects.json").exists()


@pytest.mark.long
def test_started_as_a_module_only_what_the_interpreter_needs_to_start_it_can_be_mistaken(
    folder: Path,
) -> None:
    body = "import runpy, sys; print(*sys.modules)"
    before = subprocess.run([sys.executable, "-I", "-c", body], capture_output=True, text=True, check=True)
    for name in before.stdout.split():
        (folder / f"{name}.py").unlink(missing_ok=True)
    assert (folder / "scipy.py").exists()
    assert (folder / "typing.py").exists()
    assert "75 hits" in run(folder, [*MODULE, "inspect", "test.uff"])


@pytest.mark.long
def test_a_batch_runs_nothing_of_the_current_folder(folder: Path) -> None:
    run(folder, [*SCRIPT, "batch", ".", "-o", "table.csv"])
    assert "10.5" in (folder / "table.csv").read_text(encoding="utf-8")


@pytest.mark.long
@pytest.mark.parametrize("variable", ["", os.pathsep, "."])
def test_a_warm_process_runs_nothing_of_the_current_folder(
    folder: Path, monkeypatch: pytest.MonkeyPatch, variable: str
) -> None:
    monkeypatch.chdir(folder)
    monkeypatch.setenv("PYTHONPATH", variable)
    with WarmProcess() as process:
        process.run(folder, ["effects", "--json", "effects.json"])
    assert (folder / "effects.json").exists()
    assert not (folder / MARK).exists()


@pytest.mark.long
def test_the_diagnosis_of_a_real_structure_runs_nothing_beside_its_study(folder: Path) -> None:
    with warm_pool(1) as ask, pytest.raises(EstimationError, match=r"no\.toml: cannot be opened"):
        diagnose_together_by(ask)([folder / "no.toml"], (), ())
    assert not (folder / MARK).exists()


def test_a_folder_that_is_named_in_full_stays_on_the_path(tmp_path: Path) -> None:
    (tmp_path / "own_reader.py").write_text("", encoding="utf-8")
    body = "from modalkit.module_path import *; leave_current_folder(); import own_reader; print(child_environment())"
    assert str(tmp_path) in run(tmp_path, [sys.executable, "-c", body], PYTHONPATH=str(tmp_path))


def test_calculix_is_never_taken_from_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    decoy = tmp_path / "ccx"
    decoy.write_text("#!/bin/sh\ntouch executed.txt\n", encoding="utf-8")
    decoy.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", os.pathsep.join(["", ".", str(tmp_path / "none")]))
    assert shutil.which("ccx") is not None  # what was asked before
    assert program() is None


@pytest.mark.long
def test_figures_do_not_follow_a_matplotlibrc_of_the_current_folder(folder: Path) -> None:
    for name in ("published.toml", "modes.csv"):
        shutil.copy(ROOT / "sample_data/beam_dry" / name, folder)
    update = [*SCRIPT, "update", "published.toml", "--figures"]
    run(folder, [*update, "plain"])
    (folder / "matplotlibrc").write_text("axes.facecolor: red\nfont.size: 30\n", encoding="utf-8")
    run(folder, [*update, "styled"])
    assert (folder / "plain/update.png").read_bytes() == (folder / "styled/update.png").read_bytes()
