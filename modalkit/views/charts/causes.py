"""Which explanations, how probable, and how far each closes the gap."""

from __future__ import annotations

from dataclasses import dataclass

from acquisition.display import counted
from acquisition.quantities import bare_p, probability
from modalkit.output.how_far import by_chance, without_cause
from modalkit.output.words import METRICS, parameters, short
from modalkit.views.chart import Axis, Chart, Series
from updating import Diagnosis

ROWS = 10
"""Most explanations drawn; the table has more [-]."""

LEAST = 1e-4
"""What is less is drawn as that, on a logarithmic axis [%]."""


@dataclass(frozen=True)
class Bar:
    """One bar: its name, its parameters in words, its probability, and whether it is the answer."""

    label: str
    detail: str
    probability: float
    answer: bool


def explanations(diagnosis: Diagnosis) -> list[Bar]:
    """Return the rows: those of the answer, then the rest by probability, with the tolerances among them."""
    chosen = set(diagnosis.sets)
    none = diagnosis.verdict == "none"
    aside = diagnosis.set_aside
    alone = without_cause(diagnosis) if none else by_chance(diagnosis)
    rows = [Bar("tolerances and noise alone", "", alone, none)]
    if aside is not None and not none:
        rows.append(Bar("no cause", str(aside), aside.probability, False))
    for row in diagnosis.ranking:
        detail = parameters(row) if row.effects in chosen or row.probability >= 0.01 else ""
        if row.p_value < diagnosis.rules.rejected_fit and not none:
            detail = "does not fit"
        rows.append(Bar(short(row.effects), detail, row.probability, row.effects in chosen))
    return sorted(rows, key=lambda row: (not row.answer, -row.probability))


def rivals(diagnosis: Diagnosis) -> list[tuple[str, float, bool]]:
    """Return (name, gap on held-out modes [%], whether it is the best explanation) from worst to best known."""
    shrink, ranking = diagnosis.shrink, diagnosis.ranking
    rows = [("the unchanged model", shrink.held_before, False)]
    rows.append(("tolerances alone", shrink.held_nuisance, False))
    if shrink.held_runner_up is not None:
        name = short(ranking[1].effects) if len(ranking) > 1 else "the runner-up"
        rows.append((f"runner-up: {name}", shrink.held_runner_up, False))
    if ranking:
        rows.append((short(ranking[0].effects), shrink.held_after, diagnosis.verdict != "none"))
    return rows


def causes_chart(diagnosis: Diagnosis) -> Chart:
    """Return the probability of each explanation, those of the answer in blue."""
    found = explanations(diagnosis)
    rows = found[:ROWS]
    fits = {short(r.effects): r.p_value for r in diagnosis.ranking}
    text = [
        "\n".join(
            [
                row.label,
                f"probability {probability(row.probability)}",
                *([f"fits with p = {bare_p(fits[row.label])}"] if row.label in fits else []),
                *([row.detail] if row.detail else []),
            ]
        )
        for row in rows
    ]
    series = Series(
        "probability",
        "bars",
        [100 * row.probability for row in rows],
        list(range(len(rows))),
        "faint",
        {"text": text, "colours": ["blue" if row.answer else "faint" for row in rows], "unnamed": True},
    )
    return Chart(
        "causes",
        _title(diagnosis),
        f"Blue: the answer.{f' {len(found) - ROWS} more are less probable.' if len(found) > ROWS else ''}",
        Axis("probability [%]", range=(0.0, 100.0)),
        Axis(names=tuple(row.label for row in rows)),
        [series],
    )


def _title(diagnosis: Diagnosis) -> str:
    """Say who holds the probability."""
    chosen = [r for r in diagnosis.ranking if r.effects in diagnosis.sets]
    rest = [r for r in diagnosis.ranking if r.effects not in diagnosis.sets]
    behind = f"; the next, {short(rest[0].effects)}, {probability(rest[0].probability)}" if rest else ""
    if diagnosis.verdict == "none":
        alone = without_cause(diagnosis)
        return f"Tolerances and noise alone hold {probability(alone)} of the probability"
    if diagnosis.verdict == "unknown" or not chosen:
        return f"None of the {len(diagnosis.ranking)} explanations compared is the answer"
    total = probability(sum(r.probability for r in chosen))
    if len(chosen) == 1:
        name = short(chosen[0].effects)
        return f"{name[:1].upper()}{name[1:]} holds {total} of the probability{behind}"
    return f"{counted(len(chosen), 'explanation')} hold {total} together{behind}"


def closing_chart(diagnosis: Diagnosis) -> Chart:
    """Return the gap on modes held out for the answer and its rivals, the floor of the noise as a band."""
    shrink, rows = diagnosis.shrink, rivals(diagnosis)
    whole = 100.0 if shrink.metric == "combined" else 1.0
    unit = "σ" if shrink.metric == "combined" else "%"
    known = [i for i, row in enumerate(rows) if row[1] == row[1]]
    held = [max(rows[i][1], LEAST) / whole for i in known]
    floor = max(shrink.floor, LEAST) / whole
    text = [f"{rows[i][0]}\non modes held out: {shrink.size(rows[i][1])}" for i in known]
    low = min([*held, floor, max(shrink.after, LEAST) / whole]) / 2
    series = [
        Series(
            f"noise of the test, {shrink.size(shrink.floor)}", "bands", [], list(range(len(rows))), "band",
            {"low": [low] * len(rows), "high": [floor] * len(rows)},
        ),
        Series("on modes held out", "points", held, known, "blue", {"text": text, "size": 6}),
    ]  # fmt: skip
    if diagnosis.ranking:
        inside = {
            "hollow": True,
            "size": 6,
            "text": [f"{rows[-1][0]}\non fitted data: {shrink.size(shrink.after)}"],
        }
        series.append(
            Series(
                "on fitted data", "points", [max(shrink.after, LEAST) / whole], [len(rows) - 1], "ink", inside
            )
        )
    return Chart(
        "closing",
        _closes(diagnosis),
        "Each mode predicted from all others (dots), and on the data that were fitted (ring). The band is noise."
        + _by_tolerances(diagnosis),
        Axis(f"{METRICS[shrink.metric]} gap, r.m.s. [{unit}]", log=True),
        Axis(names=tuple(name for name, _, _ in rows)),
        series,
        more={"row": 34, "notes": [shrink.size(size) for _, size, _ in rows]},
    )


def _by_tolerances(diagnosis: Diagnosis) -> str:
    shrink = diagnosis.shrink
    if diagnosis.verdict == "none" or not shrink.held_nuisance <= 1.25 * shrink.held_after:
        return ""
    return (
        " The tolerances alone would close the gap in this kind of data as far: the cause is identified by the other "
        "data."
    )


def _closes(diagnosis: Diagnosis) -> str:
    shrink = diagnosis.shrink
    before, after = shrink.size(shrink.held_before), shrink.size(shrink.held_after)
    if shrink.held_after != shrink.held_after or not diagnosis.ranking:
        return f"The gap is {shrink.size(shrink.before)}; no mode can be held out to see whether it closes"
    how = " with the best-fitting explanation" if diagnosis.verdict in ("unknown", "none") else ""
    return f"{before} to {after} on modes held out{how}, noise {shrink.size(shrink.floor)}"
