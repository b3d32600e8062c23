"""Choose what is hidden on a setup that was drawn without knowing it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from acquisition.errors import StudyError
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.drawing.specimen import lacks_shear
from modalkit.simulator.hidden import HiddenEffect, Values, effects_of
from modalkit.simulator.setup import Setup

_MILD = (0.15, 0.5)
_STRONG = (1.5, 2.5)
_COUNTS = {"single": 1, "outside": 1, "pair": 2, "triple": 3}


def checked(plan: DrawRanges) -> DrawRanges:
    """Return the plan if the rig has all that it asks for.

    Parameters
    ----------
    plan : DrawRanges
        What may be drawn.

    Raises
    ------
    StudyError
        If a name is not one of the rig's.
    """
    known = _known(plan)
    missing = [name for name in plan.effects if name != "none" and name not in known]
    if missing:
        raise StudyError(f"the rig cannot hide {', '.join(missing)}; it has: none, {', '.join(known)}")
    return plan


def _known(plan: DrawRanges) -> dict[str, HiddenEffect]:
    """Return what may be hidden in any kind of specimen of a plan, by name."""
    return {name: effect for kind in reversed(plan.kinds) for name, effect in effects_of(kind).items()}


def choose_sort(rng: np.random.Generator, plan: DrawRanges) -> str:
    """Draw what sort of trial it is.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    plan : DrawRanges
        Shares, and the names to draw from.

    Returns
    -------
    {"none", "pair", "triple", "outside", "single"}
        Among named effects, those inside and outside the library are singles alike.
    """
    named = [n for n in plan.effects if n != "none"]
    inside = [n for n in named if not _known(plan)[n].outside]
    weights = {"none": plan.none, "pair": plan.pairs, "triple": plan.triples, "outside": plan.outside}
    if plan.effects:
        weights["none"] = (plan.none if named else 1.0) if "none" in plan.effects else 0.0
        weights["pair"] = plan.pairs if len(inside) > 1 else 0.0
        weights["triple"] = plan.triples if len(inside) > 2 else 0.0
        weights["outside"] = 0.0
    weights["single"] = 1.0 - sum(weights.values())
    sorts = list(weights)
    return sorts[int(rng.choice(len(sorts), p=np.maximum(list(weights.values()), 0.0)))]


def choose_hidden_effects(
    rng: np.random.Generator, setup: Setup, sort: str, plan: DrawRanges
) -> tuple[HiddenEffect, ...] | None:
    """Draw the effects of one sort that a setup can have.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    setup : Setup
        Drawn beforehand.
    sort : str
        From :func:`choose_sort`.
    plan : DrawRanges
        The names to draw from.

    Returns
    -------
    tuple of HiddenEffect or None
        In the order in which they act; None if the setup can have none of them. Those that fewer setups can
        have are preferred in proportion, so that all come up about as often; where the theory lacks shear that
        shows, shear is one of them.
    """
    if sort == "none":
        return ()
    every = list(effects_of(setup.kind).values())
    pool = [s for s in every if not plan.effects or s.name in plan.effects]
    if not plan.effects or sort in ("pair", "triple"):
        pool = [s for s in pool if s.outside == (sort == "outside")]
    pool = [s for s in pool if s.fits(setup)]
    chosen: list[HiddenEffect] = []
    forced = [s for s in pool if s.name == "shear" and lacks_shear(setup)]
    for _ in range(_COUNTS[sort]):
        free = forced or [s for s in pool if s not in chosen and not _clash(s, chosen)]
        if not free:
            return None
        weights = np.array([1.0 / s.share for s in free])
        chosen.append(free[int(rng.choice(len(free), p=weights / weights.sum()))])
        forced = []
    return tuple(sorted(chosen, key=every.index))


def _clash(hidden_effect: HiddenEffect, others: Sequence[HiddenEffect]) -> bool:
    return any(hidden_effect.exclusive and hidden_effect.exclusive == other.exclusive for other in others)


def draw_strength(rng: np.random.Generator, plan: DrawRanges) -> tuple[str, float]:
    """Draw how strong an effect is.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    plan : DrawRanges
        Shares of mild and strong ones.

    Returns
    -------
    level : {"mild", "clear", "strong"}
        In words.
    strength : float
        1 for a clear one; a mild one is 0.15 to 0.5, a strong one 1.5 to 2.5 [-].
    """
    level = str(
        rng.choice(["mild", "strong", "clear"], p=[plan.mild, plan.strong, 1 - plan.mild - plan.strong])
    )
    if level == "clear":
        return level, 1.0
    low, high = _MILD if level == "mild" else _STRONG
    return level, float(np.exp(rng.uniform(np.log(low), np.log(high))))


def right_answers(
    hidden_effects: Sequence[HiddenEffect],
    values: Sequence[Values],
    setup: Setup,
    without: Sequence[str] = (),
) -> tuple[tuple[str, ...], ...]:
    """Return every set of names that is a right answer.

    Parameters
    ----------
    hidden_effects, values : sequences
        What is hidden, and its parameters.
    setup : Setup
        On which it is.
    without : sequence of str
        Names that the diagnosis is not given.

    Returns
    -------
    tuple of tuple of str
        Each sorted; empty where nothing is hidden, and where the right answer is ``unknown``.
    """
    if not hidden_effects:
        return ()
    names = [
        (s.known_as, *s.equals(setup, v))
        for s, v in zip(hidden_effects, values, strict=True)
        if s.known_as is not None
    ]
    if len(names) < len(hidden_effects):
        return ()
    sets = dict.fromkeys(tuple(sorted(set(chosen))) for chosen in product(*names))
    return tuple(
        chosen
        for chosen in sets
        if len(chosen) == len(hidden_effects) and not any(name in without for name in chosen)
    )
