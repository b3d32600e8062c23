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
    hidden : bool
        Whether the list of commands leaves it out.
    """

    name: str
    module: str
    summary: str
    hidden: bool = False


ENTRIES = (
    Entry("inspect", "measuring", "List what is in a file, and what is wrong with it."),
    Entry("frf", "measuring", "Turn hits into FRFs with coherence, and write them as UFF."),
    Entry(
        "identify",
        "measuring",
        "Identify frequencies, damping and mode shapes, with their uncertainties; show modes that exist already.",
    ),
    Entry(
        "correlate",
        "compare",
        "Pair the modes of test and model, or of two tests, and say how far they agree, FRFs included.",
    ),
    Entry(
        "tables",
        "compare",
        "Make the papers' tables through the whole chain, our value beside the published one.",
    ),
    Entry(
        "update",
        "updating",
        "Update the parameters named in the study's update table, by eigenvalues or by FRFs.",
    ),
    Entry(
        "diagnose",
        "diagnosing",
        "Say where the gap between test and model lies, what causes it, and how far it closes.",
    ),
    Entry(
        "effects",
        "diagnosing",
        "List the effects that can be named, with priors, footprints and what separates them.",
    ),
    Entry("simulate", "simulating", "Make a synthetic hammer test of a study's model, with effects in it."),
    Entry(
        "blind",
        "blinding",
        "Hide effects in simulated rigs, diagnose them without telling, and score the answers.",
    ),
    Entry(
        "batch",
        "batching",
        "Identify, update and diagnose a folder of studies, and write modes, factors and causes as tables.",
    ),
    Entry("part", "batching", "Work out one study of a batch.", hidden=True),
    Entry(
        "app",
        "serving",
        "Open the app on this machine: pick poles, watch shapes, compare with the model, diagnose.",
    ),
    Entry("demo", "demonstrate", "Run the main job on shipped data: hits to modes to the cause of the gap."),
)


class CommandsOnDemand(TyperGroup):
    """The group of all commands; the module of one is loaded when the command is typed, none for the list."""

    def __init__(self, **attributes: Any) -> None:
        """Fill the list with what is known of each command without loading it."""
        super().__init__(**attributes)
        for entry in ENTRIES:
            self.add_command(TyperCommand(entry.name, help=entry.summary, hidden=entry.hidden))

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Load the command that is typed."""
        for entry in ENTRIES:
            if entry.name == args[0]:
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
