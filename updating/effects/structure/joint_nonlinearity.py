"""A joint whose stiffness depends on how hard the structure is hit."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, EitherSign, Parameter, Values, Variant, bending_stiffness
from updating.effects.box import Place
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.regions import centre_of, one_of
from updating.effects.structure.axial_load import buckling_load, unit_tension
from updating.effects.structure.clamp import unit_edges
from updating.effects.structure.joint import joint_springs, joints_of
from updating.effects.structure.length import clamped_places
from updating.models.state import NOMINAL, State
from updating.prediction.assignment import match
from updating.prediction.predict import Predictor

LARGEST, SMALLEST = 0.2, 1e-4
"""Range of the relative change of frequency between no force and the level of the test [-]."""

COMMON_LEVEL = 100.0
"""Level that stands in for one that is not known, where only the prior is listed [N]."""


ANYWHERE, TURNING, SHIFTING, STRETCHING = 0, 1, 2, 3
"""Which joint: an unknown one, a clamp in rotation or in translation, or two clamps that hold an end each."""

FREED: Mapping[int, Literal["rotation", "translation"]] = MappingProxyType(
    {TURNING: "rotation", SHIFTING: "translation"}
)
"""What a clamp gives way in."""

PROBE: Mapping[int, float] = MappingProxyType({TURNING: 300.0, SHIFTING: 2e4})
"""Stiffness of a clamp by which the slope is defined, over E I / L and E I / L^3: it gives way by some per cent of
frequency, as tests show it; where it gives way by less, shifts are a few per cent of themselves larger [-]."""

WORDS: Mapping[int, str] = MappingProxyType(
    {
        TURNING: " It is the clamp, which turns.",
        SHIFTING: " It is the clamp, which shifts.",
        STRETCHING: " It is the two clamps, between which bending stretches it.",
    }
)
"""Which joint it is, in a sentence."""

TIGHT = 0.01
"""Tension that moves frequencies in proportion, over the load that buckles the model [-]."""

UNNAMED = 0.25
"""Prior of an unknown joint, beside those that node sets name [-]: as beside clamps. Judged; doubled, the
named ones lose ln 1.5."""

SPREAD, OWN = 0.15, 0.05
"""How far modes differ in an unknown joint, and in one whose strain energy is computed, relative [-]."""


class JointNonlinearity(Effect):
    """A joint that softens (it slips) or stiffens (it closes) the harder the structure is hit.

    A clamp that softens holds as modelled at rest, and its compliance grows in proportion to the force; one that
    stiffens closes under the force, to which its stiffness is proportional. Between two clamps whose ends cannot
    approach each other a tension grows with the force. A joint of imported matrices, between two node sets, does either
    from the stiffness that it has there. Each mode's slope then follows from the joint's share of its
    own strain energy, d ln f / dF = phi^T (dK/dF) phi / 2 lambda. In an unknown joint all slopes are alike.

    ``slope`` is the mean over all modes up to the highest measured one, in proportion to the force from a clamp that
    gives way by some per cent of frequency, or from a joint as modelled: a mode that a test misses in between changes
    nothing.
    """

    name = "joint_nonlinearity"
    channel = "stiffness"
    summary = "A joint softens or stiffens with the force: frequencies follow the level of the hits."
    footprint = (
        "The frequencies of single hits change in proportion to their peak force, each mode by the joint's share of"
        " its strain energy. The slope is the mean over the modes up to the highest measured. The parameter joint is"
        " 1 for a clamp that turns, 2 for a clamp that shifts, 3 for stretching between two clamps, and 0 for an"
        " unknown joint, where all modes change alike. For imported matrices it is 1 or 2, and at names the joint."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ()
    named = ("at",)
    separated_by = "hits at each point over a wider range of levels, softest and hardest some 1 : 5"
    phrase = "a joint that is not linear"
    undone_by = frozenset({"unclamped"})
    fidelity = SPREAD
    of_supports = True

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the slope, and which joint."""
        level = predictor.measured.level or COMMON_LEVEL
        why = (
            f"from {100 * SMALLEST:g} to {100 * LARGEST:g} % over the level of the test, either sign; uniform in "
            "the logarithm of the size"
        )
        which = "not known, a clamp that turns or shifts, a stretch between clamps: a form each"
        return (
            EitherSign(
                "slope",
                "1/N",
                -LARGEST / level,
                LARGEST / level,
                why,
                least=SMALLEST / level,
                scale_doubt=predictor.measured.calibration,
            ),
            Parameter("joint", "-", ANYWHERE, STRETCHING, which, default=float(ANYWHERE), natural=EDGES),
        )

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from both signs, faint and plain."""
        return tuple((u, 0.5) for u in (0.1, 0.3, 0.7, 0.9))

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need hits of different levels."""
        test = predictor.measured
        if test.slope is not None and test.level and np.isfinite(test.slope).any():
            return None
        what = "this needs raw hits with force levels that span 2 : 1 at some points"
        return Obstacle(Lack.DATA, what)

    def fidelity_on(self, predictor: Predictor) -> float:
        """Return how far modes differ from what is predicted; less where clamps or joints may give way [-]."""
        return OWN if predictor.spec.clamped or _springs(predictor) else SPREAD

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return each joint that the structure has, and one that is not known."""
        clamped = set(predictor.spec.clamped)
        if springs := _springs(predictor):
            share = (1 - UNNAMED) / len(springs)
            named = (Variant({"joint": float(kind), "at": name}, share) for name, kind in springs)
            return (Variant({"joint": float(ANYWHERE)}, UNNAMED), *named)
        if not clamped:
            return (Variant({"joint": float(ANYWHERE)}),)
        shares = {ANYWHERE: 0.25, TURNING: 0.45, SHIFTING: 0.3}
        if {"x0", "x1"} <= clamped or {"y0", "y1"} == clamped:
            shares = {ANYWHERE: 0.2, TURNING: 0.3, SHIFTING: 0.2, STRETCHING: 0.3}
        return tuple(Variant({"joint": float(joint)}, share) for joint, share in shares.items())

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure at the level of the test, and its dependence on that."""
        joint, slope = round(values.get("joint", ANYWHERE)), values["slope"]
        level = predictor.measured.level or COMMON_LEVEL
        if joint in FREED and slope and "at" in values:
            return _worked(predictor, str(values["at"]), joint, slope, level)
        if joint == ANYWHERE or not slope or not predictor.spec.clamped:
            return State(slope=slope)
        if joint == STRETCHING:
            tension = slope / _tension_share(predictor) * unit_tension(predictor)
            return State(stiffness=(level * tension,), per_newton=(tension,))
        freed = FREED[joint]
        held = _compliance_share(predictor, joint) / (abs(slope) * level) * unit_edges(predictor, freed)
        return State(
            stiffness=(held,), released=frozenset({freed}), per_newton=(np.sign(slope) / level * held,)
        )

    def sentence(self, values: Values) -> str:
        """Return the summary, and which joint it is where that is known."""
        if "at" in values:
            moves = "turning" if round(values["joint"]) == TURNING else "shifting"
            return f"{self.summary} It is {values['at']}, in {moves}."
        return self.summary + WORDS.get(round(values.get("joint", ANYWHERE)), "")

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return which joint it is."""
        return {"joint": (float(round(values.get("joint", ANYWHERE))), "-")}

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the clamps where they are the joint, or the joint between two node sets."""
        if "at" in values:
            return (centre_of(one_of(joints_of(predictor), values, "at")),)
        return clamped_places(predictor) if round(values.get("joint", ANYWHERE)) in FREED else ()


