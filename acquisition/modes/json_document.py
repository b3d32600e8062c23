"""Modes from a JSON file of our own schema, ``modalkit.modes/1``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.geometry import Geometry
from acquisition.json_keys import check_keys, check_same_keys, once
from acquisition.modal_data import ModalData

SCHEMA = "modalkit.modes/1"
_KEYS = ("schema", "modes", "points_rejected", "hits", "window_decay_removed", "warnings", "nodes")
_OF_MODE = (
    "frequency_hz", "frequency_sigma_hz", "damping_ratio", "damping_sigma", "shape", "mpc", "scaled",
)  # fmt: skip
_OF_ENTRY = ("node", "direction", "re", "im", "sigma")


def read_modes_json(path: Path | str) -> ModalData:
    """Read the modes that ``identify --json`` wrote.

    Parameters
    ----------
    path : path
        The file.

    Raises
    ------
    InputError
        If it cannot be read, is of another schema, or an entry is not what it should be.
    """
    path = Path(path)
    return _modal(_document(path), path)


def _modal(document: Mapping[str, Any], path: Path) -> ModalData:
    modes = [
        _mapping(m, f"{path}: mode {n}") for n, m in enumerate(_list(document, "modes", str(path)), start=1)
    ]
    check_keys(document, _KEYS, str(path))
    check_same_keys(modes, f"{path}: modes")
    if not modes:
        raise InputError(f"{path}: contains no modes; identify with a band that contains some")
    check_keys(modes[0], _OF_MODE, f"{path}: mode 1")
    shapes = [_shape(mode, f"{path}: mode {n}") for n, mode in enumerate(modes, start=1)]
    dofs = tuple(shapes[0])
    odd = next((n for n, shape in enumerate(shapes, start=1) if set(shape) != set(dofs)), None)
    if odd is not None:
        raise InputError(
            f"{path}: mode {odd} has other degrees of freedom than mode 1; give all modes the same"
        )
    values = np.array([[shape[dof] for shape in shapes] for dof in dofs]).reshape(len(dofs), len(modes), 3)
    errors = values[..., 2]
    frequency, frequency_sigma, damping, damping_sigma = (
        _column(modes, key, path, needed=key == _OF_MODE[0]) for key in _OF_MODE[:4]
    )
    nodes, places = _nodes(document, path)
    try:
        return ModalData(
            frequency=frequency,
            frequency_sigma=frequency_sigma,
            damping=damping,
            damping_sigma=damping_sigma,
            dofs=dofs,
            shapes=values[..., 0] + 1j * values[..., 1] if dofs else None,
            shape_sigma=errors if dofs and not np.isnan(errors).all() else None,
            scaled=bool(dofs) and all(mode.get("scaled") is True for mode in modes),
            geometry=Geometry(nodes, places) if nodes else Geometry.empty(),
        )
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _document(path: Path) -> Mapping[str, Any]:
    try:
        document = json.loads(path.read_bytes(), object_pairs_hook=once)
    except OSError as error:
        raise InputError(f"{path}: cannot be opened ({error.strerror}); check the path") from None
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{path}: is not JSON ({type(error).__name__}); write it with identify --json"
        ) from None
    schema = document.get("schema") if isinstance(document, Mapping) else None
    if schema != SCHEMA:
        found = f"of schema {str(schema)[:40]!r}" if schema else "without a schema"
        raise InputError(
            f"{path}: is JSON {found}; modes are of schema {SCHEMA!r}, as identify --json writes them"
        )
    return dict(document)


def _shape(mode: Mapping[str, Any], where: str) -> dict[Dof, tuple[float, float, float]]:
    """Return real part, imaginary part and sigma of each component, directions positive."""
    shape: dict[Dof, tuple[float, float, float]] = {}
    entries = [_mapping(entry, f"{where}: shape") for entry in _list(mode, "shape", where)]
    check_same_keys(entries, f"{where}: shape")
    for part in entries:
        check_keys(part, _OF_ENTRY, f"{where}: shape")
        node, direction = (_whole(part, key, where) for key in ("node", "direction"))
        dof, sign = Dof(node, abs(direction)), -1.0 if direction < 0 else 1.0
        if abs(direction) > 6 or dof in shape:
            fault = "is given twice" if dof in shape else "is none"
            raise InputError(f"{where}: node {node}, direction {direction} {fault}; directions are -6 to 6")
        re, im = (sign * _number(part, key, where, needed=True) for key in ("re", "im"))
        shape[dof] = re, im, _number(part, "sigma", where)
    return shape


def _nodes(document: Mapping[str, Any], path: Path) -> tuple[tuple[int, ...], FloatArray]:
    """Return the numbers and the places [m] of the nodes of the document, where it has any."""
    where = f"{path}: nodes"
    nodes = [_mapping(node, where) for node in _list(document, "nodes", str(path))]
    places = [[_number(node, axis, where, needed=True) for axis in "xyz"] for node in nodes]
    return tuple(_whole(node, "node", where) for node in nodes), np.array(places)


def _column(modes: list[Mapping[str, Any]], key: str, path: Path, *, needed: bool = False) -> FloatArray:
    return np.array(
        [_number(m, key, f"{path}: mode {n}", needed=needed) for n, m in enumerate(modes, start=1)]
    )


def _list(document: Mapping[str, Any], key: str, where: str) -> list[Any]:
    value = document.get(key, [])
    if not isinstance(value, list):
        raise InputError(f"{where}: {key} is not a list; write the file with identify --json")
    return value


def _mapping(value: Any, where: str) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise InputError(f"{where}: {str(value)[:40]!r} is not a record; write the file with identify --json")
    return value


def _whole(document: Mapping[str, Any], key: str, where: str) -> int:
    value = document.get(key)
    if type(value) is not int or abs(value) >= 2**31:
        raise InputError(f"{where}: {key} = {str(value)[:40]} is not a whole number; correct it")
    return value


def _number(document: Mapping[str, Any], key: str, where: str, *, needed: bool = False) -> float:
    """Return a number; nan for null or nothing, unless it is needed."""
    value = document.get(key)
    if value is None and not needed:
        return math.nan
    try:
        number = float(value) if isinstance(value, int | float) and not isinstance(value, bool) else math.inf
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(f"{where}: {key} = {str(value)[:40]} is not a finite number; correct it")
    return number
