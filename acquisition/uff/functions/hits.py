"""From single time records to the hits of a hammer test."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.form import Form
from acquisition.geometry import Geometry
from acquisition.hits.hammer import HammerTest, Hits
from acquisition.uff.functions.measurements import Measurement
from acquisition.uff.functions.pairing import Hit, pair_up
from acquisition.uff.functions.quantities import MOTIONS
from acquisition.warned import Located

_Key = tuple[float, int, Form, float]
_Forces = dict[Dof, list[Measurement]]
_Motions = dict[tuple[Dof, Dof], list[Measurement]]
Read = Callable[[Measurement, AnyArray], None]


def assemble_tests(
    records: Sequence[Measurement], geometry: Geometry, source: str, read: Read
) -> tuple[tuple[HammerTest, ...], list[str], dict[str, str]]:
    """Return hammer tests from time records, what had to be left out, and which hit was by place of a broken record.

    Parameters
    ----------
    records : sequence of Measurement
        Time records in the order of the files. Broken ones keep their place in the count; the hit they belong
        to is left out.
    geometry : Geometry
        Nodes of the test.
    source : str
        The files, for messages.
    read : callable
        Writes the values of a record to a place in memory.
    """
    warnings: list[str] = []
    broken: dict[str, str] = {}
    forces, motions = _sorted_out(records, warnings)
    plans: dict[_Key, list[list[Hit]]] = defaultdict(list)
    for reference, shocks in forces.items():
        answers = {dof: list_ for (dof, ref), list_ in motions.items() if ref == reference}
        if not answers:
            warnings.append(f"{source}: no response refers to the force at {reference}; it is left out")
        for form in dict.fromkeys(m.quantity for list_ in answers.values() for m in list_):
            same = {d: [m for m in list_ if m.quantity == form] for d, list_ in answers.items()}
            for key, hits in _groups(
                reference, shocks, {d: v for d, v in same.items() if v}, (warnings, broken), source
            ):
                plans[key].append(hits)
    tests = []
    for key, points in plans.items():
        try:
            tests.append(_test(key, points, geometry, source, read))
        except InputError as error:
            warnings.append(str(error))
    return tuple(tests), warnings, broken


def _test(key: _Key, points: list[list[Hit]], geometry: Geometry, source: str, read: Read) -> HammerTest:
    step, length, form, decay = key
    filled = tuple(_filled(hits, length, read) for hits in points)
    return HammerTest(1 / step, filled, form, decay, geometry, source)


def _filled(hits: Sequence[Hit], length: int, read: Read) -> Hits:
    """Read the records of one point straight into their place."""
    dofs = tuple(hits[0].motion)
    records = [m for hit in hits for m in (hit.force, *hit.motion.values())]
    single = all(m.dtype.itemsize == 4 for m in records)
    dtype = np.float32 if single else np.float64
    force = np.empty((len(hits), length), dtype)
    motion = np.empty((len(hits), len(dofs), length), dtype)
    for row, hit in enumerate(hits):
        read(hit.force, force[row])
        for column, dof in enumerate(dofs):
            read(hit.motion[dof], motion[row, column])
    force.setflags(write=False)
    motion.setflags(write=False)
    return Hits(hits[0].force.response, dofs, force, motion)


def _sorted_out(records: Sequence[Measurement], warnings: list[str]) -> tuple[_Forces, _Motions]:
    """Split records into forces by their place and motions by response and reference."""
    forces: _Forces = defaultdict(list)
    motions: _Motions = defaultdict(list)
    for record in records:
        if record.quantity == "force":
            forces[record.response].append(record)
    for record in records:
        if record.quantity not in MOTIONS:
            continue
        reference = record.reference
        if reference not in forces and reference.node == 0 and len(forces) == 1:
            reference = next(iter(forces))
            finding = f"names no reference; the only force, at {reference}, is taken"
            warnings.append(Located(record.place, finding))
        if reference in forces:
            motions[record.response, reference].append(record)
        else:
            finding = f"there is no force record at its reference {reference}; left out"
            warnings.append(Located(record.place, finding))
    return forces, motions


def _groups(
    reference: Dof,
    shocks: Sequence[Measurement],
    answers: dict[Dof, list[Measurement]],
    notes: tuple[list[str], dict[str, str]],
    source: str,
) -> Iterable[tuple[_Key, list[Hit]]]:
    """Return the hits at one point, one group for each set of responses, rate, length and window."""
    warnings, broken = notes
    hits, uncertain = pair_up(shocks, answers)
    if uncertain:
        stated = ", ".join(f"{len(list_)} at {dof}" for dof, list_ in answers.items())
        warnings.append(f"{source}: {len(shocks)} forces at {reference} but responses {stated}{uncertain}")
    whole = _largest([frozenset(hit.motion) for hit in hits])
    groups: dict[tuple[frozenset[Dof], float, int, float], list[Hit]] = defaultdict(list)
    for hit in hits:
        dofs = frozenset(hit.motion)
        records = [hit.force, *hit.motion.values()]
        spoilt = next((m.place for m in records if m.values is None), "")
        if spoilt and not _missing(dofs, whole):
            broken[spoilt] = f"hit {hit.number} at {reference}"
            continue
        trouble = _missing(dofs, whole) or _trouble(records)
        if trouble:
            warnings.append(f"{source}: hit {hit.number} at {reference} is left out: {trouble}")
            continue
        ordered = Hit(hit.number, hit.force, {d: hit.motion[d] for d in answers if d in dofs})
        decay = next(iter(hit.motion.values())).decay
        step = _step_of([key[1] for key in groups], hit.force)
        groups[dofs, step, hit.force.points, decay].append(ordered)
    form: Form = next(iter(answers.values()))[0].quantity  # type: ignore[assignment]
    for (_, step, length, decay), group in groups.items():
        yield (step, length, form, decay), group


def _largest(sets: list[frozenset[Dof]]) -> list[frozenset[Dof]]:
    """Return the sets of responses that are part of no other."""
    different = set(sets)
    return [one for one in different if not any(one < other for other in different)]


def _missing(dofs: frozenset[Dof], whole: list[frozenset[Dof]]) -> str:
    if dofs in whole and dofs:
        return ""
    absent = sorted((sorted(other - dofs) for other in whole), key=len)
    lost = absent[0] if absent else []
    return f"no response at {', '.join(map(str, lost))} belongs to it" if lost else "it has no response"


def _step_of(steps: Iterable[float], record: Measurement) -> float:
    """Return the spacing of a record, or of a group that agrees with it."""
    return next((step for step in steps if abs(step / record.step - 1) < 1e-6), record.step)


def _trouble(records: Sequence[Measurement]) -> str:
    """State why the records of a hit do not form one; empty if they do."""
    lengths = {m.points for m in records}
    if len(lengths) > 1:
        return f"its records have different lengths {sorted(lengths)}"
    if max(abs(m.step / records[0].step - 1) for m in records) > 1e-6:
        return "its records have different sampling rates"
    return "its records have different windows" if len({m.decay for m in records[1:]}) > 1 else ""