def _compliance_share(predictor: Predictor, joint: int) -> float:
    """Return the mean relative fall of frequencies per compliance of a clamp.

    It is in N m where the clamp turns and in N/m where it shifts, on plates per metre of edge.
    """

    def build() -> FloatArray:
        spec = predictor.spec
        power = 1 if joint == TURNING else 3
        stiffness = PROBE[joint] * bending_stiffness(spec) / spec.length**power
        loose = State(
            stiffness=(stiffness * unit_edges(predictor, FREED[joint]),), released=frozenset({FREED[joint]})
        )
        return np.array(-stiffness * _mean_shift(predictor, loose))

    return float(predictor.once(f"gives way {joint}", build))


def _tension_share(predictor: Predictor) -> float:
    """Return by how much a tension raises frequencies, the mean over modes [1/N]."""

    def build() -> FloatArray:
        force = TIGHT * buckling_load(predictor)
        return np.array(_mean_shift(predictor, State(stiffness=(force * unit_tension(predictor),))) / force)

    return float(predictor.once("tightens", build))


def _springs(predictor: Predictor) -> tuple[tuple[str, int], ...]:
    """Return the joints of imported matrices by name, each with what it may give way in: where it has springs."""
    return tuple(
        (joint.name, kind)
        for joint in joints_of(predictor)
        for kind, stiffness in zip((SHIFTING, TURNING), joint.stiffness, strict=True)
        if stiffness
    )


def _worked(predictor: Predictor, name: str, kind: int, slope: float, level: float) -> State:
    """Return a joint between two node sets at the level of the test, and its dependence on that.

    Its compliance c, the modelled one times 1 + x, has x in proportion to the force F where it softens, and to 1/F
    where it closes: at the level d(1/c)/dF = -+ x / (c_0 F (1 + x)^2).
    """
    joint = one_of(joints_of(predictor), {"at": name}, "at")
    unit = joint_springs(predictor, joint, (SHIFTING, TURNING).index(kind))
    more = abs(slope) * level / _strain_share(predictor, name, kind, unit)
    return State(
        stiffness=((1 / (1 + more) - 1) * unit,),
        per_newton=(np.sign(slope) * more / level / (1 + more) ** 2 * unit,),
    )


def _strain_share(predictor: Predictor, name: str, kind: int, unit: FloatArray) -> float:
    """Return half of the strain energy that a joint's springs have of all, the mean over modes [-]."""

    def build() -> FloatArray:
        count = _count(predictor)
        found, before = (
            predictor.predict(state, count=count).slope for state in (State(per_newton=(unit,)), NOMINAL)
        )
        return np.array(np.mean(found - before))

    return float(predictor.once(f"strain energy of {name} {kind}", build))


def _count(predictor: Predictor) -> int:
    """Return how many modes there are up to the highest that was measured."""
    test = predictor.measured
    return 1 + int(match(test, predictor.predict(), np.arange(len(test.frequency)) + test.below).max())


def _mean_shift(predictor: Predictor, state: State) -> float:
    """Return the mean relative change over the lowest modes, up to the highest that was measured [-]."""
    count = _count(predictor)
    moved, plain = (predictor.predict(s, count=count).frequency for s in (state, NOMINAL))
    return float(np.mean(moved / plain - 1))
