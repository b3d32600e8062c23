"""What is loaded when: a plain import and the list of commands cost nothing, a command pays for what it uses."""

from __future__ import annotations

import ast
import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from modalkit import __version__
from modalkit.cli.arguments import options_of
from modalkit.cli.on_demand import ENTRIES, loaded

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ("acquisition", "identification", "updating", "modalkit")
HEAVY = {"numpy", "scipy", "pandas", "matplotlib", "skfem", "pydantic_core", "sdypy", "pyuff"}
STATUS = "import json, sys; print('\\n' + json.dumps(sorted(sys.modules)))"


def modules_after(body: str) -> set[str]:
    """Return the modules that an interpreter of its own has loaded after some statements."""
    done = subprocess.run(
        [sys.executable, "-c", f"{body}\n{STATUS}"], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return set(json.loads(done.stdout.splitlines()[-1]))


def command(*words: str) -> str:
    return (
        f"import sys; sys.argv = ['modalkit', *{list(words)!r}]\n"
        "from modalkit.cli import main\ntry:\n    main()\nexcept SystemExit as ended:\n    assert not ended.code"
    )


@pytest.mark.parametrize("room", ROOMS)
def test_a_plain_import_loads_none_of_the_heavy_packages(room: str) -> None:
    assert not HEAVY & modules_after(f"import {room}")


@pytest.mark.long
def test_the_list_of_commands_loads_none_of_the_computing_packages() -> None:
    there = modules_after(command("--help"))
    assert not (HEAVY - {"pydantic_core"}) & there  # which some versions of typer bring along
    assert not {name for name in there if name.startswith(("identification.", "updating."))}


@pytest.mark.long
def test_inspect_loads_neither_identification_nor_models() -> None:
    there = modules_after(command("inspect", str(ROOT / "sample_data/beam_wet/beam_wet.uff")))
    assert "numpy" in there  # or the list says nothing
    assert not {"skfem", "matplotlib", "sdypy", "modalkit.study.read", "modalkit.workflow.case"} & there
    assert not {name for name in there if name.startswith(("identification.", "updating."))}


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.name)
def test_the_list_says_of_a_command_what_its_own_help_begins_with(entry) -> None:
    own = loaded(entry.module)[entry.name]
    assert " ".join((own.help or "").split("\n\n")[0].split()) == entry.summary
    assert own.hidden == entry.hidden


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda entry: entry.name)
def test_the_list_holds_the_options_of_a_command(entry) -> None:
    own = loaded(entry.module)[entry.name]
    found = {
        name: 0 if getattr(option, "is_flag", False) else option.nargs
        for option in own.params
        if option.param_type_name == "option"
        for name in option.opts
    }
    assert options_of(entry.options) == found


BAD = [
    (["identify", "nowhere.uff"], "nowhere.uff: cannot be opened"),
    (["identify", "UFF", "--bnad", "5", "500"], "No such option: --bnad; is --band meant?"),
    (["identify", "UFF", "-x"], "No such option: -x"),
    (["identify", "-band", "5", "500", "UFF"], "No such option: -band; is --band meant?"),
    (["identify", "-5"], "-5: cannot be opened"),
    (["identify", "-"], "-: cannot be opened"),
    (["identify", "UFF", "--band", "500", "5Hz"], "Invalid band 500 to 5 Hz: the lower limit comes first"),
    (["identify", "UFF", "--layout", "nowhere.toml"], "nowhere.toml: cannot be opened"),
    (["diagnose", "STUDY"], "unknown key model.lenght; known here: "),
]


@pytest.mark.parametrize(("words", "message"), BAD)
def test_bad_input_is_refused_before_the_libraries_are_loaded(
    tmp_path: Path, words: list[str], message: str
) -> None:
    study = tmp_path / "study.toml"
    study.write_text('[test]\nfiles = ["a.uff"]\n[model]\ntype = "beam"\nlenght = 1.0\n')
    given = {"UFF": str(ROOT / "sample_data/beam_wet/beam_wet.uff"), "STUDY": str(study)}
    body = command(*[given.get(word, word) for word in words]).replace("not ended.code", "ended.code == 2")
    done = subprocess.run(
        [sys.executable, "-c", f"{body}\n{STATUS}"], capture_output=True, text=True, check=True, cwd=ROOT
    )
    there = set(json.loads(done.stdout.splitlines()[-1]))
    assert message in done.stderr and len(done.stderr.splitlines()) == 1
    assert not {"scipy", "pandas", "matplotlib", "skfem", "sdypy", "pyuff"} & there
    assert not {name for name in there if name.startswith(("identification.", "updating."))}


