"""Products of modes of one level, in rounds: peaks that show only when others are left out, and where all grow."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import identification
from identification.levels.products import Growth
from modalkit.workflow import levels


class Model(SimpleNamespace):
    """Frequencies and narrow poles, which is all that the rounds read of a model."""

    def __len__(self) -> int:
        return len(self.poles)


def model(hertz: Sequence[float]) -> Any:
    frequency = np.array(sorted(hertz))
    return Model(modal=SimpleNamespace(frequency=frequency), poles=2 * np.pi * frequency * (-1e-3 + 1j))


def state(hertz: Sequence[float], hidden: dict[float, float] | None = None) -> Any:
    """Return modes of one level; those hidden, by what hides them, show once that is dropped."""
    hidden = {} if hidden is None else hidden

    def select(drop: Sequence[float]) -> Any:
        shown = [*hertz, *(below for above, below in hidden.items() if above in drop)]
        return model([f for f in shown if f not in drop])

    class Found(SimpleNamespace):
        def modes(self, which: Any) -> Found:
            return Found(slope=self.slope[which], strongest=1.0, weakest=0.0)

    first = select(())
    return levels.Examined(select, first, Found(slope=np.zeros(len(first)), strongest=1.0, weakest=0.0))


def grows(monkeypatch: pytest.MonkeyPatch, beyond: float) -> None:
    """Let the constants of all peaks beyond a frequency grow with the force."""

    def growth(model: Any, *_: Any, **__: Any) -> Growth:
        own = model.modal.frequency
        return Growth((own > beyond).astype(float), np.full(len(own), 0.1))

    monkeypatch.setattr(identification, "growth", growth)


def test_peaks_that_others_hid_are_examined_until_none_is_new(monkeypatch: pytest.MonkeyPatch) -> None:
    grows(monkeypatch, 40.0)
    even = state([10.0, 20.0, 45.0], hidden={45.0: 47.0, 47.0: 49.0, 49.0: 25.0})
    rest, names = levels._further(state([10.0, 20.0]), even, (), None)
    assert rest.model.modal.frequency.tolist() == [10.0, 20.0, 25.0]
    assert [name.split(" (")[0] for name in names] == ["45.00 Hz", "47.00 Hz", "49.00 Hz"]


def test_where_the_constants_of_all_modes_grow_none_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    grows(monkeypatch, 0.0)
    rest, names = levels._further(state([10.0, 20.0]), state([11.0, 21.0]), (), None)
    assert rest.model.modal.frequency.tolist() == [11.0, 21.0] and names == ()
