"""Write the study file of a trial: what is stated, never what is hidden."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from modalkit.simulator.setup import Setup

Table = tuple[str, dict[str, Any]]
"""Header of a table, and its entries."""


def study_text(
    setup: Setup,
    *,
    test_file: str,
    baseline_file: str,
    expects_damping: bool = True,
    model: Mapping[str, Any] | None = None,
) -> str:
    """Return the study as TOML.

    Parameters
    ----------
    setup : Setup
        Everything that is stated.
    test_file, baseline_file : str
        Names of the test files, relative to the study: of hits, or, as ``.csv``, of modes; the second is used where
        there is a baseline.
    expects_damping : bool
        Whether the study states what damping the modeller expects.
    model : mapping, optional
        The study's ``[model]`` of a specimen whose matrices are files.

    Returns
    -------
    str
        A study as the contract has it.
    """
    test = _test_table(setup, test_file)
    tables: list[Table] = [("[test]", test)]
    if setup.baseline:
        tables.append(("[baseline]", test | _data(baseline_file)))
    tables.append(("[model]", _model_table(setup) if model is None else dict(model)))
    tables.append(("[model.material]", {"E": setup.E, "density": setup.density, "poisson": setup.poisson}))
    if expects_damping:
        tables.append(("[model.damping]", {"alpha": setup.alpha, "beta": setup.beta}))
    if model is not None:
        tables += _regions(model["stiffness_parts"])
    if setup.sensor_mass:
        tables.append(("[[model.mass]]", _sensor_table(setup)))
    tables.append(("[tolerances]", _tolerances_table(setup, of_files=model is not None)))
    if setup.environment is not None:
        tables.append(("[environment]", _environment_table(setup)))
    lines = [f"title = {_value(setup.title)}"]
    for header, entries in tables:
        lines += [header, *(f"{key} = {_value(value)}" for key, value in entries.items())]
    return "\n".join(lines) + "\n"


def _test_table(setup: Setup, file: str) -> dict[str, Any]:
    return {
        **_data(file),
        "band": list(setup.band),
        **({} if _of_modes(file) else {"exponential_window": setup.window}),
        "calibration": setup.calibration,
        "repeatability": setup.repeatability,
        "position_sigma": setup.position_sigma,
    }


def _model_table(setup: Setup) -> dict[str, Any]:
    """Return the ``[model]`` of a beam or a plate."""
    plate = setup.kind == "plate"
    return {
        "type": "plate" if plate else "beam",
        "length": setup.length,
        "width": setup.width,
        "thickness": setup.thickness,
        "elements": list(setup.elements) if plate else setup.elements[0],
        "clamped": list(setup.clamped),
        "theory": setup.theory,
    }


def _regions(files: Sequence[str]) -> list[Table]:
    """Return a region for each file of its stiffness, named as that is."""
    names = [Path(file).stem.removeprefix("stiffness_") for file in files]
    return [("[[model.region]]", {"name": name}) for name in names]


def _sensor_table(setup: Setup) -> dict[str, Any]:
    return {
        "at": list(setup.points[setup.sensor]),
        "mass": setup.sensor_mass,
        "inertia": setup.sensor_inertia,
    }


def _tolerances_table(setup: Setup, *, of_files: bool) -> dict[str, Any]:
    """Return all tolerances; of matrices in files, those that do not need an outline."""
    names = ("E", "density", "damping") if of_files else tuple(setup.tolerances.__dataclass_fields__)
    return {name: getattr(setup.tolerances, name) for name in names}


def _environment_table(setup: Setup) -> dict[str, Any]:
    borders = {"free_surface": setup.free_surface, "bottom": setup.bottom}
    known = {name: place for name, place in borders.items() if place is not None}
    return {"fluid_density": setup.environment, **known}


def _of_modes(file: str) -> bool:
    return file.endswith(".csv")


def _data(file: str) -> dict[str, Any]:
    """Return the key that names a test's data."""
    return {"modes": file} if _of_modes(file) else {"files": [file]}


def _value(value: Any) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    if isinstance(value, float):
        return repr(float(value))
    return str(value)
