"""What is wrong with a study file, in one line that states where."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

from pydantic import BaseModel, ValidationError

from modalkit.study.hypothesis_table import HypothesisTable
from modalkit.study.model_tables import DampingTable, MassTable, MaterialTable, ModelTable, RegionTable
from modalkit.study.tables import AxesTable, EnvironmentTable, MeasurementTable, TolerancesTable, UpdateTable


def explain(error: ValidationError, root: type[BaseModel]) -> str:
    """State in one line what is wrong and where."""
    parts = []
    for problem in error.errors()[:3]:
        place = ".".join(str(p) for p in problem["loc"])
        if problem["type"] == "extra_forbidden":
            known = known_keys(problem["loc"][:-1], root)
            meant = nearest(str(problem["loc"][-1]), known)
            parts.append(
                f"unknown key {place}" + (f"; known here: {', '.join(known)}{meant}" if known else "")
            )
        else:
            own = problem.get("ctx", {}).get("error")
            found = f", found {problem['input']!r}" if isinstance(problem["input"], str | int | float) else ""
            parts.append(f"{place or 'study'}: {problem['msg'].lower() + found if own is None else own}")
    return "; ".join(parts)


def nearest(word: str, known: Sequence[str]) -> str:
    """Return a question after the known word that a word looks like, nothing where it looks like none."""
    close = difflib.get_close_matches(word, known, n=1)
    return f" (is {close[0]!r} meant?)" if close else ""


def known_keys(place: tuple[int | str, ...], root: type[BaseModel]) -> list[str]:
    """Return the keys a table of the study may have."""
    tables: dict[tuple[str, ...], type[BaseModel]] = {
        (): root,
        ("test",): MeasurementTable,
        ("baseline",): MeasurementTable,
        ("test", "axes"): AxesTable,
        ("baseline", "axes"): AxesTable,
        ("model",): ModelTable,
        ("model", "material"): MaterialTable,
        ("model", "damping"): DampingTable,
        ("model", "mass"): MassTable,
        ("model", "region"): RegionTable,
        ("tolerances",): TolerancesTable,
        ("environment",): EnvironmentTable,
        ("update",): UpdateTable,
        ("hypothesis",): HypothesisTable,
    }
    table = tables.get(tuple(str(p) for p in place if not isinstance(p, int)))
    return [] if table is None else [n for n in table.model_fields if n != "path"]
