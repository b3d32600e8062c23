"""What a report states, part by part: the gap, where it is, what causes it, how far it closes."""

from __future__ import annotations

import math

import pandas as pd

from acquisition.display import counted
from acquisition.quantities import bare_p, p_value, percent, probability
from modalkit.output.how_far import by_chance, without_cause
from modalkit.output.names import in_words, sizes, zone_in_words
from modalkit.output.shortcomings import WORDINGS
from modalkit.output.summary import NO_CAUSE, answers, of_no_library_text, searched_text, separates
from modalkit.output.words import METRICS, short
from modalkit.report.html import Cell, Column, Raw, bullets, definitions, element, folded, joined, table
from updating import Diagnosis, Effect
from updating.diagnosis.answer.ranked import Ranked

LEAST = 0.01
"""Explanations under this probability are listed without their parameters [-]."""


def _number(name: str, digits: int) -> Column:
    return Column(name, lambda value: _signed(value, digits))


def _signed(value: float, digits: int) -> str:
    return f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "−")


def the_summary(diagnosis: Diagnosis) -> Raw:
    """Return the five lines."""
    lines = {name: in_words(text) for name, text in answers(diagnosis).items()}
    return definitions(lines, class_=f"letter {diagnosis.verdict}")


def the_gap(diagnosis: Diagnosis) -> Raw:
    """Return the table of the modes, one for each study."""
    gap = diagnosis.gap
    words = (
        f"Frequencies differ by {percent(gap.rms_percent)} r.m.s. over {counted(len(gap.modes), 'mode')}. "
        "Without any cause, noise and the stated tolerances produce a misfit of all data like this or worse with "
        f"{p_value(diagnosis.p_value)}."
    )
    studies = list(dict.fromkeys(gap.modes["study"]))
    tables = [_mode_table(gap.modes[gap.modes["study"] == name], name, len(studies) > 1) for name in studies]
    return joined(element("p", words), *tables)


def _mode_table(modes: pd.DataFrame, name: str, several: bool) -> Raw:
    columns = [
        Column("mode", lambda value: f"{value:.0f}"),
        _number("test [Hz]", 3),
        _number("model [Hz]", 3),
        _number("error [%]", 3),
        _number("sigma [%]", 3),
        _number("MAC", 3),
        Column("test damping", lambda value: f"{value:.3g}"),
        Column("model damping", lambda value: f"{value:.3g}"),
    ]
    rows: list[list[Cell | Raw]] = [
        [int(mode), *(row[c.name] for c in columns[1:])]  # type: ignore[call-overload]
        for mode, row in modes.iterrows()
    ]
    caption = (
        f"{f'{name}: modes' if several else 'Modes'} of the test and of the unchanged model. Error: model "
        "minus test, relative to the test; sigma: uncertainty of the measured frequency."
    )
    return table(caption, columns, rows)


def the_place(diagnosis: Diagnosis) -> Raw:
    """Return tables of channels, places, zones and modes."""
    where = diagnosis.where
    rest = {n: v for n, v in where.channels.items() if n != "none"}
    parts = [element("p", where.band)] if where.band else []
    if diagnosis.verdict == "none":
        return joined(*parts, _modes(diagnosis))
    parts.append(
        table(
            "Which part of the model or the measurement, given that there is a cause.",
            [Column("channel"), Column("probability", probability)],
            [[n, v] for n, v in rest.items()],
            marked=[n == where.channel and diagnosis.verdict in {"named", "class"} for n in rest],
        )
    )
    if len(set(diagnosis.gap.modes["study"])) > 1:
        first = diagnosis.gap.modes["study"].iloc[0]
        parts.append(element("p", f"Places, zones and modes below are those of the first study, {first}."))
    parts.append(_places(diagnosis))
    parts += [_zones(diagnosis), _modes(diagnosis)]
    return joined(*parts)


