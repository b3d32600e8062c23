"""A test during which the structure gets warmer: simulated, identified, diagnosed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acquisition import Dof, ModalSystem
from acquisition.errors import StudyError
from modalkit.output.documents import modes_document
from modalkit.samples import sample_file
from modalkit.simulation.setup import Options
from modalkit.simulation.simulate import simulate_test
from modalkit.simulation.systems import drifting
from modalkit.study.named_effects import parse_effect
from modalkit.study.read import read_study
from modalkit.workflow.case import Session, open_study
from updating import LIBRARY, diagnose

STUDY = sample_file("beam_dry/study.toml")
OFFERED = [
    LIBRARY[n] for n in ("drift", "E", "clamp_rotation", "sensor_mass", "lumped_mass", "position_error")
]


def session_of(folder: Path, *effects: str, seed: int, as_frfs: bool = False) -> Session:
    """The sample's study with hits of its own points, one after the other, on a computer."""
    options = Options(hits=4, remount=True)
    test = simulate_test(read_study(STUDY), [parse_effect(e) for e in effects], seed=seed, options=options)
    test.write(folder / "hits.uff", as_frfs=as_frfs)
    path = folder / "study.toml"
    path.write_text(STUDY.read_text().replace("beam_dry.uff", "hits.uff"))
    return open_study(path)


@pytest.mark.parametrize(
    ("rate", "as_frfs"), [(0.006, False), pytest.param(-0.004, True, marks=pytest.mark.long)]
)
def test_a_drift_that_is_put_in_is_named_with_its_rate(tmp_path: Path, rate: float, as_frfs: bool) -> None:
    session = session_of(tmp_path, f"drift:rate={rate}", seed=2, as_frfs=as_frfs)
    assert session.identified is not None
    trend = modes_document(session.identified)["trend"]
    assert trend is not None
    assert trend["points"] == 5
    assert trend["rate"] == pytest.approx(rate, rel=0.1)
    assert any("the frequencies drift" in warning for warning in session.warnings)
    found = diagnose(session.case, library=OFFERED)
    assert (found.verdict, found.sets) == ("named", (("drift",),))
    stated = found.ranking[0].parameters["drift.rate"]
    assert stated.low95 < rate < stated.high95


@pytest.mark.long
def test_nothing_hidden_raises_no_alarm(tmp_path: Path) -> None:
    session = session_of(tmp_path, seed=1)
    found = diagnose(session.case, library=OFFERED)
    assert found.verdict == "none"
    assert "drift" not in found.not_examined


@pytest.mark.long
def test_modes_without_an_order_do_not_tell(tmp_path: Path) -> None:
    rows = "\n".join(f"{f},{1e-4 * f}" for f in (27.0, 170.0, 476.0))
    (tmp_path / "modes.csv").write_text(f"frequency [Hz],sigma [Hz]\n{rows}\n")
    path = tmp_path / "study.toml"
    text = STUDY.read_text().replace("exponential_window = 8.0", "")
    path.write_text(text.replace('files = ["beam_dry.uff"]', 'modes = "modes.csv"'))
    found = diagnose(open_study(path).case, library=OFFERED)
    assert "order" in str(found.not_examined["drift"])


def system(*nodes: int) -> ModalSystem:
    n = len(nodes)
    points = tuple(Dof(node, 3) for node in nodes)
    return ModalSystem(np.array([-1.0 + 100j]), np.ones((1, n, 1), complex), (Dof(9, 3),), points)


def test_factors_go_from_the_first_point_to_the_last_over_all_systems() -> None:
    one, other = system(1, 2), system(3)
    hit = drifting([one, other], 0.02)
    found = [
        at_hit(point, 0, 100.0).poles[0] / (-1.0 + 100j)
        for at_hit, points in zip(hit, (2, 1), strict=True)
        if at_hit is not None
        for point in range(points)
    ]
    assert found == pytest.approx([0.99, 1.0, 1.01])
    assert drifting([one, other], 0.0) == [None, None]


def test_nothing_drifts_over_one_point() -> None:
    with pytest.raises(StudyError, match="one point"):
        drifting([system(1)], 0.01)
