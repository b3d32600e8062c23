"""A diagnosis as a colleague would write it: five lines that answer, then the tables."""

from __future__ import annotations

from updating import LIBRARY, Diagnosis


def letter(diagnosis: Diagnosis) -> list[str]:
    """Return five lines: what, where, how far, how sure, what next."""
    return [
        f"Cause:   {_cause(diagnosis)}",
        f"Where:   {_where(diagnosis)}",
        f"Closes:  {_closes(diagnosis)}",
        f"Sure:    {_sure(diagnosis)}",
        f"Next:    {_next(diagnosis)}",
    ]


def _cause(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == "none":
        return "no gap beyond tolerances and noise; there is nothing to explain"
    if diagnosis.verdict == "unknown":
        return (
            "unknown: the gap is real, and nothing in the library explains it, alone or in the pairs weighed"
        )
    names = [" + ".join(s) for s in diagnosis.sets]
    if diagnosis.verdict == "named":
        summary = " ".join(LIBRARY[n].summary for n in diagnosis.sets[0] if n in LIBRARY)
        return f"{names[0]}. {summary} {_values(diagnosis)}".strip()
    return "these data cannot tell apart: " + ", ".join(names)


def _values(diagnosis: Diagnosis) -> str:
    top = next((r for r in diagnosis.ranking if r.effects == diagnosis.sets[0]), None)
    if top is None or not top.parameters:
        return ""
    parts = [f"{name.split('.')[-1]} {e}" for name, e in top.parameters.items()]
    return "(" + "; ".join(parts) + ")"


def _where(diagnosis: Diagnosis) -> str:
    where = diagnosis.where
    if where.channel == "none":
        return "nowhere: every channel agrees"
    text = f"{where.channel} ({100 * where.channels[where.channel]:.0f} %)"
    if diagnosis.verdict == "unknown":
        return text + " is where the least bad explanations act; do not trust it"
    if where.location is not None:
        places = [f"x = {x:.3f} m" + (f", y = {y:.3f} m" if y else "") for x, y, _ in where.locations[:3]]
        text += ", at " + " and ".join(dict.fromkeys(places))
        text += f" (nearest test point {', '.join(map(str, where.points))})" if where.points else ""
    else:
        text += ", spread over the whole structure" if where.channel != "measurement" else ""
    return text


def _closes(diagnosis: Diagnosis) -> str:
    shrink = diagnosis.shrink
    if diagnosis.verdict == "none":
        return f"nothing to close; r.m.s. {shrink.metric} error {shrink.before:.3g} %, noise floor {shrink.floor:.2g} %"
    text = (
        f"r.m.s. {shrink.metric} error {shrink.before:.3g} % -> {shrink.after:.2g} % fitted, "
        f"{shrink.held_after:.2g} % on modes held out (noise floor {shrink.floor:.2g} %)"
    )
    others = [f"tolerances alone {shrink.held_nuisance:.2g} %"]
    if shrink.held_runner_up is not None:
        others.insert(0, f"runner-up {shrink.held_runner_up:.2g} %")
    text += "; held out, " + ", ".join(others)
    if shrink.closed is not None:
        c = shrink.closed
        text += f"; closes {c.value:.0f} % [{c.low95:.0f}, {c.high95:.0f}] of what can be closed"
    return text


def _sure(diagnosis: Diagnosis) -> str:
    chance = f"chance alone makes such a gap with p = {diagnosis.p_value:.1g}"
    if diagnosis.verdict in {"none", "unknown"}:
        return chance
    total = sum(r.probability for r in diagnosis.ranking if r.effects in diagnosis.sets)
    fit = max(r.p_value for r in diagnosis.ranking if r.effects in diagnosis.sets)
    rest = [r for r in diagnosis.ranking if r.effects not in diagnosis.sets]
    behind = f"; next {' + '.join(rest[0].effects)} {100 * rest[0].probability:.1g} %" if rest else ""
    return f"{100 * total:.1f} % of the probability{behind}; the fit has p = {fit:.2g}; {chance}"


def _next(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == "class" and diagnosis.next_test:
        test = diagnosis.next_test[0]
        return f"{test.measure}: separates {' from '.join(test.separates)} by {test.expected_sigma:.0f} sigma"
    if diagnosis.verdict == "class":
        ways = dict.fromkeys(LIBRARY[n].separated_by for n in diagnosis.effects if n in LIBRARY)
        return "; ".join(ways)
    if diagnosis.verdict == "named":
        tests = [LIBRARY[n].separated_by for n in diagnosis.sets[0] if n in LIBRARY]
        return "no rival is left to separate; to confirm: " + "; ".join(tests)
    if diagnosis.verdict == "unknown":
        return "look at the modes that miss most below; more points there, and a test of the bare specimen"
    return "nothing; the model may be used within its tolerances"
