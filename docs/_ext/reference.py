"""Pages of reference, made from what they describe: commands, study file, effects, JSON, thresholds, public names."""

from __future__ import annotations

import ast
import dataclasses
import importlib
import inspect
import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from types import ModuleType
from typing import Any, Literal, get_args, get_origin

from json_fields import document_name, fields, in_words
from pydantic import BaseModel
from pydantic.fields import FieldInfo

ROOMS = ("modalkit", "acquisition", "identification", "updating")


def commands() -> str:
    """Return every command with its arguments and options, from the command line itself."""
    from modalkit.cli.on_demand import ENTRIES, loaded

    out = []
    for entry in ENTRIES:
        if entry.hidden:
            continue
        command = loaded(entry.module)[entry.name]
        arguments = [p for p in command.params if p.param_type_name == "argument"]
        options = [p for p in command.params if p.param_type_name == "option"]
        usage = " ".join(["modalkit", entry.name, *(_metavar(p) for p in arguments)])
        out += [
            f"## {entry.name}",
            "",
            f"```sh\n{usage}\n```",
            "",
            _paragraphs(command.help or entry.summary),
            "",
        ]
        rows = [(f"`{_metavar(p)}`", p.help or "") for p in arguments]
        rows += [(_option(p), p.help or "") for p in options]
        out += [_table(("argument, option", "meaning"), rows), ""]
    return "\n".join(out)


def _metavar(parameter: Any) -> str:
    name = str(parameter.name).upper()
    many = "..." if parameter.nargs == -1 else ""
    return f"{name}{many}" if parameter.required else f"[{name}{many}]"


def _option(parameter: Any) -> str:
    names = ", ".join(f"`{name}`" for name in [*parameter.opts, *parameter.secondary_opts])
    default = parameter.default
    plain = isinstance(default, int | float | str) and not isinstance(default, bool) and default != ""
    return f"{names} (`{default}`)" if plain else names


def _paragraphs(text: str) -> str:
    return inspect.cleandoc(text).replace("\b", "").replace("\f", "").replace("``", "`")


def study() -> str:
    """Return the tables of a study file with their keys, from the schema that reads them."""
    from modalkit.study import hypotheses, model_tables, read, tables
    from modalkit.study.read import Study

    out: list[str] = []
    told: dict[tuple[str, str], str] = {}
    for module in (tables, model_tables, read, hypotheses):
        told |= _attribute_docs(module)
    for header, model in _models("", Study):
        rows = [
            (f"`{name}`", _default(field), told[model.__name__, name] + _choices(field))
            for name, field in model.model_fields.items()
            if (model.__name__, name) in told
        ]
        if rows:
            out += [f"## {header or 'The file'}", "", _table(("key", "default", "meaning"), rows), ""]
    return "\n".join(out)


def _models(header: str, model: type[BaseModel]) -> Iterator[tuple[str, type[BaseModel]]]:
    yield header, model
    seen = set()
    for name, field in model.model_fields.items():
        inner = _inner(field)
        if inner is None or inner in seen:
            continue
        seen.add(inner)
        path = ".".join(part for part in (header.strip("[]`"), field.alias or name) if part)
        many = get_origin(field.annotation) in (list, tuple)
        yield from _models(f"`[[{path}]]`" if many else f"`[{path}]`", inner)


def _inner(field: FieldInfo) -> type[BaseModel] | None:
    """Return the table that a key holds, if it holds one."""
    candidates = [field.annotation, *get_args(field.annotation)]
    return next((c for c in candidates if isinstance(c, type) and issubclass(c, BaseModel)), None)


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "needed"
    value = field.get_default(call_default_factory=True)
    if value is None or isinstance(value, BaseModel):
        return ""
    return f"`{list(value) if isinstance(value, tuple) else value!r}`".replace("'", '"')


def _choices(field: FieldInfo) -> str:
    """Return the words that a key takes, where it takes some."""
    words = [
        w
        for a in (field.annotation, *get_args(field.annotation))
        if get_origin(a) is Literal
        for w in get_args(a)
    ]
    return " One of " + ", ".join(f'`"{word}"`' for word in words) + "." if words else ""


def _attribute_docs(module: ModuleType) -> dict[tuple[str, str], str]:
    """Return the sentences under the keys of each class of a module."""
    found = {}
    for node in ast.parse(inspect.getsource(module)).body:
        if not isinstance(node, ast.ClassDef):
            continue
        for item, after in pairwise(node.body):
            stated = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
            if isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name) and stated:
                text = inspect.cleandoc(after.value.value)  # type: ignore[attr-defined]
                found[node.name, item.target.id] = text.replace("``", "`").replace("\n", " ")
    return found


def effects() -> str:
    """Return the library of effects: a row for each, with sentences and priors below."""
    from modalkit.output.library import effects_document

    library = effects_document()["effects"]
    rows = [
        (f"[`{e['name']}`](#{e['name'].lower()})", e["channel"], ", ".join(e["models"]), _names(e))
        for e in library
    ]
    out = [_table(("effect", "acts on", "models", "mistaken for"), rows), ""]
    for effect in library:
        out += [f"## {effect['name']}", ""]
        out += [f"{effect['summary']} {effect['footprint']} *Separated by*: {effect['separated_by']}.", ""]
        priors = [(f"`{p['name']}`", _range(p), p["why"]) for p in effect["parameters"]]
        priors += [(f"`{label}`", "node numbers", "") for label in effect["labels"]]
        priors += [(f"`{label}`", "a name, on matrices and decks", "") for label in effect["names"]]
        if priors:
            out += [_table(("parameter", "prior", "why this range"), priors), ""]
    return "\n".join(out)