@pytest.mark.parametrize("words", [["-h"], ["identify", "-h"]])
def test_help_has_a_short_name(words: list[str], run) -> None:
    code, text, _ = run(*words)
    assert code == 0 and "Usage: modalkit" in text


def test_the_version_is_that_of_the_package(run) -> None:
    assert run("--version") == (0, f"modalkit {__version__}\n", "")


@pytest.mark.long
def test_a_shell_completes_commands_and_options() -> None:
    for typed, expected in (("modalkit id", "identify"), ("modalkit identify --ba", "--band")):
        words = {
            "_MODALKIT_COMPLETE": "complete_bash",
            "COMP_WORDS": typed,
            "COMP_CWORD": str(typed.count(" ")),
        }
        done = subprocess.run(
            [sys.executable, "-c", "from modalkit.cli import main; main()"],
            capture_output=True, text=True, check=False, cwd=ROOT, env=os.environ | words,
        )  # fmt: skip
        assert done.stdout.split() == [expected], done.stderr


def test_the_list_holds_every_command() -> None:
    every = {name for module in {e.module for e in ENTRIES} for name in loaded(module)}
    assert every == {entry.name for entry in ENTRIES}


@pytest.mark.parametrize("room", ROOMS)
def test_the_names_loaded_on_demand_are_those_the_type_checker_sees(room: str) -> None:
    package = importlib.import_module(room)
    tree = ast.parse(Path(str(package.__file__)).read_text(encoding="utf-8"))
    checked = next(n for n in tree.body if isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING")
    seen = {
        alias.name: statement.module
        for statement in checked.body
        if isinstance(statement, ast.ImportFrom)
        for alias in statement.names
    }
    assert dict(package._modules_of_names) == seen
    assert set(package.__all__) - {"__version__"} == set(seen)
    assert dir(package) == sorted(package.__all__)


@pytest.mark.parametrize("room", ROOMS)
def test_every_public_name_loads(room: str) -> None:
    package = importlib.import_module(room)
    for name in package.__all__:
        assert getattr(package, name) is not None
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = package.no_such_name


@pytest.mark.long
def test_a_function_keeps_its_place_when_the_module_of_its_name_is_loaded() -> None:
    body = (
        "import identification, identification.identify, identification.mac, modalkit, modalkit.figures\n"
        "assert callable(identification.identify) and callable(identification.mac)"
    )
    modules_after(body)


@pytest.mark.long
def test_linear_algebra_that_is_loaded_late_keeps_to_one_thread() -> None:
    body = command("inspect", str(ROOT / "sample_data/beam_wet/beam_wet.uff"))
    check = "import scipy.linalg, threadpoolctl as t\nassert {i['num_threads'] for i in t.threadpool_info()} <= {1}"
    environment = (
        "import os\nfor n in list(os.environ):\n    if n.endswith('_NUM_THREADS'): del os.environ[n]\n"
    )
    modules_after(f"{environment}{body}\n{check}")


def test_a_foreign_module_under_the_name_of_a_room_is_refused(tmp_path: Path) -> None:
    (tmp_path / "acquisition.py").write_text("", encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(tmp_path)!r}); import modalkit"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode
    assert f"finds {tmp_path / 'acquisition.py'}; rename that file" in done.stderr


@pytest.mark.long
def test_what_runs_commands_in_forks_has_loaded_them_before() -> None:
    body = (
        "import runpy\nfrom modalkit.workers import server\nserver.serve_standard = lambda program: None\n"
        "runpy.run_module('modalkit.cli.warm', run_name='__main__')"
    )
    assert {"modalkit.batch.part", "updating.diagnosis.diagnose", "scipy.stats"} <= modules_after(body)
