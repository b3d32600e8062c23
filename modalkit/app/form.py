"""The form of a study: a field for each key of model, test and tolerances, and how what is typed becomes the key."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from acquisition.errors import InputError

Kind = Literal["number", "choice", "file", "files", "several", "masses", "places"]

DRAWN = ("beam", "plate")
TYPES = {
    "beam": "beam",
    "plate": "plate",
    "calculix": "deck (CalculiX, Abaqus)",
    "matrices": "stiffness and mass matrices",
}
"""Types of a model, with their names in the form."""

SUFFIXES = (
    ".inp",
    ".mtx",
    ".npz",
    ".csv",
    ".op2",
    ".op4",
    ".pch",
    ".rb",
    ".hb",
    ".mat",
    ".sti",
    ".mas",
    ".dof",
)
"""Endings of files that are offered as deck, matrix or node table."""

MOST_FILES = 200
"""Files that are offered at the most [-]."""


@dataclass(frozen=True)
class FormField:
    """A key of the study with the way it is typed.

    Parameters
    ----------
    path : str
        Where it stands in the study: ``model.length``.
    label : str
        What it is called.
    group : {"model", "test", "tolerances"}
        Part of the form.
    kind : str
        How it is typed: a number, one of the choices, one file or several, several of the choices, a mass for each
        sensor (``5+Z: 8.6 g``), a place for each point (``1: 0, 0.1, 0``).
    unit : str
        Unit of a number typed without one, as it is shown.
    times : float
        What one of this unit is in the study's unit [study's unit].
    types : sequence of str
        Types of model that have it; empty is all.
    needed : bool
        Whether the model cannot be made without it.
    hint : str
        What is taken where it is left empty, or an example.
    choices : sequence of str
        What can be chosen.
    """

    path: str
    label: str
    group: Literal["model", "test", "tolerances"]
    kind: Kind = "number"
    unit: str = ""
    times: float = 1.0
    types: Sequence[str] = ()
    needed: bool = False
    hint: str = ""
    choices: Sequence[str] = ()


FORM = (
    FormField("model.length", "Length along x", "model", unit="mm", times=1e-3, types=DRAWN, needed=True),
    FormField("model.width", "Width along y", "model", unit="mm", times=1e-3, types=DRAWN, needed=True),
    FormField("model.thickness", "Thickness along z", "model", unit="mm", times=1e-3, types=DRAWN, needed=True),
    FormField("model.material.E", "Young's modulus E", "model", unit="GPa", times=1e9, types=DRAWN, needed=True),
    FormField("model.material.density", "Density", "model", unit="kg/m³", types=DRAWN, needed=True),
    FormField("model.material.poisson", "Poisson's ratio", "model", types=DRAWN, hint="0.3"),
    FormField("model.clamped", "Clamped ends", "model", "several", types=("beam",), choices=("x0", "x1")),
    FormField("model.clamped", "Clamped edges", "model", "several", types=("plate",), choices=("x0", "x1", "y0", "y1")),
    FormField("model.theory", "Theory", "model", "choice", types=("beam",),
              choices=("euler-bernoulli", "rayleigh", "timoshenko")),
    FormField("model.theory", "Theory", "model", "choice", types=("plate",), choices=("kirchhoff", "mindlin")),
    FormField("model.deck", "Deck", "model", "file", types=("calculix",), needed=True, hint="part.inp"),
    FormField("model.stiffness", "Stiffness matrix", "model", "file", types=("matrices",), needed=True, hint="K.mtx"),
    FormField("model.mass_matrix", "Mass matrix", "model", "file", types=("matrices",), needed=True, hint="M.mtx"),
    FormField("model.nodes", "Node table", "model", "file", types=("matrices",), hint="nodes.csv"),
    FormField("model.stiffness_parts", "Stiffness of each region", "model", "files", types=("matrices",),
              hint="K1.mtx, K2.mtx"),
    FormField("model.mass_parts", "Mass of each region", "model", "files", types=("matrices",), hint="M1.mtx, M2.mtx"),
    FormField("model.units", "Units of the files", "model", "choice", types=("calculix", "matrices"),
              choices=("m-kg-s", "mm-t-s", "in-lbf-s")),
    FormField("test.exponential_window", "Decay of an exponential window", "test", unit="1/s", hint="0"),
    FormField("test.sensor_masses", "Sensor masses", "test", "masses", hint="5+Z: 8.6 g, 7+Z: 10 g"),
    FormField("test.places", "Places of points [m], where no file states them", "test", "places",
              hint="1: 50 mm, 0, 0\n2: 100 mm"),
    FormField("test.calibration", "Calibration, relative", "test", hint="0.02"),
    FormField("test.repeatability", "Repeatability, relative", "test", hint="0.0005"),
    FormField("test.position_sigma", "Sigma of positions", "test", unit="mm", times=1e-3, hint="1"),
    FormField("tolerances.E", "E", "tolerances", hint="0.01"),
    FormField("tolerances.density", "Density", "tolerances", hint="0.003"),
    FormField("tolerances.thickness", "Thickness", "tolerances", types=DRAWN, hint="0.005"),
    FormField("tolerances.length", "Length", "tolerances", types=DRAWN, hint="0.002"),
    FormField("tolerances.width", "Width", "tolerances", types=DRAWN, hint="0.002"),
    FormField("tolerances.damping", "Damping", "tolerances", hint="0.3"),
)  # fmt: skip
"""Every field, in the order of the form."""


def form_page(folder: Path) -> dict[str, Any]:
    """Return the types of models, the fields, and the files beside the study that can be named in them."""
    names = sorted(
        path.name for path in folder.iterdir() if path.is_file() and path.suffix.lower() in SUFFIXES
    )
    return {"types": TYPES, "fields": [asdict(field) for field in FORM], "files": names[:MOST_FILES]}


def model_of(content: dict[str, Any], arguments: Mapping[str, Any]) -> str:
    """Put a model of a type, and what else the form states, into the tables of a study.

    Parameters
    ----------
    content : dict
        The tables, changed in place.
    arguments : mapping
        ``type``, and ``values``: what was typed, by the paths of the fields; an empty text leaves its key out.

    Raises
    ------
    InputError
        If there is no such type or field, one that is needed is empty, or one cannot be read.
    """
    kind = str(arguments["type"])
    if kind not in TYPES:
        raise InputError(f"there is no model of type {kind!r}; choose {', '.join(TYPES)}")
    typed = {str(path): value for path, value in dict(arguments["values"]).items()}
    fields = {field.path: field for field in FORM if kind in (field.types or (kind,))}
    if strange := [path for path in typed if path not in fields]:
        raise InputError(f"a {kind} has no {strange[0]}")
    empty = [field.label for path, field in fields.items() if field.needed and not typed.get(path)]
    if empty:
        raise InputError(
            f"{', '.join(empty)}: not stated yet; a {kind} needs {'it' if len(empty) == 1 else 'them'}"
        )
    content["model"] = {"type": kind}
    for path, value in typed.items():
        put(content, path, read(fields[path], value))
    return f"make a model: {TYPES[kind]}"


def put(content: dict[str, Any], path: str, value: Any) -> None:
    """Set a key by its path; None or an empty list leaves it out."""
    *tables, key = path.split(".")
    table = content
    for name in tables:
        if value in (None, [], {}) and name not in table:
            return
        table = table.setdefault(name, {})
    if value in (None, [], {}):
        table.pop(key, None)
    else:
        table[key] = value


def read(field: FormField, typed: Any) -> Any:
    """Return what was typed as the study writes it; a number without a unit is in the unit of its field.

    Raises
    ------
    InputError
        If it is not what the field takes.
    """
    if field.kind == "several":
        return [str(one) for one in typed]
    text = str(typed).strip()
    if not text:
        return None
    if field.kind == "files":
        return [name.strip() for name in text.split(",") if name.strip()]
    if field.kind in ("masses", "places"):
        entries = re.split(r"[\n;]", text) if field.kind == "places" else re.split(r"[\n;,]", text)
        return dict(_entry(field, entry) for entry in entries if entry.strip())
    return _number(text, field) if field.kind == "number" else text


def _number(text: str, field: FormField) -> float | str:
    """Return a number in the study's unit; a text with its own unit, or in that of the field, stays a text."""
    number = _float(text)
    if number is None:
        return text
    return number if field.times == 1.0 else f"{text} {field.unit}"


def _entry(field: FormField, entry: str) -> tuple[str, Any]:
    """Return point and mass, or point and place, of one entry of a list."""
    point, colon, rest = entry.partition(":")
    values = [part.strip() for part in rest.split(",")]
    most = 3 if field.kind == "places" else 1
    if not colon or not all(values) or len(values) > most:
        raise InputError(
            f"{field.label}: {entry.strip()!r} cannot be read; write {field.hint.splitlines()[0]}"
        )
    read_ = [value if (number := _float(value)) is None else number for value in values]
    return point.strip(), [*read_, 0.0, 0.0][:3] if field.kind == "places" else read_[0]


def _float(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