def _names(effect: dict[str, Any]) -> str:
    return ", ".join(f"`{name}`" for name in effect["equivalent_to"]) or "nothing"


def _range(parameter: dict[str, Any]) -> str:
    unit = "" if parameter["unit"] == "-" else f" {parameter['unit']}"
    return f"{parameter['low']:.3g} to {parameter['high']:.3g}{unit}" + (", log" if parameter["log"] else "")


def documents() -> str:
    """Return the JSON documents with their fields, from the classes to which what writes them is held."""
    from modalkit.output.schemas import DOCUMENTS

    out = []
    for document in DOCUMENTS:
        rows = [(f"`{f.path}`", in_words(f.kind), f.unit, f.sentence) for f in fields(document)]
        out += [f"## {document_name(document)}", "", _paragraphs(document.__doc__ or ""), ""]
        out += [_table(("field", "type", "unit", "meaning"), rows), ""]
    return "\n".join(out)


def rules() -> str:
    """Return what a verdict is decided by, from the docstring of the record that holds it."""
    from updating import DecisionRules

    text = inspect.getdoc(DecisionRules) or ""
    defaults = {one.name: one.default for one in dataclasses.fields(DecisionRules)}
    listed = text.partition("Parameters\n----------\n")[2].partition("\nRaises\n")[0]
    meanings = re.findall(r"^(\w+) : float\n((?:    .*\n)+)", listed, flags=re.MULTILINE)
    rows = [(f"`{name}`", f"`{defaults[name]:g}`", inspect.cleandoc(meaning)) for name, meaning in meanings]
    return (
        _table(("rule", "default", "what it limits, where it comes from, what doubling it does"), rows) + "\n"
    )


def thresholds() -> str:
    """Return the numbers of the noise and of the search, with the reasons that stand beside them."""
    module = importlib.import_module("updating.thresholds")
    source = inspect.getsource(module)
    out: list[str] = []
    body = ast.parse(source).body
    headings = {
        number: text.strip()
        for number, line in enumerate(source.splitlines(), 1)
        if (text := re.sub(r"^# -+", "", line)) != line
    }
    rows: list[tuple[str, ...]] = []
    for item, after in pairwise(body):
        if not isinstance(item, ast.Assign) or not isinstance(after, ast.Expr):
            continue
        for number in [n for n in sorted(headings) if n < item.lineno]:
            out, rows = _closed(out, rows)
            out += [f"## {headings.pop(number).capitalize()}", ""]
        name = item.targets[0].id  # type: ignore[attr-defined]
        text = inspect.cleandoc(after.value.value)  # type: ignore[attr-defined]
        rows.append((f"`{name}`", f"`{getattr(module, name)}`", text.replace("``", "`").replace("\n", " ")))
    return "\n".join(_closed(out, rows)[0])


def _closed(out: list[str], rows: list[tuple[str, ...]]) -> tuple[list[str], list[tuple[str, ...]]]:
    return [
        *out,
        _table(("name", "value", "what it limits, where it comes from, what doubling it does"), rows),
        "",
    ] if rows else out, []


def api(room: str) -> str:
    """Return the public names of a room, each documented where it is defined."""
    module = importlib.import_module(room)
    own, others = [], []
    for name in module.__all__:
        thing = getattr(module, name)
        home = getattr(thing, "__module__", room) or room
        (own if home.split(".")[0] == room else others).append((name, thing))
    lines = ["```{eval-rst}", f".. currentmodule:: {room}", ""]
    for name, thing in own:
        lines += [*_directive(room, name, thing), ""]
    lines.append("```")
    table = [(f"`{name}`", f"{{py:obj}}`{_home(thing)}.{name}`") for name, thing in others]
    head = [_table((f"in `{room}`", "described under"), table), ""] if table else []
    return "\n".join([*head, *lines])


def names(room: str) -> str:
    """Return a table of the public names of a room with what each is in a sentence."""
    module = importlib.import_module(room)
    rows = []
    for name in module.__all__:
        thing = getattr(module, name)
        own = inspect.isclass(thing) or inspect.isroutine(thing) or isinstance(thing, ModuleType)
        text = (inspect.getdoc(thing) or "").split("\n\n")[0] if own else ""
        signature = f"`{name}{'()' if inspect.isroutine(thing) else ''}`"
        if text:
            rows.append((signature, text.replace("``", "`")))
    return _table(("name", "what it is"), rows)


def _home(thing: object) -> str:
    return str(getattr(thing, "__module__", "")).split(".")[0]


def _directive(room: str, name: str, thing: object) -> list[str]:
    if isinstance(thing, ModuleType):
        return []
    if inspect.isclass(thing):
        return [f".. autoclass:: {room}.{name}", "   :members:"]
    if callable(thing):
        return [f".. autofunction:: {room}.{name}"]
    return [f".. py:data:: {room}.{name}"]


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join("| " + " | ".join(_cell(c) for c in line) + " |" for line in lines)


def _cell(text: str) -> str:
    return re.sub(r"\s+", " ", text).replace("|", "\\|")


MAKERS: dict[str, Callable[[], str]] = {
    "commands": commands,
    "study": study,
    "effects": effects,
    "documents": documents,
    "rules": rules,
    "thresholds": thresholds,
    **{f"api {room}": (lambda room=room: api(room)) for room in ROOMS},
    **{f"names {room}": (lambda room=room: names(room)) for room in ROOMS},
}
"""What ``<!-- made: NAME -->`` on a page stands for."""
