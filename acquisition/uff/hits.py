"""From single time records to the hits of a hammer test."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.dof import Dof
from acquisition.frf import Form
from acquisition.geometry import Geometry
from acquisition.hammer import HammerTest, Hits
from acquisition.uff.measurements import Measurement

_Key = tuple[float, int, Form, float]


def assemble_tests(
    records: Sequence[Measurement], geometry: Geometry, source: str
) -> tuple[tuple[HammerTest, ...], list[str]]:
    """Return hammer tests from time records, and what had to be left out.

    The n-th force at a degree of freedom belongs to the n-th responses that refer to it. Broken records keep
    their place in the count; the hit they belong to is left out.
    """
    warnings: list[str] = []
    forces, motions = _sorted_out(records, warnings)
    points: dict[_Key, list[Hits]] = defaultdict(list)
    for reference, shocks in forces.items():
        answers = {dof: list_ for (dof, ref), list_ in motions.items() if ref == reference}
        if not answers:
            warnings.append(f"{source}: no response refers to the force at {reference}; it is left out")
        for form in dict.fromkeys(m.quantity for list_ in answers.values() for m in list_):
            same = {d: [m for m in list_ if m.quantity == form] for d, list_ in answers.items()}
            for key, hits in _point(
                reference, shocks, {d: v for d, v in same.items() if v}, warnings, source
            ):
                points[key].append(hits)
    tests = []
    for (step, _, form, decay), hits_list in points.items():
        tests.append(HammerTest(1 / step, tuple(hits_list), form, decay, geometry, source))
    return tuple(tests), warnings


def _sorted_out(
    records: Iterable[Measurement], warnings: list[str]
) -> tuple[dict[Dof, list[Measurement]], dict[tuple[Dof, Dof], list[Measurement]]]:
    """Split records into forces by their place and motions by response and reference."""
    forces: dict[Dof, list[Measurement]] = defaultdict(list)
    motions: dict[tuple[Dof, Dof], list[Measurement]] = defaultdict(list)
    records = list(records)
    for record in records:
        if record.quantity == "force":
            forces[record.response].append(record)
    for record in records:
        if record.quantity in ("force", "other", "pressure"):
            continue
        reference = record.reference
        if reference not in forces and reference.node == 0 and len(forces) == 1:
            reference = next(iter(forces))
            warnings.append(f"{record.place}: names no reference; the only force, at {reference}, is taken")
        if reference in forces:
            motions[record.response, reference].append(record)
        else:
            warnings.append(
                f"{record.place}: there is no force record at its reference {reference}; left out"
            )
    return forces, motions


def _point(
    reference: Dof,
    shocks: Sequence[Measurement],
    answers: dict[Dof, list[Measurement]],
    warnings: list[str],
    source: str,
) -> Iterable[tuple[_Key, Hits]]:
    """Return the hits at one point, one group for each rate, length and window."""
    counts = {str(dof): len(list_) for dof, list_ in answers.items()}
    if set(counts.values()) != {len(shocks)}:
        told = ", ".join(f"{n} at {dof}" for dof, n in counts.items())
        warnings.append(
            f"{source}: {len(shocks)} forces at {reference} but responses {told}; only the first "
            f"{min(len(shocks), *counts.values())} hits are used, check that none is missing in between"
        )
    groups: dict[tuple[float, int, float], list[tuple[Measurement, ...]]] = defaultdict(list)
    for number, hit in enumerate(zip(shocks, *answers.values(), strict=False), start=1):
        trouble = _trouble(hit)
        if trouble:
            warnings.append(f"{source}: hit {number} at {reference} is left out: {trouble}")
            continue
        groups[_step_of(groups, hit[0]), len(_values(hit[0])), hit[1].decay].append(hit)
    form: Form = next(iter(answers.values()))[0].quantity  # type: ignore[assignment]
    for (step, length, decay), hits in groups.items():
        force = np.stack([_values(hit[0]) for hit in hits])
        motion = np.stack([np.stack([_values(m) for m in hit[1:]]) for hit in hits])
        yield (step, length, form, decay), Hits(reference, tuple(answers), force, motion)


def _values(record: Measurement) -> AnyArray:
    assert record.values is not None
    return np.asarray(record.values.real)


def _step_of(
    groups: dict[tuple[float, int, float], list[tuple[Measurement, ...]]], record: Measurement
) -> float:
    """Return the spacing of a record, or of a group that agrees with it."""
    for step, _, _ in groups:
        if abs(step / record.step - 1) < 1e-6:
            return step
    return record.step


def _trouble(hit: Sequence[Measurement]) -> str:
    """Say why the records of a hit do not form one; empty if they do."""
    broken = [m.place for m in hit if m.values is None]
    if broken:
        return f"{broken[0]} is broken"
    lengths = Counter(len(_values(m)) for m in hit)
    if len(lengths) > 1:
        return f"its records have different lengths {sorted(lengths)}"
    if max(abs(m.step / hit[0].step - 1) for m in hit) > 1e-6:
        return "its records have different sampling rates"
    return "its records have different windows" if len({m.decay for m in hit[1:]}) > 1 else ""
