"""The page of an update: values in the unit of the study, bounds, and the decisive warning first."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from modalkit.app.typed_units import parameter_rows, unit_as_typed
from modalkit.app.work import update

CONTENT: dict[str, Any] = {
    "model": {
        "thickness": "0.125 inch",
        "material": {"E": "70 GPa", "density": 2700.0},
        "region": [{"name": "root", "E": "10 Mpsi"}, {"name": "tip"}],
        "effect": [{"name": "sensor_mass", "mass": "8.6 g"}],
    }
}


@pytest.mark.parametrize(
    ("name", "unit", "shown", "times"),
    [
        ("E", "Pa", "GPa", 1e9),
        ("root.E", "Pa", "Mpsi", 6.894757293168e9),
        ("tip.E", "Pa", "GPa", 1e9),
        ("thickness", "m", "inch", 0.0254),
        ("density", "kg/m^3", "kg/m^3", 1.0),
        ("sensor_mass.mass", "kg", "g", 1e-3),
        ("length.extension", "m", "mm", 1e-3),
        ("axial_load.force", "N", "N", 1.0),
    ],
)
def test_the_unit_is_that_of_the_study(name: str, unit: str, shown: str, times: float) -> None:
    found = unit_as_typed(CONTENT, name, unit)
    assert found[0] == shown
    assert found[1] == pytest.approx(times)


def test_a_row_states_value_sigma_range_and_the_end_that_it_stands_at() -> None:
    one = {"name": "E", "unit": "Pa", "initial": 70e9, "value": 67.6554e9, "sigma": 3.1e8, "factor": 0.966506}
    row, bound = parameter_rows(
        CONTENT,
        [
            one | {"low": 35e9, "high": 140e9, "at_bound": False},
            one | {"low": 35e9, "high": 67.6554e9, "at_bound": True},
        ],
    )
    assert [row[key] for key in ("initial", "value", "sigma", "unit", "factor")] == [
        "70", "67.6554", "0.31", "GPa", "0.966506",
    ]  # fmt: skip
    assert (row["bounds"], row["at_bound"], bound["at_bound"]) == ("35 to 140", "no", "upper")


def test_what_stands_at_a_bound_is_stated_first(beam: Path, tmp_path: Path) -> None:
    text = beam.read_text(encoding="utf-8").replace("E = 210e9", 'E = "210 GPa"')
    beam.write_text(text.replace("E = 0.01\n", "E = 0.01\nbounds = { E = [0.9, 1.1] }\n"), encoding="utf-8")
    found = update(beam, tmp_path, lambda stage: None)
    (row,) = found["rows"]
    assert (row["value"], row["unit"], row["at_bound"]) == ("189", "GPa", "lower")
    assert "E ended at a bound" in found["document"]["warnings"][0]
    assert all(pair["used"] for pair in found["document"]["pairs"])