def _places(diagnosis: Diagnosis) -> Raw:
    """Return the places with their spread: those of the most probable explanation."""
    likely_places = diagnosis.where.likely_places
    if not likely_places or diagnosis.verdict not in {"named", "class"} or not diagnosis.ranking:
        return Raw("")
    used = [
        k
        for k in range(3)
        if k == 0 or any(likely_place.place[k] or likely_place.spread[k] for likely_place in likely_places)
    ]
    columns = [
        Column("place", lambda value: f"{value:.0f}"),
        *(Column(f"{'xyz'[k]} [m]") for k in used),
        Column("probability", probability),
    ]
    rows: list[list[Cell | Raw]] = [
        [
            i + 1,
            *(_spread(likely_place.place[k], likely_place.spread[k]) for k in used),
            likely_place.probability,
        ]
        for i, likely_place in enumerate(likely_places)
    ]
    whose = short(diagnosis.ranking[0].effects)
    return table(
        f"Where {whose} sits, with one standard deviation; places taken at the same time have 100 % each.",
        columns,
        rows,
    )


def _spread(at: float, sigma: float) -> str:
    return f"{_signed(at, 3)} ± {sigma:.3f}"


def _zones(diagnosis: Diagnosis) -> Raw:
    where = diagnosis.where
    if not where.zones:
        return Raw("")
    values = [zone.probability for zone in where.zones]
    if max(values) - min(values) < 0.01:  # zones whose probabilities differ by less are not listed
        return element("p", f"All {len(values)} zones are equally probable: {probability(values[0])} each.")
    caption = "Zones and the probability that the cause sits in each."
    if where.zones_by == "regions":
        caption = (
            "Zones as if one of them alone were changed: nothing explains the gap, so this is a hint at most."
        )
    columns = [Column("zone"), Column("centre [m]"), Column("probability", probability)]
    used = [k for k in range(3) if any(zone.center[k] for zone in where.zones)]
    centre = [", ".join(f"{'xyz'[k]} = {_signed(z.center[k], 3)}" for k in used) for z in where.zones]
    rows: list[list[Cell | Raw]] = [
        [zone_in_words(z.name), c, z.probability] for z, c in zip(where.zones, centre, strict=True)
    ]
    return folded(f"All {len(rows)} zones", table(caption, columns, rows))


def _modes(diagnosis: Diagnosis) -> Raw:
    modes = diagnosis.where.modes
    if modes is None:
        return Raw("")
    names = [str(name) for name in modes.columns]
    columns = [Column("mode", lambda value: f"{value:.0f}")]
    columns += [_number(n.replace("[sigma]", "[σ]"), 2 if n == names[0] else 1) for n in names]
    rows: list[list[Cell | Raw]] = [
        [int(mode), *(float(row[n]) for n in names)]  # type: ignore[call-overload]
        for mode, row in modes.iterrows()
    ]
    return table(
        "What every mode adds to the gap, in standard deviations of noise and tolerances together.",
        columns,
        rows,
    )


def the_causes(diagnosis: Diagnosis) -> Raw:
    """Return the ranking, with parameters and intervals, and what is known of the effects of the answer."""
    rows = diagnosis.ranking
    # most explanations in the table, beside those of the answer
    shown = [r for i, r in enumerate(rows) if i < 8 or r.effects in diagnosis.sets]
    columns = [
        Column("effects"),
        Column("probability", probability),
        Column("fits with p", bare_p),
        Column("verdict"),
        Column("parameters, with 95 % intervals", wide=True),
        Column("not separated from"),
    ]
    cells: list[list[Cell | Raw]] = [
        _explanation(
            row, _why(row, diagnosis), shown=row.probability >= LEAST or row.effects in diagnosis.sets
        )
        for row in shown
    ]
    marked = [r.effects in diagnosis.sets for r in shown]
    none = diagnosis.verdict == "none"
    first = 0 if none else len(cells)
    alone = without_cause(diagnosis) if none else by_chance(diagnosis)
    cells.insert(first, [NO_CAUSE, alone, diagnosis.p_value, _why_not_alone(diagnosis), "", ""])
    marked.insert(first, none)
    aside = diagnosis.set_aside
    if aside is not None and aside.probability >= LEAST and not none:
        why = "rejected: no cause, but data that are worse than stated"
        cells.append(["no cause", aside.probability, aside.p_value, why, str(aside), ""])
        marked.append(False)
    shaded = {
        "named": "The shaded row is the answer.",
        "class": "The shaded rows are the answer: one of them explains the gap; these data cannot show which.",
        "unknown": "None of them is the answer.",
        "none": "The shaded row is the answer: no cause is needed.",
    }[diagnosis.verdict]
    if not any(row[-1] for row in cells):
        columns, cells = columns[:-1], [row[:-1] for row in cells]
    left_out = f"Parameters of those under {probability(LEAST)} are left out."
    words = f"Explanations, most probable first. {shaded} {left_out}"
    parts = [table(words, columns, cells, marked=marked)]
    if len(rows) > len(shown):
        left = sum(r.probability for r in rows if r not in shown)
        parts.append(
            element("p", f"{len(rows) - len(shown)} more, together {probability(left)}.", class_="quiet")
        )
    library = diagnosis.known
    parts += [_known(library[name]) for name in dict.fromkeys(diagnosis.effects) if name in library]
    return joined(*parts)


