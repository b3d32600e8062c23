"""The program proposes, the user decides."""

from __future__ import annotations

from dataclasses import replace

import pytest

from acquisition import Dof, HitVerdict, InputError
from acquisition.hits.verdicts import decide, rejected_points, usual_fault


def verdict(point, hit, used=True, reasons=()):
    return HitVerdict(
        point=point,
        hit=hit,
        used=used,
        reasons=tuple(reasons),
        peak=100.0,
        width=1e-3,
        band10=500.0,
        band20=800.0,
    )


VERDICTS = (
    verdict(Dof(12, 3), 1),
    verdict(Dof(12, 3), 2, False, ["double hit: 20 % of the peak, +9.0 ms from it"]),
    verdict(Dof(3, -1), 1, True, ["force has an offset of 3 N"]),
)


def test_decisions_replace_proposals_and_reasons_stay():
    one, two, three = decide(VERDICTS, use=[("12+z", 2)], leave=[(Dof(3, -1), 1)])
    assert one is VERDICTS[0]
    assert two.used and two.reasons == (*VERDICTS[1].reasons, "used by the user's decision")
    assert not three.used and three.reasons == (*VERDICTS[2].reasons, "left out by the user")
    assert rejected_points((one, two, three)) == (Dof(3, -1),)


def test_agreeing_with_the_proposal_changes_only_what_is_said():
    decided = decide(VERDICTS, use=[(Dof(12, 3), 1)], leave=[("12+Z", 2)])
    assert decided[0] == VERDICTS[0]
    assert not decided[1].used and decided[1].reasons[-1] == "left out by the user, who agrees"
    assert decide(VERDICTS) == VERDICTS


@pytest.mark.parametrize(
    ("use", "leave", "message"),
    [
        ([("12+Z", 3)], [], r"no hit 3 at 12\+Z; hits there: 1 to 2"),
        ([], [("99+Z", 1)], r"no hit 1 at 99\+Z; points hit are 12\+Z, 3-X"),
        ([("12+Z", 2)], [(Dof(12, 3), 2)], "under both use and leave"),
    ],
)
def test_hits_that_do_not_exist_are_named(use, leave, message):
    with pytest.raises(InputError, match=message):
        decide(VERDICTS, use=use, leave=leave)


def test_the_usual_fault_is_counted_by_its_kind_whatever_its_numbers() -> None:
    weak = [replace(verdict(Dof(1, 3), k, False, [f"too weak: {k} N"]), kind="too weak") for k in (1, 2)]
    double = replace(verdict(Dof(1, 3), 3, False, ["double hit: 40 %"]), kind="double hit")
    fine = verdict(Dof(1, 3), 4, True)
    assert usual_fault([double, *weak, fine]) == (2, "too weak: 1 N")
    assert usual_fault([fine]) is None
