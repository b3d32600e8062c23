"""Warnings of one kind are one, with the first place and how many others there are."""

from __future__ import annotations

import pickle

import numpy as np

from acquisition import Dof, FrfSet, read_uff, write_uff
from acquisition.warned import Consequential, Located, in_order, prefixed

CUT = "bytes after its points are left out"


def test_findings_at_many_places_are_one_warning():
    found = [Located(f"a.uff, line {n}", CUT) for n in range(1, 901)]
    other, grave = Located("a.uff, line 7", "is dead"), Consequential("a window was found")
    assert in_order([*found, other, grave, other]) == (
        grave,
        f"a.uff, line 1 and 899 other places: {CUT}",
        "a.uff, line 7: is dead",
    )
    assert in_order(found[:2]) == (f"a.uff, line 1 and 1 other place: {CUT}",)


def test_a_place_outlasts_prefix_and_copy():
    one = pickle.loads(pickle.dumps(Located("line 3", CUT)))
    assert one == f"line 3: {CUT}" and one.place == "line 3"
    assert in_order([prefixed("left: ", one), Located("line 4", CUT)]) == (
        f"left: line 3 and 1 other place: {CUT}",
    )


def test_the_same_oddity_of_every_data_set_is_one_warning(tmp_path, rng):
    count, lines = 30, 64
    values = rng.standard_normal((count, lines)) + 1j * rng.standard_normal((count, lines))
    points = tuple(Dof(n + 1, 3) for n in range(count))
    frfs = FrfSet(np.arange(lines) * 1.0, values, points, (Dof(1, 3),) * count)
    write_uff(tmp_path / "a.uff", frfs=frfs)
    data = (tmp_path / "a.uff").read_bytes()
    parts = data.split(b"    -1\n    58b")
    whole = [parts[0], *(p[: p.rindex(b"    -1\n")] + bytes(8) + b"    -1\n" for p in parts[1:])]
    (tmp_path / "b.uff").write_bytes(b"    -1\n    58b".join(whole))
    content = read_uff(tmp_path / "b.uff")
    odd = [info for info in content.datasets if info.message]
    shown = [w for w in in_order(content.warnings) if odd[0].message in w]
    assert len(odd) == count
    assert [w.partition(": ")[0] for w in shown] == [f"{odd[0].place} and {count - 1} other places"]
