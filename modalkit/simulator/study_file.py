"""Write the study file of a trial: what is stated, never what is hidden."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from modalkit.simulator.setup import Setup


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
    test: dict[str, Any] = {
        **_data(test_file),
        "band": list(setup.band),
        **({} if _of_modes(test_file) else {"exponential_window": setup.window}),
        "calibration": setup.calibration,
        "repeatability": setup.repeatability,
        "position_sigma": setup.position_sigma,
    }
    tolerances = {name: getattr(setup.tolerances, name) for name in setup.tolerances.__dataclass_fields__}
    regions: list[tuple[str, dict[str, Any]]] = []
    if model is not None:
        tolerances = {name: tolerances[name] for name in ("E", "density", "damping")}
        files = model["stiffness_parts"]
        names = [Path(file).stem.removeprefix("stiffness_") for file in files]
        regions = [("[[model.region]]", {"name": name}) for name in names]
    tables: list[tuple[str, dict[str, Any]]] = [("[test]", test)]
    if setup.baseline:
        tables.append(("[baseline]", test | _data(baseline_file)))
    built = {
        "type": "plate" if setup.kind == "plate" else "beam",
        "length": setup.length,
        "width": setup.width,
        "thickness": setup.thickness,
        "elements": list(setup.elements) if setup.kind == "plate" else setup.elements[0],
        "clamped": list(setup.clamped),
        "theory": setup.theory,
    }
    tables += [
        ("[model]", dict(built if model is None else model)),
        ("[model.material]", {"E": setup.E, "density": setup.density, "poisson": setup.poisson}),
        *([("[model.damping]", {"alpha": setup.alpha, "beta": setup.beta})] if expects_damping else []),
        *regions,
        ("[tolerances]", tolerances),
    ]
    if setup.sensor_mass:
        known = {
            "at": list(setup.points[setup.sensor]),
            "mass": setup.sensor_mass,
            "inertia": setup.sensor_inertia,
        }
        tables.insert(-1, ("[[model.mass]]", known))
    if setup.environment is not None:
        borders = {"free_surface": setup.free_surface, "bottom": setup.bottom}
        known_borders = {name: place for name, place in borders.items() if place is not None}
        tables.append(("[environment]", {"fluid_density": setup.environment, **known_borders}))
    lines = [f"title = {_value(setup.title)}"]
    for header, entries in tables:
        lines += [header, *(f"{key} = {_value(value)}" for key, value in entries.items())]
    return "\n".join(lines) + "\n"


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
