"""One trial: a specimen, what is hidden in it, how clearly it shows, and the case that a diagnosis sees."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from diagnosis.hidden import CAUSES, HYSTERETIC, STIFF, Cause, Scene, Values
from diagnosis.observe import Faults, Truth, draw_marks, measure, truth_of
from diagnosis.solve import Solved, solve
from diagnosis.specimen import Specimen, draw_specimen, with_rig
from updating import Case, Measured

CONDITIONS = ((True, False), (True, True), (True, False), (True, True), (False, None))
"""Whether levels are absolute and whether there is a baseline, in turn; None is every other time."""

MILD_EVERY = 4
ATTEMPTS = 12
LARGEST, LARGEST_WET = 0.4, 1.2
"""No effect moves the frequencies by more than this, a fluid by more than that, r.m.s. of the logarithms [-]."""

STRONGER = 2.5
"""How much more clearly each of two effects must show, so that neither explains the other away [-]."""

SAME_MASS = ("E", "density", "thickness")
"""What only the absolute level tells apart."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trial:
    """What is hidden, and the case.

    Parameters
    ----------
    names : tuple of str
        Hidden causes; empty for none.
    values : dict
        Their parameters by ``cause.parameter`` [SI].
    severity : str
        none, mild or clear.
    size : float
        Change of the data over what makes a gap clear [-].
    right : tuple of tuples of str
        Sets of names that are right answers; empty for none and where the library lacks the cause.
    case, again : Case, Measured
        What is diagnosed, and a second test of the same specimen for checking predictions.
    """

    names: tuple[str, ...]
    values: Values
    severity: str
    size: float
    right: tuple[tuple[str, ...], ...]
    case: Case
    again: Measured
    specimen: Specimen