def _why(row: Ranked, diagnosis: Diagnosis) -> str:
    """State whether a row is the answer, and if not, why."""
    if row.effects in diagnosis.sets:
        return "the answer" if len(diagnosis.sets) == 1 else "one of the answer"
    if row.p_value < diagnosis.rules.rejected_fit:
        return f"rejected: does not fit (p = {bare_p(row.p_value)})".replace("p = <", "p <")
    best = max((r.probability for r in diagnosis.ranking), default=row.probability)
    if diagnosis.verdict == "none":
        return "not needed: there is no gap"
    if diagnosis.lacks is not None and (row is diagnosis.ranking[0] or diagnosis.lacks == "evidence"):
        return WORDINGS[diagnosis.lacks].row
    if not row.plausible:
        return "rejected: fits at a size that is implausible"
    times = best / max(row.probability, 1e-300)
    much = f"{times:.{0 if times >= 10 else 1}f} times" if times < 1000 else "more than 1000 times"
    return f"fits, but is {much} less probable"


def _why_not_alone(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == "none":
        return "the answer"
    return "rejected: they cannot produce such a gap"


def _explanation(row: Ranked, why: str, *, shown: bool) -> list[Cell | Raw]:
    stated = sizes(row)
    if not row.plausible and not any(e.at_bound for e in row.parameters.values()):
        stated.append("(implausible)")
    near = [short(names) for names in row.equivalents[:3]]
    if len(row.equivalents) > len(near):
        near.append(f"{len(row.equivalents) - len(near)} more")
    return [
        short(row.effects),
        row.probability,
        row.p_value,
        why,
        "\n".join(stated) if shown else "",
        "\n".join(near),
    ]


def _known(effect: Effect) -> Raw:
    about = f"{effect.summary} {effect.footprint} To separate it: {effect.separated_by}."
    name = effect.name.replace("_", " ")
    key = joined(Raw(" ("), element("code", effect.name), Raw(")")) if name != effect.name else Raw("")
    return element("p", element("strong", name), key, f": {about}")


def the_shrinkage(diagnosis: Diagnosis) -> Raw:
    """Return the gap before and after, on fitted and on held-out data."""
    shrink, metric = diagnosis.shrink, diagnosis.shrink.metric
    rows: list[list[Cell | Raw]] = [
        ["the unchanged model", shrink.before, shrink.held_before],
        ["tolerances alone", None, shrink.held_nuisance],
    ]
    if shrink.held_runner_up is not None:
        name = short(diagnosis.ranking[1].effects) if len(diagnosis.ranking) > 1 else ""
        rows.append([f"runner-up: {name}", None, shrink.held_runner_up])
    best = short(diagnosis.ranking[0].effects) if diagnosis.ranking else "best explanation"
    rows += [[best, shrink.after, shrink.held_after], ["noise of the test", None, shrink.floor]]
    caption = f"R.m.s. {METRICS[metric]} gap; held out: each mode predicted from all others."
    columns = [
        Column("explanation"),
        Column("on fitted data", shrink.size),
        Column("on modes held out", shrink.size),
    ]
    marked = [False] * (len(rows) - 2) + [diagnosis.verdict in {"named", "class"}, False]
    parts = [table(caption, columns, rows, marked=marked)]
    if (points := shrink.points) is not None:
        parts.append(
            element(
                "p",
                f"Modal constants at points held out: {percent(points.before)} before, {percent(points.after)} after, "
                f"{percent(points.nuisance)} with the tolerances alone.",
            )
        )
    if shrink.closed is not None and shrink.closed.determined and diagnosis.verdict in {"named", "class"}:
        parts.append(
            element("p", f"Of the reducible gap, {shrink.closed} closes (95 % interval in brackets).")
        )
    return joined(*parts)


def the_remainder(diagnosis: Diagnosis) -> Raw:
    """Return what the best explanation leaves beyond noise, and which data carry it."""
    left = diagnosis.remainder
    if left is None:
        return element("p", "There is no gap, so there is no remainder.")
    whose = short(diagnosis.ranking[0].effects) if diagnosis.ranking else "the tolerances"
    if not left.significant:
        worst = (
            f" The largest residual is {left.sigma:.1f} standard deviations."
            if math.isfinite(left.sigma)
            else ""
        )
        nothing = element("p", f"Nothing beyond noise, once {whose} is in the model.{worst}")
        return joined(nothing, *_of_no_library(diagnosis))
    size = (
        f"{whose} leaves {percent(left.percent)} beyond noise, {left.sigma:.0f} standard deviations where it is "
        "largest. Either another cause is present, or some data are worse than stated. Data that show it:"
    )
    carried = bullets(list(left.carried_by) or ["all data together"])
    return joined(element("p", size), carried, *_of_no_library(diagnosis))


def _of_no_library(diagnosis: Diagnosis) -> list[Raw]:
    """Return a paragraph on a cause that is in no library, none where it was not examined."""
    text = of_no_library_text(diagnosis)
    return [element("p", in_words(text[:1].upper() + text[1:] + "."))] if text else []


def the_next_test(diagnosis: Diagnosis) -> Raw:
    """Return what to measure next."""
    if not diagnosis.next_test:
        last = in_words(answers(diagnosis)["Next"])
        return element("p", last[:1].upper() + last[1:] + ".")
    rows: list[list[Cell | Raw]] = []
    for test in diagnosis.next_test:
        sigma = None if math.isnan(test.expected_sigma) else test.expected_sigma
        rows.append([in_words(test.measure), in_words(separates(test)), sigma])
    columns = [Column("measure next"), Column("separates"), Column("by [σ], at least", lambda v: f"{v:.1f}")]
    if not any(row[1] for row in rows):
        return table("What would show more.", columns[:1], [row[:1] for row in rows])
    return table("Tests that would separate the remaining causes, best first.", columns, rows)


def not_examined(diagnosis: Diagnosis) -> Raw:
    """Return the effects that were left out, by the reason."""
    extent = element("p", f"Searched: {searched_text(diagnosis)}.")
    if not diagnosis.not_examined:
        return joined(element("p", "Every effect of the library was examined."), extent)
    by_reason: dict[str, list[str]] = {}
    for name, why in diagnosis.not_examined.items():
        by_reason.setdefault(str(why), []).append(name)
    rows: list[list[Cell | Raw]] = [
        [in_words(", ".join(names)), in_words(why)] for why, names in by_reason.items()
    ]
    words = "None of these is ruled out by the answer above."
    return joined(
        table("Effects that could not be examined, and why.", [Column("effects"), Column("why")], rows),
        element("p", words),
        extent,
    )


def the_warnings(warnings: list[str]) -> Raw:
    """Return the warnings, each once."""
    return bullets(list(dict.fromkeys(map(in_words, warnings)))) if warnings else element("p", "None.")
