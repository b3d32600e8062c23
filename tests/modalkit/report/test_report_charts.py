"""The charts of a report: each title says what its own numbers say, and nothing is lost on the way to the page."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from figure_cases import case_of, hammered, model_of, verdicts_of
from glider import make_glider
from hypothesis import given
from hypothesis import strategies as st
from test_localisation_figure import diagnosis_with

from acquisition import Dof, FrfSet
from identification import cmif, mvmif, pole_origins
from modalkit.output.whole import plain
from modalkit.report.scripts import scripts
from modalkit.views.chart import Chart, rounded
from modalkit.views.charts.causes import causes_chart, closing_chart
from modalkit.views.charts.gap import gap_chart, gap_title
from modalkit.views.charts.matrix import matrix_chart
from modalkit.views.charts.place import place_chart
from modalkit.views.charts.poles import poles_chart
from modalkit.views.charts.test import auto_mac_chart, cmif_chart, frfs_chart, hits_chart, mvmif_chart
from modalkit.views.charts.thin import FEWEST, LARGEST, common_lines
from modalkit.views.mode_errors import ModeErrors
from modalkit.views.shapes import Beside, shapes_page
from modalkit.workflow.case import open_study
from updating.correlation.correlate import correlate
from updating.nominal import predictor_of

BEFORE = np.array([3.0, -0.4, 0.1, 2.0])
AFTER = np.array([0.2, 0.1, -0.1, 0.7])
DOUBT = np.array([0.5, 0.5, 0.5, 0.6])


def errors(after: np.ndarray | None, doubt: np.ndarray | None, channel: str = "frequency") -> ModeErrors:
    floor = None if doubt is None else doubt / 5
    return ModeErrors(np.array([10.0, 20.0, 30.0, 40.0]), BEFORE, after, floor, doubt, channel)


def outside(chart: Chart, name: str) -> int:
    """Count the marks of a series that are drawn outside the widest band."""
    band = next(one for one in chart.series if one.name == "tolerances, 2σ")
    dots = next(one for one in chart.series if one.name == name)
    low, high = (np.array(band.more[end], dtype=float) for end in ("low", "high"))
    values = np.array(dots.x, dtype=float)
    return int(np.sum((values < low) | (values > high)))


@pytest.mark.parametrize("after", [None, AFTER])
def test_the_title_of_the_gap_counts_the_marks_outside_the_bands(after: np.ndarray | None) -> None:
    chart = gap_chart(errors(after, DOUBT))
    counted = [outside(chart, "unchanged model")] + ([] if after is None else [outside(chart, "after")])
    assert counted == [2, 1][: len(counted)]
    assert [
        int(n) for n in re.findall(r"(?<!Frequency of )\b(\d+)(?= outside| after)", chart.title)
    ] == counted


def test_a_gap_without_bands_says_how_far_off_it_is() -> None:
    assert (
        gap_title(errors(AFTER, None))
        == "Frequency of 4 modes: off by 0.1 % to 3 % before, by 0.1 % to 0.7 % after"
    )
    assert gap_title(errors(None, None, "combined")).startswith(
        "All data of 4 modes: off by 0.1 sigma to 3 sigma"
    )


def test_modes_of_the_gap_have_the_numbers_of_the_test() -> None:
    """Where a mode has no partner, those after it keep their numbers."""
    chart = gap_chart(replace(errors(AFTER, None), modes=np.array([1, 2, 4, 7])))
    assert [name.split(":")[0] for name in chart.y.names] == ["1", "2", "4", "7"]
    assert [text.split(":")[0] for text in chart.series[-1].more["text"]] == [
        f"mode {i}" for i in (1, 2, 4, 7)
    ]


def test_no_frequency_outside_the_band_counts_as_none() -> None:
    assert "none outside" in gap_title(replace(errors(None, DOUBT), before=AFTER * 0.5))


@pytest.mark.parametrize("verdict", ["named", "class", "unknown", "none"])
@pytest.mark.parametrize("kind", ["beam", "plate"])
def test_titles_of_a_diagnosis_are_made_of_what_is_drawn(kind: str, verdict: str) -> None:
    made = diagnosis_with(kind, verdict)
    causes = causes_chart(made)
    answers = [c for c in causes.series[0].more["colours"] if c == "blue"]
    assert len(answers) == (len(made.sets) if verdict in ("named", "class") else verdict == "none")
    if verdict == "class":
        assert causes.title.startswith(f"{len(made.sets)} explanations hold")
    closing = closing_chart(made)
    for size in (made.shrink.held_before, made.shrink.held_after, made.shrink.floor):
        assert made.shrink.size(size) in closing.title
    place = place_chart(made, case_of(kind))
    assert place is not None
    found = [one for one in place.series if one.name == "place found"]
    assert bool(found) is (verdict in ("named", "class") and bool(made.where.locations))


def test_hits_that_are_left_out_are_crosses_with_their_reasons() -> None:
    test = hammered(3, 2)
    chart = hits_chart(verdicts_of(test, {(1, 1), (2, 1)}))
    used, left = chart.series
    assert chart.title == "6 hits, 2 left out"
    assert (len(used.y), len(left.y)) == (4, 2)
    assert all(len(text.split("\n")) > 2 for text in left.more["text"])


def test_the_chart_of_the_poles_has_every_pole_once_and_every_mode_above() -> None:
    for model in (model_of(1), model_of(12)):
        origins = pole_origins(model)
        chart = poles_chart(model, origins)
        low, high = model.band
        edge = 0.02 * (high - low)
        near = (model.chart.frequency >= low - edge) & (model.chart.frequency <= high + edge)
        points = [one for one in chart.series if one.kind == "points"]
        top = 1.06 * float(model.chart.orders.max())
        above = [v for one in points for v in np.array(one.y).tolist() if v == top]
        assert sum(len(np.array(one.y)) for one in points) == near.sum() + len(model)
        assert len(above) == len(model)
        assert str(int(near.sum())) in chart.title


def test_frfs_come_the_worst_first_and_their_peaks_stay() -> None:
    model = model_of(12)
    chart = frfs_chart(model)
    assert chart.choices is not None and chart.choices.x is not None
    left = [float(re.findall(r"([\d.]+) % left", name)[0]) for name, _ in chart.choices.items]
    assert left == sorted(left, reverse=True)
    total = np.abs(model.frfs.values).sum(axis=0)
    assert model.frfs.frequency[total.argmax()] in np.array(chart.choices.x)


@given(n=st.integers(1, 200), lines=st.integers(10, 4000), tests=st.integers(1, 5), seed=st.integers(0, 9))
def test_common_lines_keep_ends_and_peaks_and_fit_the_budget(
    n: int, lines: int, tests: int, seed: int
) -> None:
    values = np.random.default_rng(seed).standard_normal((n, lines)) + 0j
    frfs = FrfSet(np.arange(float(lines)), values, tuple(Dof(i + 1, 3) for i in range(n)), (Dof(1, 3),) * n)
    keep, count = common_lines(frfs, 3, tests=tests)
    assert count == min(n, max(1, LARGEST // tests))
    assert {0, lines - 1, int(np.abs(values).sum(axis=0).argmax())} <= set(keep.tolist())
    assert (np.diff(keep) > 0).all()
    assert len(keep) * 3 * count <= max(60_000 / tests, 3 * count * FEWEST) + 6 * count


def test_mac_cells_hold_the_matrix() -> None:
    model = model_of(12)
    chart = auto_mac_chart(model.modal)
    assert chart is not None
    cells = chart.series[0]
    assert np.array(cells.more["value"]).reshape(2 * (len(model),)).diagonal() == pytest.approx(1.0)
    values = np.array([[0.2, np.nan, -1.0]])
    data = matrix_chart("m", "t", "x", values, ["a"], ["p", "q", "r"]).data()["series"][0]
    assert data["value"] == [0.2, None, -1]
    assert data["written"] == ["20", "", "−100"]


def test_indicator_functions_are_those_of_the_room() -> None:
    frfs = model_of(12).frfs
    for word, chart in (("CMIF", cmif_chart(frfs, cmif(frfs))), ("MvMIF", mvmif_chart(frfs, mvmif(frfs)))):
        assert chart.title.startswith(f"{word}: {len(chart.series)} mode indicator function")
    modes = model_of(12).modal.frequency
    first = mvmif(frfs)[1]
    assert all(first[np.abs(first.index - f) < 3 * frfs.df].min() < 0.5 for f in modes)
    np.testing.assert_array_equal(chart.series[0].y, first[first.index > 0])


@given(st.floats(allow_nan=True, allow_infinity=True))
def test_numbers_are_kept_to_five_digits_and_what_is_none_is_none(value: float) -> None:
    (kept,) = rounded([value])
    if not np.isfinite(value):
        assert kept is None
    else:
        assert kept == pytest.approx(value, rel=6e-5, abs=1e-300)


def test_no_text_of_a_file_can_end_the_data_of_a_page() -> None:
    wild = '</script><script>alert(1)</script><!-- & "quoted" ]]>\u2028'
    markup, _ = scripts({"charts": [], "space": {wild: wild}}, space=False)
    block = markup.split("</script>")[0]
    assert "<!--" not in block and block.count("<") == 1
    text = block.partition('id="data">')[2]
    assert json.loads(text) == {"charts": [], "space": {wild: wild}}


def test_every_module_of_a_page_is_there_and_can_stand_in_it() -> None:
    markup, policy = scripts({"charts": [], "space": {}}, space=True)
    named = set(re.findall(r'data-module="([^"]+)"', markup))
    wanted = set(re.findall(r'from\s*"\./([^"]+)"', markup))
    assert wanted <= named
    assert {"page.js", "viewer.js", "three.core.min.js"} <= named
    assert "default-src 'none'" in policy
    drawn, _ = scripts({}, space=False)
    assert len(drawn.encode()) < 60_000 < len(markup.encode()) < 1_000_000


def test_the_data_of_all_charts_can_be_written() -> None:
    made = diagnosis_with("plate", "named")
    for chart in (
        causes_chart(made),
        closing_chart(made),
        gap_chart(errors(AFTER, DOUBT)),
        place_chart(made, case_of("plate")),
    ):
        assert chart is not None
        json.dumps(plain(chart.data()), allow_nan=False)


def test_the_page_asks_for_nothing_that_is_not_in_the_package() -> None:
    root = Path(__file__).resolve().parents[3] / "modalkit"
    for path in [*(root / "views" / "static").glob("*.js"), *(root / "report" / "static").glob("*.js")]:
        text = path.read_text(encoding="utf-8")
        assert not re.search(r"\bfetch\(|XMLHttpRequest|https?://(?!www\.w3\.org)|innerHTML|eval\(", text), (
            path
        )


@pytest.mark.long
def test_the_mesh_of_a_users_own_model_moves_as_its_test_points_do(tmp_path: Path) -> None:
    session = open_study(make_glider(tmp_path / "glider"))
    assert session.identified is not None
    beside = Beside(session, predictor_of(session.case), correlate(session.case))
    page = shapes_page(session.identified.modal, beside)
    surface = page["model"]["surface"]
    row = {tuple(np.round(place, 6)): i for i, place in enumerate(surface["places"])}
    for shape in filter(None, page["model"]["modes"]):
        size = float(np.abs(shape["at_points"]).max())
        for node, place in enumerate(page["places"][: len(page["nodes"]) - page["still"]]):
            measured = shape["at_points"][node] != 0
            own = shape["surface"][row[tuple(np.round(place, 6))]]
            assert own[measured] == pytest.approx(shape["at_points"][node][measured], abs=1e-6 * size)
