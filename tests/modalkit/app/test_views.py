"""What pages are made of: reasons for poles, surfaces, curves made short."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from opening import FAINT, opened

from acquisition import Dof, Geometry, ModalData, read_uff
from acquisition.errors import InputError, ModalkitError
from acquisition.hits.checks import force_bands, pulse_spectrum
from identification import pole_origins
from identification.poles.stabilisation import StabilisationChart
from modalkit import read
from modalkit.output.whole import plain
from modalkit.report.document import Moving
from modalkit.report.tested import modal_of, shapes_section
from modalkit.study.read import read_study
from modalkit.views.curves import POINTS, envelope
from modalkit.views.faces import closed_faces
from modalkit.views.grid_lines import grid_lines
from modalkit.views.hits import first_frf, force_trace
from modalkit.views.pairs import pairs_of
from modalkit.views.shapes import shapes_page
from modalkit.views.stability import pole_stability
from modalkit.workflow.case import open_study

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "matrices"


def test_every_pole_of_the_chart_has_a_reason(faint):
    model = read(faint).identify(add=[FAINT], drop=[110.0])
    origins = pole_origins(model, add=[FAINT], drop=[110.0])
    assert len(origins.chain) == len(model.chart.poles)
    frequency = model.chart.frequency
    kinds = np.array([origins.reasons[chain].kind for chain in origins.chain])
    assert set(kinds) <= {"mode", "dropped", "outside", "background", "pruned", "short", "new"}
    assert set(kinds[np.abs(frequency - 430.0) < 0.05]) >= {"mode"}
    stable = np.abs(frequency - 110.0) < 0.02
    assert np.mean(kinds[stable] == "dropped") > 0.5
    assert origins.modes[np.argmin(np.abs(model.modal.frequency - FAINT))] == "named"


def test_the_frfs_are_there_before_the_modes_and_not_needed_after(faint):
    controller = opened(faint)
    page = plain(controller.measured())
    frfs = read_uff(faint).frfs
    assert max(page["sum"]["sum"]) == pytest.approx(np.abs(frfs.values).sum(axis=0).max())
    assert page["band"] == [1.0, 600.0]
    assert page["frf"]["magnitude"] == plain(controller.frf(0))["magnitude"]
    controller.modes()
    assert controller.measured() is None
    controller.act("order", {"order": 40})
    assert controller.measured() is None, "the change has identified the modes already"
    controller.step(back=True)
    assert controller.measured() is None


def test_indicators_of_the_page_have_their_minima_and_peaks_at_the_modes(faint):
    page = plain(opened(faint).indicators())
    lines = np.array(page["x"])
    for hertz in (110.0, 430.0):
        near = np.abs(lines - hertz) < 20
        assert lines[near][np.argmax(np.array(page["CMIF 1"])[near])] == pytest.approx(hertz, abs=2)
        assert lines[near][np.argmin(np.array(page["MvMIF 1"])[near])] == pytest.approx(hertz, abs=2)
    assert page["why"] == ""
    assert "MvMIF 2" not in page, "the file has one reference"


def test_a_mode_that_no_chain_became_was_added_by_the_refinement(faint):
    """Without the chart's poles about it, the mode cannot come from the chart."""
    from dataclasses import replace

    model = read(faint).identify()
    keep = np.abs(model.chart.frequency - 430.0) > 20.0
    chart = replace(
        model.chart,
        level=model.chart.level[keep],
        poles=model.chart.poles[keep],
        participation=model.chart.participation[keep],
        track=model.chart.track[keep],
    )
    origins = pole_origins(replace(model, chart=chart))
    last = int(np.argmin(np.abs(model.modal.frequency - 430.0)))
    assert origins.modes[last] == "refinement"
    assert origins.modes[0] == "chain"


