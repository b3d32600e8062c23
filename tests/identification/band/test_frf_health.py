"""Remarks on FRFs: coherence lost, hits refused, a window that is heavier than the damping."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, HammerPlan, HitVerdict, Windows, estimate_frfs, hammer_test, modal_system
from identification import ModalModel, frf_health, identify, mode_coherence

PLAN = HammerPlan(rate=1024.0, samples=2048, hits=6, width=3e-3, response_noise=1e-3, force_noise=0.02)


def model(*, damping: float = 0.01, windows: Windows | None = None, wandering: float = 0.0) -> ModalModel:
    """Two modes; the second one's frequency wanders from hit to hit."""
    rng = np.random.default_rng(3)

    def at(level: float) -> object:
        moved = wandering * rng.standard_normal()
        return modal_system(
            frequency=np.array([60.0, 170.0 * (1 + moved)]),
            damping=np.full(2, damping),
            response_shapes=np.array([[1.0, 0.8]]),
            point_shapes=np.array([[0.6, -0.9], [1.0, 0.8]]),
            responses=[Dof(2, 3)],
            points=[Dof(1, 3), Dof(2, 3)],
        )

    test = hammer_test(at, PLAN, rng=np.random.default_rng(1))  # type: ignore[arg-type]
    return identify(estimate_frfs(test, windows=windows), band=(20.0, 250.0))


def verdict(number: int, reason: str = "") -> HitVerdict:
    return HitVerdict(
        point=Dof(1, 3),
        hit=number,
        used=not reason,
        reasons=(reason,) if reason else (),
        peak=100.0,
        width=1e-3,
        band10=300.0,
        band20=500.0,
    )


def test_sound_frfs_need_no_word() -> None:
    found = model()
    assert frf_health(found, [verdict(i + 1) for i in range(6)]) == ()
    coherence = mode_coherence(found)
    assert coherence is not None
    assert coherence.min() > 0.99


def test_lost_coherence_is_laid_to_its_mode() -> None:
    found = model(wandering=0.01)
    coherence = mode_coherence(found)
    assert coherence is not None
    assert coherence[0] > 0.98
    message = " ".join(frf_health(found))
    poor = np.flatnonzero(coherence < 0.9)
    assert len(poor)
    assert np.all(found.modal.frequency[poor] > 150)
    assert f"mode(s) {', '.join(str(i + 1) for i in poor)}" in message


def test_without_coherence_nothing_is_said_of_it() -> None:
    found = model()
    bare = replace(found, frfs=replace(found.frfs, coherence=None))
    assert mode_coherence(bare) is None
    assert frf_health(bare) == ()


@pytest.mark.parametrize(("refused", "stated"), [(1, False), (3, True)])
def test_many_refused_hits_are_counted_with_the_usual_reason(refused: int, stated: bool) -> None:
    hits = [verdict(i + 1, "second hit" if i < refused else "") for i in range(6)]
    message = frf_health(model(), hits)
    assert bool(message) is stated
    assert all("second hit" in s and f"{refused} of 6" in s for s in message)


def test_a_window_heavier_than_the_damping_is_said() -> None:
    (message,) = frf_health(model(damping=0.004, windows=Windows(decay=60.0)))
    assert "the damping of mode 1" in message
    assert frf_health(model(damping=0.02, windows=Windows(decay=1.0))) == ()
