"""The submerged beam and plate of paper A with the water computed instead of fitted: every way of doing it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.linalg import eigh
from scipy.optimize import minimize_scalar

from acquisition.arrays import FloatArray
from modalkit.papers.a.chain import sample_folder
from modalkit.papers.a.joint import VARIANTS, joint_values
from modalkit.papers.a.printed import TABLES
from modalkit.papers.render import PaperTable
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from updating import Case
from updating.effects.structure.wetted import mass_within
from updating.environment import Environment
from updating.models.state import State
from updating.nominal import accepted_additions, predictor_of
from updating.prediction.baseline import correct
from updating.prediction.matching import pair_modes
from updating.prediction.predict import Predictor

WATER = 998.0
"""Density of water at 20 degrees [kg/m^3]."""

ABOVE, BELOW, LONG, BROAD = 0.18, 0.19, 0.55, 0.45
"""The paper's water above and below the structure and its tank, inside [m]."""

FACTOR = 0.782
"""The paper's factor on the dry plate's E, Table 3 [-]."""

BEAM_FACTOR = 0.7604
"""The same of the dry beam, Table 1 [-]."""

NOTES = (
    "From the published frequencies alone (modes.csv); r.m.s. of the relative errors. Nothing is fitted to a wet "
    "frequency: water of 998 kg/m3, the paper's sizes, the structure in the middle of the tank's side "
    "(that it is in the middle is an assumption).",
    "'measured dry': the model corrected to the dry test's frequencies, with the dry model's shapes. 'joint': clamp "
    "penetration, accelerometer and E from the dry beam and the dry plate together, in the three variants of the "
    "table 'joint'; what lies inside the clamp is not wet.",
    "'diagonal' leaves the coupling of the dry modes by the water out; 'coupled' keeps all of it. 'thin' is a plate "
    "without thickness. 'unbounded', 'free surface' and 'surface, bottom' are what the effect assumes where a study "
    "names no walls: the clamped edge stands at a wall that extends without end; in 'no wall' water flows round "
    "it.",
    "Modes are paired in order of frequency; shapes were not published.",
)


@dataclass(frozen=True)
class Start:
    """A dry model from which the wet frequencies are predicted.

    Parameters
    ----------
    name : str
        For the table.
    values : mapping of str to mapping, optional
        Accepted effects with their values; left out, the model is corrected to the dry test.
    """

    name: str
    values: Mapping[str, Mapping[str, float]] | None


def fluid_tables(folder: Path | str | None = None) -> list[PaperTable]:
    """Predict the wet frequencies of plate and beam in every way.

    Parameters
    ----------
    folder : path, optional
        Where the sample studies are; left out, those that come with the package.
    """
    home = Path(folder) if folder else sample_folder()
    dry = [open_study(read_study(home / n / "published.toml")).case for n in ("beam_dry", "plate_dry")]
    wet = [open_study(read_study(home / n / "published.toml")).case for n in ("beam_wet", "plate_wet")]
    joint = [joint_values(variant, dry) for variant in VARIANTS]
    beam, plate = ([_joint(v.name, j[i]) for v, j in zip(VARIANTS, joint, strict=True)] for i in (0, 1))
    measured = Start("measured dry", None)
    plate_starts = (_scaled(FACTOR), measured, *plate)
    beam_starts = (_scaled(BEAM_FACTOR), measured, *beam)
    return [
        _table("Table 4", "Plate in water, the water computed", wet[1], plate_starts, (7, 12)),
        _table("Table 2", "Beam in water, the water computed", wet[0], beam_starts, (3,)),
    ]


def _scaled(factor: float) -> Start:
    return Start(f"E x {factor:g}", {"E": {"factor": factor}})


def _joint(name: str, found: Mapping[str, float]) -> Start:
    values = {
        "E": {"factor": found["E"]},
        "length": {"extension": found["length"]},
        "sensor_mass": {"mass": found["sensor_mass"]},
    }
    return Start(f"joint, {name}", values)


def _table(
    number: str, title: str, case: Case, starts: Sequence[Start], counts: tuple[int, ...]
) -> PaperTable:
    rows, errors = [], []
    plain = predictor_of(case)
    for start in starts:
        predictor = _predictor(plain, case, start)
        for name, around in surroundings(case).items():
            for thickness in ("thin", "thick"):
                found = predict_wet(predictor, around, thick=thickness == "thick")
                wrong = [100 * (f[: counts[-1]] / case.measured.frequency - 1) for f in found]
                rows.append(_row(start.name, name, thickness, wrong, counts))
        errors.append({"variant": f"{start.name}; {name}, {thickness}, coupled", **_by_mode(wrong[1])})
    rows += _uniform(plain, case, counts)
    return PaperTable(
        "A", f"{number} by potential flow", title, pd.DataFrame(rows), pd.DataFrame(errors), NOTES
    )