def test_faces_close_three_and_four_lines_and_leave_air_open():
    """A square with a diagonal is two triangles; a cube six faces; two parallel lines are none."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    ring = [(0, 1), (1, 2), (2, 3), (3, 0)]
    assert [set(f) for f in closed_faces(square, ring)] == [{0, 1, 2, 3}]
    assert {frozenset(f) for f in closed_faces(square, [*ring, (0, 2)])} == {
        frozenset({0, 1, 2}),
        frozenset({0, 2, 3}),
    }
    assert closed_faces(square, [(0, 1), (2, 3)]) == []
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    edges = [(a, b) for a in range(8) for b in range(a) if np.abs(corners[a] - corners[b]).sum() == 1]
    assert len(closed_faces(corners, edges)) == 6
    skew = square.copy()
    skew[2, 2] = 1.0
    assert closed_faces(skew, ring) == []


@pytest.mark.parametrize("n", [10, POINTS, 10 * POINTS + 7])
def test_no_peak_is_lost_where_a_curve_is_made_short(n):
    rng = np.random.default_rng(1)
    y = rng.standard_normal(n)
    y[n // 3] = 50.0
    y[n // 2] = -40.0
    x, short = envelope(np.arange(float(n)), y)
    assert len(x) == len(short) <= max(n if n <= POINTS else POINTS, 1)
    assert max(short) == 50.0
    assert min(short) == -40.0
    assert x == sorted(x)


def test_a_short_pulse_in_a_long_record_is_drawn_as_it_is():
    """A half-sine of 0.77 ms in 8 s, with ringing and a bounce behind it: peak, width and bounce of the data."""
    rate, length = 51_200.0, 0.77e-3
    time = np.arange(int(8 * rate)) / rate
    since = time - 0.4
    force = np.where((since >= 0) & (since <= length), 100 * np.sin(np.pi * since / length), 0.0)
    force -= np.where(
        since > length, 2 * np.exp(-2000 * np.maximum(since, 0)) * np.sin(2 * np.pi * 5000 * since), 0.0
    )
    bounce = (since > 3.1) & (since < 3.1 + length)
    force[bounce] += 8.0
    drawn = force_trace(time, force)
    x, y = np.array(drawn["time"]), np.array(drawn["value"])
    assert np.all(np.diff(x) > 0)
    assert len(x) < 2 * POINTS
    low, high = drawn["range"]
    assert low < 0.4 and 0.4 + 4 * length < high < 0.4 + 8 * length
    seen, shown = (time >= low) & (time <= high), (x >= low) & (x <= high)
    assert np.array_equal(x[shown], time[seen]) and np.array_equal(y[shown], force[seen])
    above = x[y > 50]
    assert y.max() == pytest.approx(100, rel=1e-3)
    assert above[-1] - above[0] == pytest.approx(
        2 / 3 * length, abs=2 / rate
    )  # sin = 1/2 at 30 and 150 degrees
    assert y[x > 3.4].max() == 8.0


def test_two_hits_far_apart_and_a_record_without_a_pulse_are_thinned():
    time = np.arange(400_000) / 51_200.0
    force = np.zeros(400_000)
    force[20_000], force[300_000] = 50.0, 60.0
    drawn = force_trace(time, force)
    assert len(drawn["time"]) <= 2 * POINTS
    assert max(drawn["value"]) == 60.0
    assert 50.0 in drawn["value"]
    assert drawn["range"][0] < time[300_000] < drawn["range"][1]
    assert force_trace(time, np.zeros(400_000))["range"][1] > 0


def test_the_spectrum_in_the_picture_is_the_one_that_is_judged():
    """A half-sine of 2 ms is 20 dB down where |cos(pi f T) / (1 - (2 f T)^2)| is a tenth."""
    rate, length = 20_000.0, 2e-3
    time = np.arange(4000) / rate - 0.01
    wave = np.where((time >= 0) & (time <= length), np.sin(np.pi * np.clip(time / length, 0, 1)), 0.0)
    frequency, size = pulse_spectrum(wave, rate)
    _, band20 = force_bands(wave, rate)
    product = frequency * length
    middle = np.abs(2 * product - 1) < 1e-9  # where it is nothing over nothing: pi / 4
    exact = np.where(middle, np.pi / 4, np.abs(np.cos(np.pi * product) / (1 - (2 * product) ** 2 + middle)))
    below = frequency[np.flatnonzero(exact < 0.1)[0]]
    assert band20 == pytest.approx(below, rel=0.02)
    assert band20 == frequency[np.flatnonzero(size < 0.1 * size[0])[0]]


def test_the_shapes_of_test_and_model_agree_where_their_mac_does(beam):
    page = plain(opened(beam).shapes())
    for test, model in zip(page["modes"], page["model"]["modes"], strict=True):
        u, v = np.array(test["re"]).ravel(), np.array(model["at_points"]).ravel()
        mac = (u @ v) ** 2 / ((u @ u) * (v @ v))
        assert mac == pytest.approx(model["mac"], abs=0.02)
        assert max(model["difference"]) < 0.5
    assert np.array(page["model"]["surface"]["places"])[:, 0].max() == pytest.approx(0.376)


@pytest.mark.long
def test_the_pairs_of_the_pages_are_those_of_the_correlation(beam):
    controller = opened(beam)
    beside = controller._beside(controller.study)
    table = beside.correlation.table
    pairs = pairs_of(beside.session.case.measured, beside.predictor.predict())
    assert [(p.test + 1, p.model + 1) for p in pairs] == [
        (int(t), int(m)) for t, m in zip(table["test mode"], table["model mode"], strict=True)
    ]
    assert [p.mac for p in pairs] == pytest.approx(table["MAC"].tolist(), rel=1e-9)


def test_points_of_lines_that_were_not_measured_are_drawn_at_rest():
    """A frame of four corners, one of them not measured: its lines are drawn, no surface is made up on it."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]], float)
    geometry = Geometry((1, 2, 3, 4, 9), corners, np.array([[1, 2], [2, 3], [3, 4], [4, 1]]))
    dofs = tuple(Dof(node, 3) for node in (1, 2, 3))
    shapes = np.array([[1.0], [2.0], [3.0]], complex)
    modal = ModalData(
        frequency=np.array([10.0]),
        frequency_sigma=np.array([0.01]),
        damping=np.array([0.01]),
        shapes=shapes,
        dofs=dofs,
        geometry=geometry,
    )
    page = shapes_page(modal, None)
    assert page["nodes"] == [1, 2, 3, 4] and page["still"] == 1
    assert len(page["lines"]) == 4 and page["faces"] == []
    assert np.abs(page["modes"][0]["re"][3]).max() == 0.0


