"""One trial diagnosed, as a row that JSON can carry."""

from __future__ import annotations

import time
import traceback
from collections.abc import Sequence
from typing import Any

import numpy as np

from acquisition.errors import ModalkitError
from diagnosis.hidden import CAUSES
from diagnosis.shrunk import overheard, truly_closed
from diagnosis.trial import Trial, draw_trial
from updating.diagnosis.answer.result import Diagnosis
from updating.diagnosis.diagnose import diagnose
from updating.effects import LIBRARY, Effect

PLACED = ("lumped_mass", "local_stiffness", "damping_patch", "position_error")
SHORTLIST = 8
NEAR = 0.05
"""A lumped mass so near the sensor is the sensor's, relative to the length [-]."""


def run_trial(
    seed: int, names: tuple[str, ...], index: int, *, kind: str | None = None, leave_out: bool = False
) -> dict[str, Any]:
    """Draw a trial, diagnose it, and return what is needed to score it."""
    row: dict[str, Any] = {"seed": seed, "names": names, "index": index, "left_out": leave_out, "asked": kind}
    try:
        trial = draw_trial(seed, names, index, kind=kind)
    except RuntimeError as error:
        return row | {"verdict": "undrawn", "error": str(error)}
    known = set(LIBRARY)
    right = [r for r in trial.right if set(r) <= known]
    spec = trial.specimen.spec
    row |= {
        "kind": spec.kind,
        "clamped": spec.clamped,
        "absolute": trial.specimen.rig.absolute,
        "baseline": trial.specimen.rig.baseline,
        "modes": len(trial.case.measured.frequency),
        "points": len(trial.specimen.rig.points),
        "severity": trial.severity,
        "size": round(trial.size, 3),
        "values": trial.values,
        "right": right,
    }
    start = time.perf_counter()
    try:
        with overheard() as kept:
            found = diagnose(trial.case, library=_library(trial) if leave_out else None)
    except (ModalkitError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        what = f"{type(error).__name__}: {error} ({where.filename.split('/')[-1]}:{where.lineno})"
        return row | {"verdict": "failed", "error": what, "sets": [], "seconds": time.perf_counter() - start}
    row |= {"seconds": round(time.perf_counter() - start, 2)} | _stated(trial, found)
    shrink = found.shrink
    closed = truly_closed(trial.case, trial.again, kept, shrink.metric, shrink.floor / 100)
    return row | {"truly_closed": closed}


def _library(trial: Trial) -> Sequence[Effect]:
    """Return the library without the hidden causes and what equals them."""
    gone = {n for r in trial.right for n in r} | set(trial.names)
    return [effect for name, effect in LIBRARY.items() if name not in gone]


def _stated(trial: Trial, found: Diagnosis) -> dict[str, Any]:
    top = found.ranking[0] if found.ranking else None
    row: dict[str, Any] = {
        "verdict": found.verdict,
        "sets": [list(s) for s in found.sets],
        "p_value": found.p_value,
        "ranking": [
            [list(r.effects), round(float(r.probability), 4), float(f"{r.p_value:.2g}")]
            for r in found.ranking[:SHORTLIST]
        ],
        "warnings": list(found.warnings),
        "closed": None if found.shrink.closed is None else found.shrink.closed.value,
        "metric": found.shrink.metric,
        "shrink": [found.shrink.before, found.shrink.held_after, found.shrink.floor],
        "location": found.where.location,
    }
    right = [sorted(r) for r in (*trial.right, *_at_the_sensor(trial, found))]
    row["right"] = right if set().union(*trial.right) <= set(LIBRARY) else []
    if top is None or sorted(top.effects) not in right:
        return row
    return row | _severity(trial, found)


def _at_the_sensor(trial: Trial, found: Diagnosis) -> list[tuple[str, ...]]:
    """Return the sets that name a lumped mass in place of the sensor's and put it where the sensor sits."""
    spec, rig = trial.specimen.spec, trial.specimen.rig
    swap = {"sensor_mass": "lumped_mass"}
    wanted = [sorted(swap.get(n, n) for n in r) for r in trial.right if "sensor_mass" in r]
    sets = []
    for row in found.ranking:
        axes = [row.parameters.get(f"lumped_mass.{axis}") for axis in ("x", "y")[: spec.dim]]
        at = [a.value for a in axes if a is not None]
        near = len(at) == spec.dim and np.linalg.norm(rig.points[rig.sensor] - at) < NEAR * spec.length
        if sorted(row.effects) in wanted and near:
            sets.append(tuple(row.effects))
    return sets


def _severity(trial: Trial, found: Diagnosis) -> dict[str, Any]:
    """Return which true parameters lie in their intervals, and how far the place is off."""
    estimates = found.ranking[0].parameters
    true: dict[str, float] = {n: v for n, v in trial.values.items() if isinstance(v, float)}
    soft = "local_stiffness"
    if f"{soft}.loss" in true:
        loss, extent = true.pop(f"{soft}.loss"), true.pop(f"{soft}.extent")
        true[f"{soft}.compliance"] = extent * loss / (1 - loss)
    vague = {f"{soft}.x", f"{soft}.y", "damping_patch.x", "damping_patch.y", "damping_patch.extent"}
    inside = {
        n: bool((estimates[n].low95 or 0.0) <= v <= (estimates[n].high95 or 0.0))
        for n, v in true.items()
        if n in estimates and n not in vague
    }
    stated = {n: [e.value, e.low95, e.high95] for n, e in estimates.items()}
    return {"covered": inside, "estimates": stated, "place_error": _place_error(trial, found)}


def _place_error(trial: Trial, found: Diagnosis) -> float | None:
    """Return how far the nearest named place is from the true one, over the span [-]; mirrored places count."""
    spec = trial.specimen.spec
    for name in PLACED:
        at = [trial.values.get(f"{name}.{axis}") for axis in ("x", "y")]
        if at[0] is None or not found.where.locations:
            continue
        true = np.array([at[0], at[1] or 0.0])
        named = np.array([p[:2] for p in found.where.locations])
        if spec.kind == "beam":
            named, true = named[:, :1], true[:1]
        span = float(np.hypot(spec.length, spec.width if spec.kind == "plate" else 0.0))
        return float(np.linalg.norm(named - true, axis=1).min() / span)
    return None


def all_causes() -> tuple[tuple[str, ...], ...]:
    """Return every single cause as a set, and none."""
    return ((), *((name,) for name in CAUSES))
