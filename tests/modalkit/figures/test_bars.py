"""Bars of a chart on paper lie where the upright axis has names, and stand where it has numbers."""

from __future__ import annotations

import pytest

from modalkit.figures.chart import chart_figure
from modalkit.views.chart import Axis, Chart, Series


@pytest.mark.parametrize("lying", [False, True])
def test_bars_reach_from_zero_to_their_values(lying: bool) -> None:
    places, values = [0, 1, 2], [0.9, 0.5, 0.7]
    names = Axis(names=("1", "2", "3"))
    along, up = (Axis("share", zero=True), names) if lying else (names, Axis("share", zero=True))
    series = Series("", "bars", values, places) if lying else Series("", "bars", places, values)
    figure = chart_figure(Chart("bars", "Three shares", "", along, up, (series,)))
    bars = [patch for patch in figure.axes[0].patches if patch.get_height() > 0]
    sizes = [(bar.get_width() if lying else bar.get_height()) for bar in bars]
    assert sizes == pytest.approx(values)
    assert all((bar.get_height() if lying else bar.get_width()) == pytest.approx(0.55) for bar in bars)