def test_the_drive_point_is_shown_first(faint):
    frfs = read(faint).frfs
    first = first_frf(frfs)
    assert frfs.responses[first].node == frfs.references[first].node
    away = frfs.select([i for i in range(len(frfs.responses)) if i != first])
    size = [np.linalg.norm(row) for row in away.values]
    assert first_frf(away) == int(np.argmax(size))


def test_the_stability_of_poles_compares_poles_with_the_order_below() -> None:
    """Poles of two references moved by known parts."""
    hertz = np.array([100.0, 200.0, 300.0, 400.0, 500.0])
    moved = hertz * np.array([1.001, 1.001, 1.001, 1.001, 1.05])
    damping, later = np.full(5, 0.01), np.array([0.0101, 0.0101, 0.02, 0.02, 0.01])
    poles = [2 * np.pi * f * (-z + 1j * np.sqrt(1 - z**2)) for f, z in ((hertz, damping), (moved, later))]
    first = np.tile([1.0, 0.0], (5, 1)).astype(complex)
    second = first.copy()
    second[[1, 3]] = [0.0, 1.0]
    chart = StabilisationChart(
        np.array([2, 4]),
        np.repeat([0, 1], 5),
        np.concatenate(poles),
        np.concatenate([first, second]),
        np.arange(10),
        (50.0, 600.0),
    )
    assert "".join(pole_stability(chart)) == "ooooo" + "sdvfo"


def test_the_other_frfs_of_a_force_are_those_of_the_test(beam: Path) -> None:
    controller = opened(beam)
    page = controller.hits()
    found = controller.others(0)
    assert [one["name"] for one in found["curves"]] == [
        name for name in page["frfs"] if name != page["frfs"][0]
    ]
    assert {len(one["magnitude"]) for one in found["curves"]} == {len(found["x"])}
    with pytest.raises(InputError):
        controller.others(99)


