"""The commands by name: what each does in a line, and the module that is loaded when it is asked for."""

from __future__ import annotations

import functools
import importlib
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup

from acquisition.errors import InputError
from modalkit.cli.arguments import check_words, options_of, words_of


@dataclass(frozen=True)
class Entry:
    """A command that is not loaded yet.

    Parameters
    ----------
    name : str
        As it is typed.
    module : str
        In ``modalkit.cli``; its ``add_commands`` adds the command.
    summary : str
        First line of the command's docstring; a test holds it so.
    options : str
        Its options and how many values each takes, ``--band 2, --check``; a test holds them, too.
    hidden : bool
        Whether the list of commands leaves it out.
    """

    name: str
    module: str
    summary: str
    options: str = ""
    hidden: bool = False


ENTRIES = (
    Entry(
        "inspect",
        "measuring",
        "List the content of a file, and its faults.",
        "--decay 1, --layout 1, --all, --write-layout 1",
    ),
    Entry(
        "frf",
        "measuring",
        "Estimate FRFs with coherence from hits, and write them as UFF.",
        "--output -o 1, --decay 1, --window-on 1, --window 1, --estimator 1, --use 1, --leave 1, "
        "--layout 1, --sensor-mass 1, --figures 1",
    ),
    Entry(
        "identify",
        "measuring",
        "Identify frequencies, damping and mode shapes with uncertainties, or show existing modes.",
        "--band 2, --order 1, --add 1, --drop 1, --decay 1, --window-on 1, --window 1, "
        "--frf-window 1, --estimator 1, --use 1, --leave 1, --layout 1, --sensor-mass 1, --json 1, "
        "--output -o 1, --check, --report 1, --figures 1",
    ),
    Entry(
        "correlate",
        "compare",
        "Pair the modes of test and model, or of two tests, and show how well they agree, FRFs included.",
        "--json 1, --figures 1",
    ),
    Entry(
        "localise",
        "localising",
        "Rank the regions of the model by how far the test contradicts them, by several methods.",
        "--method 1, --kind 1, --json 1, --figures 1",
    ),
    Entry(
        "tables",
        "compare",
        "Recompute the tables of two papers from the sample data, beside the published values.",
        "--paper 1, --format 1, --output -o 1, --fluid, --figures 1",
    ),
    Entry(
        "update",
        "updating",
        "Update the parameters that the study lists for updating, by frequencies or by FRFs.",
        "--shared 1, --bootstrap 1, --seed 1, --json 1, --report 1, --figures 1",
    ),
    Entry(
        "diagnose",
        "diagnosing",
        "Find where the gap between test and model lies, what causes it, and how far it closes.",
        "--shared 1, --without 1, --rules 1, --json 1, --report 1, --figures 1",
    ),
    Entry(
        "effects",
        "diagnosing",
        "List the effects of the library, with priors, signatures and the tests that separate them.",
        "--json 1, --table",
    ),
    Entry(
        "simulate",
        "simulating",
        "Simulate a hammer test of a study's model, with effects added.",
        "--output -o 1, --effect 1, --seed 1, --frfs, --hits 1, --samples 1, --rate 1, "
        "--noise 1, --points 1, --remount, --figures 1",
    ),
    Entry(
        "blind",
        "blinding",
        "Hide effects in simulated tests, diagnose these blind, and score the answers.",
        "--trials 1, --seed 1, --workers 1, --scheduler 1, --store 1, --resume, --kinds 1, "
        "--effects 1, --leave-out, --real, --data 1, --check 1, --json 1, --markdown 1, "
        "--report 1, --figures 1",
    ),
    Entry(
        "batch",
        "batching",
        "Identify, update and diagnose a folder of studies, and write modes, factors and causes as tables.",
        "--output -o 1, --workers 1, --scheduler 1, --resume, --json-dir 1",
    ),
    Entry(
        "part",
        "batching",
        "Work out one study of a batch.",
        "--json 1",
        hidden=True,
    ),
    Entry(
        "app",
        "serving",
        "Open the app on this machine: pick poles, watch shapes, compare with the model, diagnose.",
        "--no-browser, --port 1, --layout 1",
    ),
    Entry(
        "demo",
        "demonstrate",
        "Run the main job on shipped data: hits to modes to the cause of the gap.",
        "--figures 1",
    ),
)


class CommandsOnDemand(TyperGroup):
    """The group of all commands; the module of one is loaded when the command is typed, none for the list."""

    def __init__(self, **attributes: Any) -> None:
        """Fill the list with what is known of each command without loading it."""
        super().__init__(**attributes)
        for entry in ENTRIES:
            self.add_command(TyperCommand(entry.name, help=entry.summary, hidden=entry.hidden))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Load the command that is typed, unless a word behind it is wrong already."""
        for entry in ENTRIES:
            if entry.name == args[0]:
                words = None if ctx.resilient_parsing else words_of(args[1:], options_of(entry.options))
                if words is not None:
                    check_words(words)
                self.commands.update(loaded(entry.module))
        return super().resolve_command(ctx, args)


def load_all() -> None:
    """Load the modules of all commands, as a process does that is to run many of them in forks."""
    for module in {entry.module for entry in ENTRIES}:
        _module(module)


def loaded(module: str) -> dict[str, Any]:
    """Return the commands of a module by name, which refuse numbers that are not finite."""
    group = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    _module(module).add_commands(group)
    found = typer.main.get_command(group)
    commands = found.commands if isinstance(found, TyperGroup) else {str(found.name): found}
    for command in commands.values():
        names = {parameter.name: parameter.opts[0] for parameter in command.params if parameter.name}
        command.callback = _finite_only(command.callback, names)
    return dict(commands)


def _module(name: str) -> Any:
    return importlib.import_module(f"modalkit.cli.{name}")


def _finite_only(run: Callable[..., Any] | None, names: dict[str, str]) -> Callable[..., Any]:
    """Return a command that refuses options that are no finite number, for no range of an option does."""
    assert run is not None

    @functools.wraps(run)
    def checked(**values: Any) -> Any:
        for name, value in values.items():
            for number in _numbers(value):
                if not math.isfinite(number):
                    raise InputError(f"{names.get(name, name)} {number}: not a finite number; give one")
        return run(**values)

    return checked


def _numbers(value: Any) -> Iterator[float]:
    """Yield the floating-point numbers in an option's value."""
    if isinstance(value, float):
        yield value
    elif isinstance(value, Iterable) and not isinstance(value, str | bytes):
        for one in value:
            yield from _numbers(one)
