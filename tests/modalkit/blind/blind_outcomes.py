"""Outcomes of blind trials made by hand, for the tests of the score."""

from __future__ import annotations

from typing import Any

import numpy as np

from modalkit.blind import BlindResult, DrawRanges, Outcome, Truth, seal
from modalkit.blind.answer import read_answer
from modalkit.blind.shrunk import Shrinkage

OUTSIDE = ("ground_spring", "taper")
ALSO = {"sensor_mass": ("lumped_mass",), "exponential_window": ("uniform_damping",)}


def diagnosis(verdict: str, *sets: tuple[str, ...], **more: Any) -> dict[str, Any]:
    """Return a diagnosis; ``others`` are rows beyond the answer, ``shares`` the probabilities of all rows."""
    rows = [*sets, *more.get("others", ())]
    shares = more.get("shares") or [2.0 ** -(i + 1) for i in range(len(rows))]
    ranking = [
        {
            "effects": list(row),
            "probability": share,
            "equivalents": [],
            "parameters": more.get("parameters", {}) if i == 0 else {},
            "plausible": True,
            "fit_p_value": more.get("fit", 0.5),
        }
        for i, (row, share) in enumerate(zip(rows, shares, strict=True))
    ]
    return {
        "schema": "modalkit.diagnosis/1",
        "p_value": more.get("p_value", 1e-9),
        "where": {
            "channel": more.get("channel", "none"),
            "channels": {},
            "location": None,
            "locations": more.get("locations", []),
        },
        "cause": {
            "verdict": verdict,
            "sets": [list(s) for s in sets] if verdict in ("named", "class") else [],
            "ranking": ranking,
        },
        "shrink": {
            "metric": "frequency",
            "held_out": {"before_percent": 5.0, "after_percent": 0.5, "noise_floor_percent": 0.1},
            "closed_percent": more.get("closed"),
        },
    }


def interval(value: float, low: float, high: float) -> dict[str, Any]:
    """Return an estimate as a diagnosis writes it."""
    return {"value": value, "unit": "-", "low95": low, "high95": high, "at_bound": False}


def truth(*effects: str, visibility: float = 10.0, **more: Any) -> Truth:
    """Return what is hidden; parameters of a single effect by their short names."""
    fields = (
        "kind",
        "without",
        "accepted",
        "level",
        "size",
        "places",
        "baseline",
        "calibrated",
        "left_visible",
    )
    parameters = {f"{effects[0]}.{k}": v for k, v in more.items() if k not in fields}
    unknowable = any(name in OUTSIDE for name in effects) or "without" in more
    also = ALSO.get(effects[0], ()) if len(effects) == 1 else ()
    accepted = () if unknowable or not effects else (tuple(sorted(effects)), *((name,) for name in also))
    return Truth(
        kind=more.get("kind", "beam"),
        effects=effects,
        parameters=parameters,
        accepted=more.get("accepted", accepted),
        in_library=not any(name in OUTSIDE for name in effects),
        without=more.get("without", ()),
        severity=1.0 if effects else 0.0,
        level=more.get("level", "clear" if effects else "none"),
        visibility=visibility if effects else 0.0,
        size=more.get("size", (0.5,)),
        places=more.get("places", ()),
        baseline=more.get("baseline", False),
        calibrated=more.get("calibrated", True),
        gap_percent=2.0,
        left_visible=more.get("left_visible", visibility if unknowable and effects else None),
    )


def outcome(
    index: int, hidden: Truth, message: dict[str, Any] | None, shrinkage: Shrinkage | None = None
) -> Outcome:
    """Return an opened trial; None is a diagnosis that failed."""
    return Outcome(
        index=index,
        truth=hidden,
        answer=None if message is None else read_answer(message),
        document=message,
        failure="EstimationError: broken" if message is None else None,
        sealed=seal(hidden.to_json()),
        seconds=0.1,
        shrinkage=shrinkage,
    )


def run_of(*pairs: tuple[Truth, dict[str, Any] | None], seed: int = 7) -> BlindResult:
    """Return a run of trials."""
    return BlindResult(seed, DrawRanges(), tuple(outcome(i, *pair) for i, pair in enumerate(pairs)))


NAMES = (
    *("E", "density", "thickness", "length", "clamp_rotation", "sensor_mass", "local_stiffness", "shear"),
    *(
        "fluid_added_mass",
        "exponential_window",
        "calibration_gain",
        "polarity",
        "axial_load",
        "damping_patch",
    ),
)


def honest_run(trials: int, seed: int, *, leave_out: bool = False) -> BlindResult:
    """Return a run whose probabilities are honest: the truth is drawn from the probabilities that are stated."""
    rng = np.random.default_rng(seed)
    return BlindResult(seed, DrawRanges(), tuple(_honest(i, rng, leave_out=leave_out) for i in range(trials)))


def _honest(index: int, rng: np.random.Generator, *, leave_out: bool) -> Outcome:
    kind = rng.choice(["effect", "pair", "outside", "none"], p=[0.63, 0.1, 0.15, 0.12])
    names = [str(name) for name in rng.permutation(NAMES)]
    shares = np.sort(rng.dirichlet(np.full(len(names), 0.1)))[::-1]
    drawn = int(rng.choice(len(names), p=shares))
    rows = [(name,) for name in names]
    if kind == "none":
        message = diagnosis("none", others=rows, shares=list(0.2 * shares), p_value=rng.random())
        return outcome(index, truth(), message)
    if kind == "outside" or (leave_out and kind == "effect"):
        wrong = rng.random() < 0.3
        message = diagnosis(
            "named" if wrong else "unknown",
            *(rows[:1] if wrong else ()),
            others=rows[1:] if wrong else rows,
            shares=list(shares),
            fit=0.02 * rng.random(),
        )
        hidden = truth(OUTSIDE[index % 2]) if kind == "outside" else truth(names[0], without=(names[0],))
        return outcome(index, hidden, message)
    if kind == "pair":
        rows[drawn] = tuple(sorted((names[drawn], names[drawn - 1])))
    size = int(np.searchsorted(np.cumsum(shares), 0.95)) + 1
    x, true = 0.5 * rng.random(), float(np.exp(rng.normal()))
    error = 0.05 * rng.normal()
    value = true * (1 + error)
    message = diagnosis(
        "named" if size == 1 else "class",
        *rows[:size],
        others=rows[size:],
        shares=list(shares),
        fit=rng.random(),
        channel="stiffness",
        parameters={f"{names[drawn]}.size": interval(value, value - 0.1 * true, value + 0.1 * true)},
        locations=[[x + 0.01 * rng.normal(), 0, 0], [0.5 - x, 0, 0]],
        closed=interval(90 + 3 * rng.normal(), 84, 96),
    )
    hidden = truth(*rows[drawn], visibility=float(np.exp(rng.normal(2.5, 1))), places=((x,),), size=(0.5,), **(
        {"level": str(rng.choice(["mild", "clear", "strong"])), "kind": str(rng.choice(["beam", "plate"]))}
        | ({} if kind == "pair" else {"accepted": (rows[drawn],)})
    ))  # fmt: skip
    if kind != "pair":
        hidden = replace_parameters(hidden, {f"{names[drawn]}.size": true})
    return outcome(index, hidden, message, Shrinkage("frequency", 5.0, 5.0 * np.sqrt(0.1), 5.0, 2.0))


def replace_parameters(hidden: Truth, parameters: dict[str, Any]) -> Truth:
    """Return a truth with other parameters."""
    return Truth.from_json(hidden.to_json() | {"parameters": parameters})