def test_lines_join_the_neighbours_of_a_grid_and_leave_a_hole_open() -> None:
    """Three rows of four points in any order, one of them missing."""
    grid = np.array([[x, y, 0.0] for y in (0.0, 0.1, 0.2) for x in (0.0, 0.1, 0.2, 0.3)])
    points = grid[np.random.default_rng(3).permutation(12)]
    joined = {frozenset((tuple(points[a]), tuple(points[b]))) for a, b in grid_lines(points)}
    assert len(joined) == 3 * 3 + 4 * 2
    assert all(np.isclose(np.linalg.norm(np.subtract(*one)), 0.1) for one in joined)
    wide = np.array([[x, 0.0, 0.0] for x in (0.0, 0.1, 0.2, 0.9, 1.0)])
    assert grid_lines(wide) == [(0, 1), (1, 2), (3, 4)]
    assert grid_lines(np.zeros((3, 3))) == []
    assert grid_lines(np.zeros((0, 3))) == []


def test_lines_drawn_by_hand_reach_shapes_exports_and_the_report(beam: Path, tmp_path: Path) -> None:
    controller = opened(beam)
    page = plain(controller.shapes())
    drawn = [[page["nodes"][i] for i in pair] for pair in page["lines"]]
    assert len(drawn) > 1 and not page["stated"]
    a, b = drawn[0][0], drawn[-1][1]
    controller.act("join", {"points": [b, a], "drawn": drawn})
    joined = plain(controller.shapes())
    assert joined["stated"] and joined["lines_from"] == "file"
    after = [[joined["nodes"][i] for i in pair] for pair in joined["lines"]]
    assert after == [sorted(pair) for pair in drawn] + [sorted((a, b))]
    folder = Path(controller.export()["folder"])
    for name in ("modes.uff", "frfs.uff"):
        lines = read_uff(folder / name).geometry.lines
        assert sorted(lines.tolist()) == sorted(after), name
    session = open_study(read_study(folder / "study.toml"), with_baseline=False)
    parts = shapes_section(modal_of(session), session).shown
    report = plain(next(part for part in parts if isinstance(part, Moving)).page)
    assert sorted(sorted(report["nodes"][i] for i in pair) for pair in report["lines"]) == sorted(after)
    controller.act("join", {"points": [a, b], "drawn": after})
    assert [[page["nodes"][i] for i in pair] for pair in plain(controller.shapes())["lines"]] == [
        sorted(pair) for pair in drawn
    ]
    controller.act("set", {"path": ["test", "lines"], "value": ""})
    assert plain(controller.shapes()) == page


@pytest.mark.parametrize(
    ("points", "drawn", "message"),
    [
        ([1, 1], [[1, 2]], "point 1 cannot be joined with itself"),
        ([1, 99], [[1, 2]], "lines name point 99, which has no place"),
        ([1, 2], [[1, 2]], "this is the last line"),
        ([1, "x"], [[1, 2]], "cannot be made"),
    ],
)
def test_a_line_that_cannot_be_drawn_is_refused(
    beam: Path, points: list[Any], drawn: list[list[int]], message: str
) -> None:
    controller = opened(beam)
    before = plain(controller.shapes())
    with pytest.raises(ModalkitError, match=message):
        controller.act("join", {"points": points, "drawn": drawn})
    assert plain(controller.shapes()) == before


def test_stated_places_reach_shapes_and_exports(faint: Path) -> None:
    """A file without coordinates: points on a grid of two rows as the study places them."""
    controller = opened(faint)
    before = controller.shapes()
    assert not before["placed"]
    assert "places" in before["why"]
    places = {str(i + 1): [0.1 * (i % 3), 0.2 * (i // 3), 0.0] for i in range(6)}
    controller.act("set", {"path": ["test", "places"], "value": places})
    page = controller.shapes()
    assert page["placed"]
    assert page["lines_from"] == "grid"
    assert len(page["lines"]) == 2 * 2 + 3
    assert len(page["faces"]) == 2
    folder = Path(controller.export()["folder"])
    for name in ("modes.uff", "frfs.uff"):
        geometry = read_uff(folder / name).geometry
        assert geometry.at([5])[0].tolist() == pytest.approx(places["5"])
