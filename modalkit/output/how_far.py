"""How far an answer closes the gap, what it leaves, and how sure it is: two lines of the summary."""

from __future__ import annotations

import math

from acquisition.quantities import p_value, percent, probability
from updating import Diagnosis
from updating.diagnosis.answer.closing import Shrink
from updating.diagnosis.answer.in_no_library import SOMETHING_ELSE
from updating.effects import Lack
from updating.thresholds import BELIEVED_DOUBT

SHOWN = 4
"""So many parameters of a cause, and data that carry what it leaves, are shown."""


def closes(diagnosis: Diagnosis) -> str:
    """State how far the gap closes, on the data fitted and on those held out, and what is left."""
    shrink = diagnosis.shrink
    say = shrink.size
    what = (
        "misfit of all data"
        if shrink.metric == "combined"
        else f"{shrink.metric.replace('frf', 'FRF')} error"
    )
    if diagnosis.verdict == "none":
        size = percent(diagnosis.gap.rms_percent)
        allowed = f"no more than tolerances and noise allow{beneath(diagnosis)}"
        return f"nothing to close: frequencies differ by {size} r.m.s., {allowed}"
    who = "with the best-fitting (rejected) explanation, " if diagnosis.verdict == "unknown" else ""
    text = f"{who}r.m.s. {what} {say(shrink.before)} -> {say(shrink.after)} fitted"
    if not math.isfinite(shrink.held_after):
        why = (
            "with a single mode, none can be held out to check this"
            if len(diagnosis.gap.modes) == 1
            else "with a mode held out, the others do not determine it"
        )
        return f"{text} (noise floor {say(shrink.floor)}); {why}"
    text += f", {say(shrink.held_after)} on modes held out (noise floor {say(shrink.floor)})"
    others = [f"tolerances alone {say(shrink.held_nuisance)}" + _stretched(shrink)]
    if shrink.held_runner_up is not None:
        others.insert(0, f"runner-up {say(shrink.held_runner_up)}")
    text += "; held out, " + ", ".join(others)
    if shrink.points is not None:
        text += f"; on points held out {percent(shrink.points.before)} -> {percent(shrink.points.after)}"
    if shrink.closed is not None and diagnosis.verdict != "unknown":
        share = f"closes {shrink.closed} of the reducible gap"
        text += f"; {share if shrink.closed.determined else UNDETERMINED}"
    return text + _left(diagnosis)


def beneath(diagnosis: Diagnosis) -> str:
    """State what a theory neglects and no cause at all was given as well; nothing where that is nothing."""
    if not diagnosis.beneath:
        return ""
    most = percent(diagnosis.beneath)
    return (
        f" once shear and rotary inertia are counted, which the model neglects (up to {most} of a frequency)"
    )


def deviating(diagnosis: Diagnosis) -> str:
    """State which data were taken to be worse than stated, and by how much; nothing where none were."""
    left = diagnosis.remainder
    if left is None or not left.significant:
        return ""
    return f"{', '.join(left.carried_by[:SHOWN])} (up to {left.sigma:.0f} sigma)"


def _left(diagnosis: Diagnosis) -> str:
    """State what the answer leaves beyond noise, and where; nothing where it leaves nothing, or is none."""
    left = diagnosis.remainder
    if left is None or not left.significant or diagnosis.verdict in ("unknown", "none"):
        return ""
    where = ", ".join(left.carried_by[:SHOWN]) or "all data together"
    return f"; the remainder exceeds the noise: {left.sigma:.0f} sigma ({where})"


def _stretched(shrink: Shrink) -> str:
    if shrink.stretch <= BELIEVED_DOUBT:
        return ""
    digits = 1 if shrink.stretch < BELIEVED_DOUBT + 0.5 else 0  # 3.4 is no 3
    needed = f"to explain the gap they would have to be off by {shrink.stretch:.{digits}f} sigma"
    return f" (limited to {BELIEVED_DOUBT:g} sigma; {needed})"


UNDETERMINED = "the share of the gap that it closes is not determined (95 % interval: 0 to 100 %)"
"""In place of a share whose interval is not informative."""

UNREMARKABLE = 0.05
"""Chance of a gap from which its size is no evidence [-]: of one point, say, among many that agree. Doubled, hardly any
answer is worded otherwise."""


def sure(diagnosis: Diagnosis) -> str:
    """State how probable the answer is, how well it fits, and how often chance alone makes such a gap."""
    chance = f"without any cause, such a gap has {p_value(diagnosis.p_value)}"
    if diagnosis.verdict == "none":
        return f"{probability(without_cause(diagnosis))} probable that there is no cause; {chance}"
    if diagnosis.p_value >= UNREMARKABLE:
        chance += ", so the evidence is its pattern, not its size"
    if diagnosis.verdict == "unknown":
        return chance + _left_out(diagnosis)
    chosen = [row for row in diagnosis.ranking if row.effects in diagnosis.sets]
    total, fit = sum(row.probability for row in chosen), max(row.p_value for row in chosen)
    if (SOMETHING_ELSE,) in diagnosis.sets and (other := diagnosis.something_else) is not None:
        total += (1 - total) * other.probability
    rest = [row for row in diagnosis.ranking if row.effects not in diagnosis.sets]
    behind = f"; next {' + '.join(rest[0].effects)} {probability(rest[0].probability)}" if rest else ""
    what = "all other data fit" if _left(diagnosis) else "fits"
    fits = f"{what} within the noise" if fit >= 0.05 else "fits, but not well"
    together = f"{probability(total)} probable" + (" together" if len(diagnosis.sets) > 1 else "")
    return f"{together}{behind}; {fits} ({p_value(fit)}); {chance}"


def without_cause(diagnosis: Diagnosis) -> float:
    """Return the probability that there is no cause, some data set aside or none [-]."""
    return max(0.0, 1.0 - sum(row.probability for row in diagnosis.ranking))


def by_chance(diagnosis: Diagnosis) -> float:
    """Return the probability that tolerances and noise alone make the gap, no data set aside [-]."""
    aside = diagnosis.set_aside
    return max(0.0, without_cause(diagnosis) - (0.0 if aside is None else aside.probability))


def _left_out(diagnosis: Diagnosis) -> str:
    """State how many effects the data did not allow to examine: one of them may be it."""
    lacking = [why for why in diagnosis.not_examined.values() if why.lack is Lack.DATA]
    if not lacking:
        return ""
    return (
        f"; {len(lacking)} effect{'s' * (len(lacking) > 1)} could not be examined because data are "
        "missing (listed below)"
    )
