"""Clipped hits in files whose window nobody stated: found, or said to be in doubt."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from acquisition import Dof, HammerPlan, HammerTest, hammer_test, modal_system, write_uff
from acquisition.warned import Consequential, in_order, prefixed
from modalkit import read
from modalkit.cli import main

DECAY = 3.0
NODES = (1, 2, 3, 4, 5)
SYSTEM = modal_system(
    frequency=np.array([40.0, 110.0]),
    damping=np.array([0.004, 0.003]),
    response_shapes=np.array([[1.0, 1.0]]),
    point_shapes=np.array([[0.4 + 0.1 * n, (-1) ** n * (0.3 + 0.1 * n)] for n in NODES]),
    responses=(Dof(5, 3),),
    points=tuple(Dof(n, 3) for n in NODES),
)
PLAN = HammerPlan(
    rate=2048.0, samples=4096, hits=4, width=2.4e-3, pre_trigger=0.02, adc_bits=None, force_noise=2e-3
)


def clipped_and_windowed(*, part: float) -> HammerTest:
    """Return a test whose first hit at node 4 is clipped at a part of its peak, windowed after the converter."""
    test = hammer_test(SYSTEM, PLAN, rng=np.random.default_rng(3))
    window = np.exp(-DECAY * np.arange(test.samples) / test.rate)
    points = []
    for hits in test.points:
        force = np.array(hits.force)
        if hits.reference.node == 4:
            force[0] = np.minimum(force[0], part * force[0].max())
        points.append(replace(hits, force=force * window, motion=hits.motion * window))
    return replace(test, points=tuple(points))


def inspected(
    path: Path, *options: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> str:
    monkeypatch.setattr("sys.argv", ["modalkit", "inspect", str(path), *options])
    with pytest.raises(SystemExit):
        main()
    return " ".join(capfd.readouterr().out.split())


def test_inspect_warns_of_the_window_and_takes_it_as_stated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "hits.uff"
    write_uff(path, tests=clipped_and_windowed(part=0.5))
    plain = inspected(path, monkeypatch=monkeypatch, capfd=capfd)
    assert "4+Z 1 False overload: the force is clipped" in plain
    assert "state it with --decay" in plain
    stated = inspected(path, "--decay", "3", monkeypatch=monkeypatch, capfd=capfd)
    assert "4+Z 1 False overload: the force is clipped" in stated
    assert "state it with --decay" not in stated


def test_an_frf_far_less_coherent_than_its_siblings_is_named_with_the_hit(tmp_path: Path) -> None:
    """A top rounded by a filter is not flat; what is left to see is that the hit disagrees with the others."""
    test = clipped_and_windowed(part=1.0)
    points = list(test.points)
    force = np.array(points[3].force)
    top = int(force[1].argmax())
    force[1, top] *= 0.6
    points[3] = replace(points[3], force=force)
    path = tmp_path / "hits.uff"
    write_uff(path, tests=replace(test, points=tuple(points)))
    (message,) = [w for w in read(path).warnings if "mean coherence" in w]
    assert "the mean coherence of 5+Z/4+Z is 0." in message and "--leave 4+Z:2" in message
    write_uff(path, tests=test)
    assert not any("mean coherence" in w for w in read(path).warnings)


@pytest.mark.long
def test_an_unstated_window_is_shown_with_the_test_and_with_its_modes(tmp_path: Path) -> None:
    """It raises every damping, so it stands before what changes nothing, wherever a result shows itself."""
    path = tmp_path / "hits.uff"
    write_uff(path, tests=clipped_and_windowed(part=1.0))
    found = read(path)
    modes = found.identify(band=(10.0, 200.0))
    for shown in (repr(found), repr(modes)):
        assert "an exponential window seems to have been applied" in shown.split("\n")[1]
    assert modes.warnings[0].endswith("state it with --decay or exponential_window")
    stated = read(path, decay=DECAY)
    assert "window seems" not in repr(stated) + repr(stated.identify(band=(10.0, 200.0)))


def test_warnings_that_change_a_number_come_first() -> None:
    warnings = [
        "units are assumed",
        Consequential("the damping is too high"),
        "units are assumed",
        "no title",
    ]
    assert in_order(warnings) == ("the damping is too high", "units are assumed", "no title")
    assert in_order([prefixed("baseline: ", w) for w in warnings])[0] == "baseline: the damping is too high"