def draw_trial(seed: int, names: tuple[str, ...], index: int, *, kind: str | None = None) -> Trial:
    """Draw a trial; the same arguments always give the same one.

    Parameters
    ----------
    seed, index : int
        Of the run, and of the trial among those of these causes.
    names : tuple of str
        Causes to hide.
    kind : str, optional
        beam or plate; left out, in turn where the causes admit both.
    """
    key = zlib.crc32("+".join(names).encode())
    kinds = [k for k in ("beam", "plate") if all(k in CAUSES[n].kinds for n in names)]
    kind = kind or kinds[index % len(kinds)]
    rng = np.random.default_rng([seed, key, index, kind == "plate"])
    absolute, baseline = CONDITIONS[index % len(CONDITIONS)]
    absolute = absolute or any(CAUSES[n].level for n in names)
    baseline = bool(index // len(CONDITIONS) % 2) if baseline is None else baseline
    mild = bool(names) and (index // len(CONDITIONS)) % MILD_EVERY == MILD_EVERY - 1 and len(names) == 1
    for attempt in range(ATTEMPTS):
        causes = [_form(rng, CAUSES[n]) for n in names]
        clamps = [c.clamped for c in causes if c.clamped is not None]
        specimen = draw_specimen(
            rng, kind, thick="shear" in names, absolute=absolute,
            baseline=baseline and "shear" not in names, clamped=clamps[0] if clamps else None,
        )  # fmt: skip
        if any(c.shows == "slope" for c in causes):
            specimen = with_rig(specimen, span=max(specimen.rig.span, 2.5))
        found = _hide(rng, specimen, causes, mild=mild)
        if found is not None or attempt == ATTEMPTS - 1:
            break
    if found is None:
        raise RuntimeError(f"no specimen in which {names} shows as it should")
    scene, values, size, before, after = found
    return _trial(rng, scene, causes, values, size, before, after)


def _form(rng: np.random.Generator, cause: Cause) -> Cause:
    if cause.name != "uniform_damping" or rng.random() < 0.4:
        return cause
    return STIFF if rng.random() < 0.5 else HYSTERETIC


def _hide(
    rng: np.random.Generator, specimen: Specimen, causes: list[Cause], *, mild: bool
) -> tuple[Scene, Values, float, Solved, Solved] | None:
    """Put the causes in, as strong as they should be; None where this specimen does not show them so."""
    before = solve(specimen.body)
    if not causes:
        return Scene(specimen), {}, 0.0, before, before
    plain = _true(specimen, before, Faults())
    values: Values = {}
    scene, size, total = Scene(specimen), np.inf, before
    for cause in causes:
        strength = 0.3 if mild else STRONGER ** (len(causes) > 1)
        for _ in range(4):
            drawn = cause.draw(rng, specimen, strength)
            alone = cause.act(Scene(specimen), drawn)
            after = before if alone.specimen is specimen else solve(alone.specimen.body)
            changed = _true(alone.specimen, after, alone.faults)
            shows = _size(cause, specimen, plain, changed, after, drawn)
            shows /= STRONGER ** (len(causes) > 1)
            if _fits(shows, mild=mild) and not _too_much(cause, plain, changed):
                break
            strength *= 1.6 if shows < (0.2 if mild else 1.0) else 0.6
        else:
            return None
        scene = cause.act(scene, drawn)
        values |= {f"{cause.name}.{n}": v for n, v in drawn.items()}
        size = min(size, shows)
        total = after
    if len(causes) > 1:
        total = solve(scene.specimen.body)
    return scene, values, float(size), before, total


def _fits(shows: float, *, mild: bool) -> bool:
    return 0.2 <= shows < 1.0 if mild else shows >= 1.0


def _true(specimen: Specimen, solved: Solved, faults: Faults) -> Truth:
    none = np.zeros_like(specimen.rig.points), np.zeros(specimen.rig.points.shape[1])
    return truth_of(specimen, solved, faults, specimen.scatter, none)


def _too_much(cause: Cause, plain: Truth, changed: Truth) -> bool:
    most = LARGEST_WET if cause.name == "fluid_added_mass" else LARGEST
    return bool(np.sqrt(np.mean(np.log(changed.frequency / plain.frequency) ** 2)) > most)


def _size(cause: Cause, s: Specimen, plain: Truth, changed: Truth, after: Solved, values: Values) -> float:
    """Return how far a cause moves what shows it, over what makes a gap clear [-].

    A clear gap is 1 % in frequency, and for a factor on everything 3.5 times what tolerances allow where no
    baseline removes them; three times the doubt in damping, calibration, or shapes; 0.1 rad of phase; five sigma
    of a slope.
    """
    rig = s.rig
    if cause.name == "shear":
        from updating.models import build_structure

        thin = build_structure(s.spec)
        count = min(rig.modes, len(after.omega))
        values_, _ = thin.eigen(thin.rigid_modes + count)
        own = np.sqrt(values_[thin.rigid_modes :]) / after.omega[:count]
        return float(np.std(np.log(own)) / 0.01)
    if cause.shows == "frequency":
        moved = np.sqrt(np.mean(np.log(changed.frequency / plain.frequency) ** 2))
        return float(
            moved
            / (
                max(0.01, 3.5 * _tolerance(s))
                if cause.name in (*SAME_MASS, "length") and not rig.baseline
                else 0.01
            )
        )
    if cause.shows == "damping":
        doubt = rig.remounted_damping if rig.baseline else s.tolerances.damping
        return float(
            np.sqrt(np.mean(np.log(changed.damping / plain.damping) ** 2))
            / (3 * np.hypot(doubt, rig.damping_noise))
        )
    if cause.shows == "level":
        factor = values.get("gain") or 1 / values["factor"]
        doubt = rig.calibration if not rig.baseline else rig.noise
        width = (
            0.0
            if rig.baseline
            else np.hypot(s.tolerances.factors["width"], s.tolerances.factors["thickness"])
        )
        return float(abs(np.log(factor)) / max(0.05, 3.5 * np.hypot(doubt, width)))
    if cause.shows == "phase":
        return float(2 * np.pi * plain.frequency.max() * abs(values["delay"]) / 0.1)
    if cause.shows == "slope":
        sigma = rig.frequency_noise / (rig.level * (rig.span - 1) / (rig.span + 1))
        return float(abs(values["slope"]) / (5 * sigma)) if rig.span >= 2 else 0.0
    change = np.abs(changed.constants - plain.constants) / np.sqrt(
        np.mean(np.abs(plain.constants) ** 2, axis=0)
    )
    step = np.hypot(rig.noise, 3 * rig.position_sigma * np.pi * 3 / s.spec.length)
    return float(np.sqrt(np.mean(np.sort(change, axis=0)[-1] ** 2)) / (5 * step))


def _tolerance(s: Specimen) -> float:
    """Return the relative doubt in all frequencies together [-]."""
    t = s.tolerances.factors
    return float(
        np.sqrt(t["E"] ** 2 / 4 + t["density"] ** 2 / 4 + t["thickness"] ** 2 + 4 * t["length"] ** 2)
    )


def _trial(
    rng: np.random.Generator, scene: Scene, causes: list[Cause], values: Values, size: float,
    before: Solved, after: Solved,
) -> Trial:  # fmt: skip
    specimen = scene.specimen
    marks = draw_marks(rng, specimen.rig)
    scatter = specimen.scatter[: len(after.omega)]
    test, again = (measure(specimen, after, scene.faults, marks, rng, scatter) for _ in range(2))
    baseline = None
    if specimen.rig.baseline:
        old = replace(specimen, body=before.body)
        baseline = measure(old, before, Faults(), marks, rng, scatter)
    case = Case(
        "simulated",
        specimen.spec,
        test,
        baseline=baseline,
        tolerances=specimen.tolerances,
        environment=specimen.environment,
    )
    names = tuple(c.name for c in causes)
    severity = "none" if not names else "clear" if size >= 1 else "mild"
    return Trial(
        names=names,
        values=values,
        severity=severity,
        size=size,
        right=_right(causes, specimen),
        case=case,
        again=again,
        specimen=specimen,
    )


def _right(causes: list[Cause], specimen: Specimen) -> tuple[tuple[str, ...], ...]:
    if not causes or not all(c.inside for c in causes):
        return ()
    each = []
    for cause in causes:
        equals: tuple[str, ...] = (cause.name, *cause.equals)
        if cause.name in SAME_MASS and not specimen.rig.absolute:
            equals = SAME_MASS
        each.append(equals)
    return tuple(dict.fromkeys(tuple(sorted(set(names))) for names in product(*each)))
