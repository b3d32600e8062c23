"""FRFs made of raw hits together with FRFs that were read for other degrees of freedom."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from acquisition import Dof, FrfSet, HammerTest, InputError
from modalkit.workflow.frf_checks import listed
from modalkit.workflow.joining import MAX_UNCOMMON, together


def with_read(
    made: FrfSet, read: FrfSet, tests: Sequence[HammerTest], warnings: list[str], *, decay: float = 0.0
) -> FrfSet:
    """Return FRFs made of hits, and those read at degrees of freedom that no raw hits are there for.

    Parameters
    ----------
    made : FrfSet
        Estimated from raw hits.
    read : FrfSet
        What the files hold beside them.
    tests : sequence of HammerTest
        The raw hits: where there are some, used or refused, the FRF that was read is a copy of theirs.
    warnings : list of str
        What was done is added to it.
    decay : float
        Decay of an exponential window, where the FRFs that were read do not state one [1/s].
    """
    hit = {_pair(d, p.reference) for test in tests for p in test.points for d in p.responses}
    pairs = list(zip(read.responses, read.references, strict=True))
    rows = [i for i, pair in enumerate(pairs) if _pair(*pair) not in hit]
    if len(rows) < len(pairs):
        warnings.append("the files hold raw hits and FRFs; the FRFs were estimated again from the hits")
    if not rows:
        return made
    others = read.select(rows)
    names = listed(others, range(len(rows)))
    try:
        joined = together(_on_common_lines(made, others if others.decay else replace(others, decay=decay)))
    except InputError as error:
        warnings.append(
            f"FRFs without raw hits are left out ({names}), since they do not match the FRFs estimated "
            f"from the hits: {error}"
        )
        return made
    warnings.append(
        f"FRFs without raw hits are used as read ({names}); the scatter of their hits is not known, so "
        "that of the others is not used either"
    )
    return joined


def _pair(response: Dof, reference: Dof) -> tuple[int, int, int, int]:
    return response.node, abs(response.direction), reference.node, abs(reference.direction)


def _on_common_lines(made: FrfSet, others: FrfSet) -> tuple[FrfSet, FrfSet]:
    """Cut both to the lines they share, and give what was read the form, and the record, of what was made.

    Raises
    ------
    InputError
        If lines are spaced differently, or there are none in common.
    """
    step = made.df
    shift = (others.frequency[0] - made.frequency[0]) / step
    span = abs(others.frequency[-1])
    if abs(others.df - step) * len(made.frequency) > MAX_UNCOMMON * span or abs(shift - round(shift)) > 1e-3:
        raise InputError(f"lines {others.df:.6g} Hz apart, not {step:.6g} Hz")
    same = others.form == made.form
    others = others.to(made.form)
    low = max(made.frequency[0], others.frequency[0]) - step / 4
    high = min(made.frequency[-1], others.frequency[-1]) + step / 4
    one, two = (s.band(max(float(low), 0.0), float(high)) for s in (made, others))
    return one, replace(
        two, frequency=one.frequency, record=one.record if same and two.record is None else two.record
    )