def _row(
    start: str, around: str, thickness: str, wrong: Sequence[FloatArray], counts: tuple[int, ...]
) -> dict[str, object]:
    row: dict[str, object] = {"model": start, "variant": f"{around}, {thickness}"}
    for count in counts:
        for name, error in zip(("diagonal", "coupled"), wrong, strict=True):
            row[f"{name}, {count} modes [%]"] = _rms(error[:count])
    return row


def _by_mode(error: FloatArray) -> dict[str, float]:
    return {f"{mode} [%]": float(value) for mode, value in enumerate(error, start=1)}


def _rms(error: FloatArray) -> float:
    return float(np.sqrt(np.mean(np.square(error))))


def surroundings(case: Case) -> dict[str, Environment]:
    """Return the surroundings tried for a case, by name; the whole tank is the last."""
    middle = 0.0 if case.spec.kind == "beam" else 0.5 * case.spec.width
    sides = (middle - 0.5 * BROAD, middle + 0.5 * BROAD)
    free = float("inf")
    return {
        "no wall": Environment(WATER, walls=(-free, free, -free, free)),
        "unbounded": Environment(WATER),
        "free surface": Environment(WATER, free_surface=ABOVE),
        "surface, bottom": Environment(WATER, free_surface=ABOVE, bottom=BELOW),
        "tank": Environment(WATER, ABOVE, BELOW, (0.0, LONG, *sides)),
    }


def predict_wet(predictor: Predictor, around: Environment, *, thick: bool) -> tuple[FloatArray, FloatArray]:
    """Predict wet frequencies of a dry model.

    Parameters
    ----------
    predictor : Predictor
        The dry model.
    around : Environment
        The fluid and what bounds it.
    thick : bool
        Whether the fluid meets the structure's thickness.

    Returns
    -------
    diagonal, coupled : (n_modes,) arrays
        In ascending order, without and with the coupling of the dry modes by the fluid [Hz].
    """
    squared, vectors = predictor.reduced.eigen(predictor.base)
    unit = mass_within(predictor, around, thickness=None if thick else 0.0)[: len(squared), : len(squared)]
    added = WATER * (vectors.T @ unit @ vectors)
    alone = np.sort(squared / (1.0 + np.diag(added)))
    coupled = eigh(np.diag(squared), np.eye(len(squared)) + added, eigvals_only=True)
    return np.sqrt(alone) / (2 * np.pi), np.sqrt(coupled) / (2 * np.pi)


def _predictor(plain: Predictor, case: Case, start: Start) -> Predictor:
    """Return the dry model of a start, observed from the wet test, on the basis of the model without any."""
    if start.values is None:
        return plain.for_test(case.measured, (_corrected(case),))
    return plain.for_test(case.measured, accepted_additions(start.values.items()))


def _corrected(case: Case) -> Callable[[Predictor], State]:
    def build(predictor: Predictor) -> State:
        assert case.baseline is not None
        before = pair_modes(case.baseline, predictor.for_test(case.baseline, ()).predict())
        return correct(predictor.for_test(before.measured, ()), before.measured, before.order)

    return build


def _uniform(plain: Predictor, case: Case, counts: tuple[int, ...]) -> list[dict[str, object]]:
    """Return what the paper's one factor on the mass leaves, and what the best one could."""
    assert case.baseline is not None
    dry = {"nominal": plain.predict().frequency, "measured dry": case.baseline.frequency}
    rows = [_printed(case, counts)]
    for name, frequency in dry.items():
        row: dict[str, object] = {
            "model": name,
            "variant": "one factor on the mass, fitted to the modes counted",
        }
        for count in counts:
            ratio = frequency[:count] / case.measured.frequency[:count]
            best = minimize_scalar(lambda f, r=ratio: _rms(f * r - 1.0), bounds=(0.1, 1.0), method="bounded")
            row[f"coupled, {count} modes [%]"] = 100 * float(best.fun)
        rows.append(row)
    return rows


def _printed(case: Case, counts: tuple[int, ...]) -> dict[str, object]:
    """Return the r.m.s. of the paper's own updated column."""
    number = 2 if case.spec.kind == "beam" else 4
    printed = next(table for table in TABLES if table.number == number).models[0]
    errors = np.array([e for e in printed.after_error if e is not None])
    row: dict[str, object] = {"model": "paper", "variant": f"one factor, {printed.factor:g}, as printed"}
    return {**row, f"coupled, {counts[0]} modes [%]": _rms(errors)}
