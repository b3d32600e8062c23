"""Figures: what is on them, that nothing written overlaps, and that files are whole."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from blind_outcomes import diagnosis, honest_run, run_of, truth
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure

from acquisition import Dof, FrfSet, Geometry, HammerTest, Hits, HitVerdict, InputError, ModalData
from identification import ModalModel, identify, mac
from modalkit.blind import score
from modalkit.figures import (
    auto_mac_figure,
    blind_figures,
    diagnosis_figure,
    frf_figure,
    hits_figure,
    mac_figure,
    save_figures,
    shapes_figure,
    stabilisation_figure,
    update_figure,
)
from modalkit.figures.blind.confusion import confusion_figure, gathered
from modalkit.figures.diagnosis.errors import mode_errors
from modalkit.figures.style import broken, grouped, shortened, text_width
from modalkit.figures.test.frf import pick
from modalkit.figures.words import answer
from updating import Case, Diagnosis, Material, Measured, Predictor, Spec, Tolerances
from updating.diagnosis.answer.result import (
    Closed,
    Gap,
    NextTest,
    ParameterEstimate,
    Ranked,
    Shrink,
    Where,
    Zone,
)
from updating.models.state import State

# --- what is written where ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Written:
    text: str
    box: tuple[float, float, float, float]


class Reader(RendererAgg):
    """A renderer that keeps where every line of text was drawn, in pixels from the top left."""

    def __init__(self, figure: Figure) -> None:
        width, height = figure.get_size_inches() * figure.dpi
        super().__init__(int(width), int(height), figure.dpi)
        self.written: list[Written] = []

    def draw_text(self, gc, x, y, s, prop, angle, ismath=False, mtext=None):  # type: ignore[no-untyped-def]
        wide, tall, below = self.get_text_width_height_descent(s, prop, ismath)
        box = (
            (x - tall + below, y - wide, x + below, y)
            if angle == 90
            else (x, y - tall + below, x + wide, y + below)
        )
        self.written.append(Written(s, box))
        super().draw_text(gc, x, y, s, prop, angle, ismath, mtext)


def read(figure: Figure) -> list[Written]:
    reader = Reader(figure)
    figure.draw(reader)
    return [w for w in reader.written if w.text.strip()]


def assert_legible(figure: Figure) -> None:
    """No text outside the figure, no two texts over each other (2 px of grace for the boxes' own air)."""
    written = read(figure)
    assert written
    wide, tall = figure.get_size_inches() * figure.dpi
    for w in written:
        left, top, right, bottom = w.box
        assert left >= -1 and top >= -1 and right <= wide + 1 and bottom <= tall + 1, f"outside: {w}"
    for i, a in enumerate(written):
        for b in written[:i]:
            over = min(a.box[2], b.box[2]) - max(a.box[0], b.box[0])
            down = min(a.box[3], b.box[3]) - max(a.box[1], b.box[1])
            assert over <= 2 or down <= 2, f"{a} overlaps {b}"


def test_the_check_of_legibility_finds_what_it_is_for() -> None:
    figure = Figure(figsize=(4, 3))
    figure.text(0.3, 0.5, "one")
    assert_legible(figure)
    figure.text(0.33, 0.51, "another", rotation=90)
    with pytest.raises(AssertionError, match="overlaps"):
        assert_legible(figure)
    beyond = Figure(figsize=(4, 3))
    beyond.text(0.9, 0.5, "too far to the right")
    with pytest.raises(AssertionError, match="outside"):
        assert_legible(beyond)


def panels(figure: Figure) -> dict[str, Axes]:
    return {str(axes.get_label()): axes for axes in figure.axes}


def words(figure: Figure) -> str:
    return " ".join(w.text for w in read(figure))


# --- things to draw ----------------------------------------------------------------------------------


def model_of(modes: int, *, points: int = 5) -> ModalModel:
    """Identify analytic FRFs of a row of points, no two modes closer than the spacing of the axis allows."""
    frequency = np.linspace(40.0, 40.0 + 45.0 * modes, modes)
    x = np.linspace(0.1, 1.0, points)
    shapes = np.sin(np.outer(x, 2.6 * np.arange(1, modes + 1)))
    line = np.arange(0.0, frequency[-1] + 60.0, 0.5)
    s = 2j * np.pi * line
    w = 2 * np.pi * frequency
    h = np.zeros((points, len(line)), dtype=complex)
    for r in range(modes):
        h += np.outer(shapes[:, r] * shapes[-1, r], s**2 / (s**2 + 2 * 0.005 * w[r] * s + w[r] ** 2))
    noise = np.random.default_rng(1).standard_normal((2, *h.shape))
    h += 1e-3 * (noise[0] + 1j * noise[1])
    dofs = tuple(Dof(i + 1, 3) for i in range(points))
    place = Geometry(tuple(range(1, points + 1)), np.c_[x, 0 * x, 0 * x])
    frfs = FrfSet(
        line,
        h,
        dofs,
        (dofs[-1],) * points,
        coherence=np.full(h.shape, 0.98),
        averages=np.full(points, 4),
        geometry=place,
    )
    return identify(frfs, band=(15.0, float(line[-1])))


@pytest.fixture(scope="module")
def one() -> ModalModel:
    return model_of(1)


@pytest.fixture(scope="module")
def twelve() -> ModalModel:
    return model_of(12)


def hammered(points: int, hits: int) -> HammerTest:
    rng = np.random.default_rng(3)
    time = np.arange(1024) / 4096
    pulse = np.where((time > 0.01) & (time < 0.012), np.sin(np.pi * (time - 0.01) / 0.002) ** 2, 0.0)
    rows = []
    for i in range(points):
        force = pulse * rng.uniform(50, 150, (hits, 1)) + 0.05 * rng.standard_normal((hits, 1024))
        rows.append(Hits(Dof(i + 1, 3), (Dof(1, 3),), force, rng.standard_normal((hits, 1, 1024))))
    return HammerTest(4096.0, tuple(rows))


def verdicts_of(test: HammerTest, bad: set[tuple[int, int]]) -> list[HitVerdict]:
    return [
        HitVerdict(
            point.reference,
            hit,
            (point.reference.node, hit) not in bad,
            ("double hit: a second pulse of 43 % after 5.1 ms",)
            if (point.reference.node, hit) in bad
            else (),
            float(point.force[hit - 1].max()),
            2e-3,
            600.0,
            900.0,
        )
        for point in test.points
        for hit in range(1, point.count + 1)
    ]


def spec_of(kind: str) -> Spec:
    steel = Material(210e9, 7850.0)
    if kind == "beam":
        return Spec("beam", 0.4, 0.03, 0.005, (24,), ("x0",), "euler-bernoulli", steel)
    return Spec("plate", 0.4, 0.25, 0.003, (12, 8), ("x0",), "kirchhoff", steel)


def case_of(kind: str, *, modes: int = 5, factor: float = 1.0) -> Case:
    """A test whose modulus is ``factor`` times the model's, measured without error."""
    spec = spec_of(kind)
    if kind == "beam":
        points = np.linspace(0.08, 0.4, 8)[:, None]
    else:
        points = np.stack(np.meshgrid(np.linspace(0.1, 0.4, 5), [0.0, 0.08, 0.17, 0.25]), axis=-1).reshape(
            -1, 2
        )
    n = len(points)
    blank = Measured(
        np.linspace(20, 900, modes),
        np.ones(modes),
        np.full(modes, np.nan),
        np.full(modes, np.nan),
        points,
        tuple(range(1, n + 1)),
        np.full(n, n - 1),
        np.arange(n),
        np.ones((n, modes)),
        np.ones((n, modes)),
        True,
    )
    truth = Predictor(spec, blank).predict(State(factors={"E": factor}), count=modes)
    measured = replace(
        blank,
        frequency=truth.frequency,
        frequency_sigma=1e-4 * truth.frequency,
        constants=truth.constants,
        constants_sigma=0.01 * np.abs(truth.constants).max(axis=0) * np.ones((n, 1)),
    )
    return Case("A case", spec, measured, tolerances=Tolerances({"E": 0.01, "thickness": 0.005}))


EFFECTS = (
    "E",
    "density",
    "length",
    "thickness",
    "clamp_rotation",
    "sensor_mass",
    "local_stiffness",
    "fluid_added_mass",
)
PLACES = {"clamp_rotation", "sensor_mass", "local_stiffness"}


def diagnosis_of(
    kind: str,
    *,
    verdict: str = "named",
    first: str = "local_stiffness",
    modes: int = 5,
    place: tuple[float, float, float] | None = (0.13, 0.05, 0.0),
    sets: int = 3,
) -> Diagnosis:
    """A diagnosis made up by hand; the values are those of nothing."""
    order = [first, *(e for e in EFFECTS if e != first)]
    share_of = np.array([0.6**i for i in range(len(order))])
    share_of *= 0.98 / share_of.sum()
    estimate = ParameterEstimate(0.0121, "kg", 0.0115, 0.0126, False)
    long = {f"{first}.{n}": replace(estimate, unit="m") for n in ("x", "extent", "loss", "compliance")}
    ranking = tuple(
        Ranked(
            (e,),
            float(p),
            (),
            long if i == 0 and e == "local_stiffness" else {f"{e}.mass": estimate},
            True,
            0.4,
        )
        for i, (e, p) in enumerate(zip(order, share_of, strict=True))
    )
    count = {"named": 1, "class": sets, "unknown": 0, "none": 0}[verdict]
    frequency = np.linspace(20, 1800, modes)
    error = np.linspace(-3, 5, modes)
    table = pd.DataFrame({"test [Hz]": frequency, "error [%]": error, "sigma [%]": np.full(modes, 0.1)})
    spec = spec_of(kind)
    weights = np.arange(1.0, len(spec.regions) + 1) ** 4
    zones = tuple(
        Zone(r.name, (sum(r.x) / 2, 0.0 if r.y is None else sum(r.y) / 2, 0.0), float(p))
        for r, p in zip(spec.regions, weights / weights.sum(), strict=True)
    )
    if place is not None and kind == "beam":
        place = (place[0], 0.0, 0.0)
    seated = place if verdict != "none" else None
    channel = "none" if verdict == "none" else "stiffness"
    where = Where(
        channel,
        {"stiffness": 0.9, "mass": 0.08, "damping": 0.0, "measurement": 0.02, "none": 0.0},
        seated,
        () if seated is None else (seated,),
        (),
        zones,
    )
    measure = "weigh the specimen and measure its thickness, to 0.1 %"
    return Diagnosis(
        "A cantilever",
        verdict != "none",
        0.4 if verdict == "none" else 1e-12,
        Gap(table, 3.2, 0.1, np.ones(3)),
        where,
        Shrink("frequency", 3.2, 0.05, 3.2, 0.07, 2.1, 2.4, 0.06, Closed(99.0, 95.0, 100.0)),
        verdict,  # type: ignore[arg-type]
        tuple(r.effects for r in ranking[:count]),
        ranking,
        (NextTest(measure, ("E", "density"), 31.0), NextTest(measure, ("E", "thickness"), 12.0))
        if verdict == "class"
        else (),
        (),
        {},
    )


# --- the diagnosis -----------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["beam", "plate"])
@pytest.mark.parametrize("verdict", ["named", "class", "unknown", "none"])
def test_diagnosis_is_legible_for_every_verdict(kind: str, verdict: str) -> None:
    figure = diagnosis_figure(diagnosis_of(kind, verdict=verdict))
    assert {"gap", "causes", "where", "channels", "held out", "next"} <= set(panels(figure))
    assert_legible(figure)


@pytest.mark.parametrize("modes", [1, 12])
def test_diagnosis_names_every_mode(modes: int) -> None:
    figure = diagnosis_figure(diagnosis_of("beam", modes=modes))
    assert len(panels(figure)["gap"].get_yticks()) == modes
    assert_legible(figure)


@given(
    kind=st.sampled_from(["beam", "plate"]),
    x=st.floats(0.0, 0.4),
    y=st.floats(0.0, 0.25),
    first=st.sampled_from(EFFECTS),
    sets=st.integers(2, 8),
)
@settings(max_examples=6, deadline=None)
def test_diagnosis_is_legible_wherever_the_cause_sits(
    kind: str, x: float, y: float, first: str, sets: int
) -> None:
    place = (x, y if kind == "plate" else 0.0, 0.0)
    verdict = "named" if sets == 2 else "class"
    assert_legible(diagnosis_figure(diagnosis_of(kind, verdict=verdict, first=first, place=place, sets=sets)))


@pytest.mark.parametrize("kind", ["beam", "plate"])
def test_diagnosis_with_its_case_shows_points_and_sensor(kind: str) -> None:
    case = case_of(kind, factor=0.9)
    estimate = {"E.factor": ParameterEstimate(0.9, "-", 0.89, 0.91, False)}
    given_by_hand = diagnosis_of(kind, first="E", place=None)
    ranking = (replace(given_by_hand.ranking[0], parameters=estimate), *given_by_hand.ranking[1:])
    figure = diagnosis_figure(replace(given_by_hand, ranking=ranking), case)
    assert_legible(figure)
    text = words(figure)
    assert "test points" in text and "sensor" in text and "acts on all of it" in text


def test_errors_before_and_after_are_those_of_the_modulus() -> None:
    case = case_of("beam", factor=0.9, modes=2)  # which this mesh leaves no doubt in
    row = Ranked(("E",), 0.9, (), {"E.factor": ParameterEstimate(0.9, "-", 0.89, 0.91, False)}, True, 0.5)
    errors = mode_errors(replace(diagnosis_of("beam", first="E"), ranking=(row,)), case)
    assert errors.before == pytest.approx(100 * (1 / np.sqrt(0.9) - 1), abs=1e-6)
    assert errors.after is not None
    assert np.abs(errors.after).max() < 1e-6
    # noise alone: identification 1e-4 and re-mounting 5e-4, two standard deviations, in per cent
    assert errors.floor == pytest.approx(200 * np.hypot(1e-4, 5e-4))
    # a doubt of 1 % in E moves frequencies by 0.5 %, one of 0.5 % in thickness by 0.5 %
    assert errors.doubt == pytest.approx(200 * np.sqrt(2 * 0.005**2 + 1e-8 + 25e-8), rel=1e-6)


def test_errors_without_a_case_are_those_of_the_table() -> None:
    diagnosis = diagnosis_of("beam")
    errors = mode_errors(diagnosis)
    assert errors.after is None
    assert errors.before.tolist() == diagnosis.gap.modes["error [%]"].tolist()


def test_answers_say_the_verdict() -> None:
    assert answer(diagnosis_of("beam")) == "A soft spot at x = 130 mm explains the gap"
    assert "at x = 130, y = 50 mm" in answer(diagnosis_of("plate"))
    mass = answer(diagnosis_of("beam", first="sensor_mass"))
    assert (
        mass.replace("\N{NO-BREAK SPACE}", " ")
        == "The mass of the sensor explains the gap: 12.1 g (95 %: 11.5 to 12.6)"
    )
    assert "cannot tell which" in answer(diagnosis_of("beam", verdict="class", first="E"))
    assert "nothing in the library" in answer(diagnosis_of("beam", verdict="unknown"))
    assert answer(diagnosis_of("beam", verdict="none")).startswith("No gap")


# --- test and identification -------------------------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 4, 50])
def test_frfs_show_magnitude_phase_and_coherence(twelve: ModalModel, count: int) -> None:
    figure = frf_figure(twelve.frfs, twelve, count=count)
    shown = min(count, len(twelve.frfs.responses))
    for name in ("magnitude", "phase", "coherence"):
        assert sum(label.startswith(name) for label in panels(figure)) == shown
    drive = panels(figure)["magnitude 5+Z / 5+Z"]
    assert drive.get_ylabel() == "|H| [1/kg]"
    assert drive.get_yscale() == "log"
    assert_legible(figure)


def test_frfs_without_fit_and_coherence(one: ModalModel) -> None:
    bare = replace(one.frfs, coherence=None, averages=None)
    figure = frf_figure(bare.to("receptance"), count=2)
    assert not any(label.startswith("coherence") for label in panels(figure))
    assert "[m/N]" in panels(figure)["magnitude 5+Z / 5+Z"].get_ylabel()
    assert_legible(figure)


def test_the_fit_drawn_passes_through_the_data(one: ModalModel) -> None:
    lines = {str(line.get_label()): line for line in frf_figure(one.frfs, one, count=1).axes[0].get_lines()}
    measured, fit = (np.asarray(lines[name].get_ydata(), dtype=float) for name in ("measured", "fit"))
    at = np.asarray(lines["measured"].get_xdata())
    there = np.interp(np.asarray(lines["fit"].get_xdata()), at, measured)
    assert np.abs(fit - there).max() < 0.02 * measured.max()
    assert (
        lines["measured"].get_linewidth() > 2 * lines["fit"].get_linewidth()
    )  # seen on both sides of the fit
    assert lines["measured"].get_zorder() < lines["fit"].get_zorder()


@given(n=st.integers(1, 30), count=st.integers(1, 12), drive=st.integers(0, 29))
def test_choice_of_frfs_holds_the_drive_point(n: int, count: int, drive: int) -> None:
    dofs = tuple(Dof(i + 1, 3) for i in range(n))
    at = drive % n
    frfs = FrfSet(np.arange(2.0), np.ones((n, 2)), dofs, (dofs[at],) * n)
    chosen = pick(frfs, count)
    assert chosen[0] == at
    assert len(chosen) == len(set(chosen)) == min(n, count)


def test_stabilisation_shows_every_pole_of_the_band(twelve: ModalModel, one: ModalModel) -> None:
    for model in (one, twelve):
        figure = stabilisation_figure(model)
        chart = panels(figure)["chart"]
        inside = (model.chart.frequency >= model.band[0]) & (model.chart.frequency <= model.band[1])
        assert sum(len(c.get_offsets()) for c in chart.collections) == np.count_nonzero(inside)  # type: ignore[arg-type]
        assert chart.get_xlabel() == "frequency [Hz]"
        assert_legible(figure)


@pytest.mark.parametrize(("points", "hits"), [(1, 1), (5, 4), (60, 3)])
@pytest.mark.parametrize("bad", [set(), {(1, 1)}, {(i, 1) for i in range(1, 21)}])
def test_hits_list_what_is_rejected(points: int, hits: int, bad: set[tuple[int, int]]) -> None:
    test = hammered(points, hits)
    figure = hits_figure(test, verdicts_of(test, bad))
    rejected = sum(node <= points for node, _ in bad)
    assert ("Not to be used" in words(figure)) == (rejected > 0)
    assert words(figure).count("double hit") == min(rejected, 10)
    assert {"pulses", "spectra", "peaks"} <= set(panels(figure))
    assert_legible(figure)


def test_hits_without_verdicts_count_as_used() -> None:
    assert "8 hits at 2 points, all of them used" in words(hits_figure(hammered(2, 4)))


def test_mac_writes_its_values(rng: np.random.Generator) -> None:
    a, b = rng.standard_normal((2, 6, 3))
    matrix = mac(a, b)
    figure = mac_figure(matrix, ["1", "2", "3"], ["a", "b", "c"])
    cells = [t.get_text() for t in panels(figure)["matrix"].texts]
    assert [int(c or 0) for c in cells] == np.where(matrix < 0.005, 0, (100 * matrix).round()).astype(
        int
    ).ravel().tolist()
    assert_legible(figure)


@pytest.mark.parametrize("shape", [(1, 1), (1, 12), (12, 3), (30, 30)])
def test_mac_of_any_size_is_legible(shape: tuple[int, int]) -> None:
    names = [[f"{i + 1}: {100.0 * i:.1f} Hz" for i in range(n)] for n in shape]
    assert_legible(mac_figure(np.full(shape, 0.5), *names, title="Pairs", note="a note"))


def test_mac_refuses_labels_that_do_not_fit() -> None:
    with pytest.raises(InputError, match="give one label each"):
        mac_figure(np.eye(3), ["1"], ["1", "2", "3"])


def test_auto_mac_names_the_modes_that_look_alike(one: ModalModel) -> None:
    assert_legible(auto_mac_figure(one.modal))
    shapes = np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 0.1], [0.0, 0.0, 0.0]])
    modal = ModalData(
        np.array([10.0, 20, 30]),
        np.ones(3),
        dofs=tuple(Dof(i, 3) for i in (1, 2, 3)),
        shapes=shapes.astype(complex),
    )
    assert "Modes 1 and 3 look alike by 99 %" in words(auto_mac_figure(modal))
    with pytest.raises(InputError, match="no shapes"):
        auto_mac_figure(ModalData(np.array([10.0]), np.ones(1)))


def test_auto_mac_of_one_degree_of_freedom_claims_nothing() -> None:
    dofs, shapes = (Dof(1, 3),), np.array([[1.0, -2.0]]).astype(complex)
    figure = auto_mac_figure(ModalData(np.array([10.0, 20]), np.ones(2), dofs=dofs, shapes=shapes))
    assert "One degree of freedom: there is no shape to compare" in words(figure)
    assert not any(word.strip() == "100" for word in words(figure))
    assert_legible(figure)


# --- shapes ------------------------------------------------------------------------------------------


def test_shapes_of_identified_modes(one: ModalModel, twelve: ModalModel) -> None:
    for model in (one, twelve):
        figure = shapes_figure(model.modal)
        assert len(figure.axes) == len(model)
        assert_legible(figure)


@pytest.mark.parametrize("kind", ["beam", "plate"])
@pytest.mark.parametrize("modes", [1, 5])
def test_shapes_over_the_model(kind: str, modes: int) -> None:
    case = case_of(kind, modes=modes)
    figure = shapes_figure(case.measured, Predictor(case.spec, case.measured))
    assert len(figure.axes) == modes
    assert_legible(figure)
    assert_legible(shapes_figure(case.measured))


def test_the_curve_of_a_perfect_model_passes_through_the_points() -> None:
    case = case_of("beam", modes=3)
    for axes in shapes_figure(case.measured, Predictor(case.spec, case.measured)).axes:
        curve = next(line for line in axes.get_lines() if len(np.asarray(line.get_xdata())) > 50)
        dots = next(line for line in axes.get_lines() if line.get_marker() == "o")
        x, y = np.asarray(dots.get_xdata(), dtype=float), np.asarray(dots.get_ydata(), dtype=float)
        there = np.interp(
            x, np.asarray(curve.get_xdata(), dtype=float), np.asarray(curve.get_ydata(), dtype=float)
        )
        assert np.abs(y).max() == pytest.approx(1.0)
        assert there == pytest.approx(y, abs=2e-3)


def plate_modes(nodes: list[int], lines: list[tuple[int, int]] | None = None) -> ModalData:
    """Return a bending and a torsion mode at points of a grid of 4 by 3, numbered along x."""
    place = np.array([[0.1 * ((n - 1) % 4), 0.1 * ((n - 1) // 4), 0.0] for n in nodes])
    along, across = np.cos(np.pi * place[:, 0] / 0.3), np.cos(np.pi * place[:, 1] / 0.2)
    return ModalData(
        np.array([100.0, 200.0]),
        np.ones(2),
        dofs=tuple(Dof(n, 3) for n in nodes),
        shapes=np.stack([along, along * across], axis=1).astype(complex),
        geometry=Geometry(tuple(nodes), place, lines=np.array(lines or np.zeros((0, 2)), int)),
    )


def test_shapes_are_drawn_with_the_lines_of_the_geometry() -> None:
    bare, joined = (shapes_figure(plate_modes(list(range(1, 13)), j)) for j in (None, [(1, 2), (2, 6)]))
    for without, with_lines in zip(bare.axes, joined.axes, strict=True):
        assert len(with_lines.get_lines()) == len(without.get_lines()) + 2
    beam = shapes_figure(plate_modes([1, 2, 3, 4], [(1, 2), (3, 4)]))
    segments = [line for line in beam.axes[0].get_lines() if line.get_alpha() == 0.5]
    assert [np.asarray(line.get_xdata()).tolist() for line in segments] == [
        [0.0, 0.1],
        [0.2, pytest.approx(0.3)],
    ]


@pytest.mark.parametrize("gone", [[], [6]])
def test_shapes_of_a_plate_fill_full_grids_and_others(gone: list[int]) -> None:
    figure = shapes_figure(plate_modes([n for n in range(1, 13) if n not in gone]))
    assert all(len(axes.collections) >= 2 for axes in figure.axes)
    assert_legible(figure)


def test_one_point_has_no_shape_to_draw() -> None:
    modal = ModalData(np.array([10.0]), np.ones(1), dofs=(Dof(1, 3),), shapes=np.ones((1, 1)).astype(complex))
    figure = shapes_figure(modal)
    assert "1 mode at one test point: there is no shape to draw" in words(figure)
    assert not figure.axes


def test_shapes_where_no_point_has_a_place() -> None:
    modal = ModalData(
        np.array([10.0]),
        np.ones(1),
        dofs=(Dof(1, 3), Dof(2, 3)),
        shapes=np.array([[1.0], [0.5]]).astype(complex),
    )
    figure = shapes_figure(modal)
    assert figure.axes[0].get_xlabel() == "test point"
    with pytest.raises(InputError, match="no shapes"):
        shapes_figure(ModalData(np.array([10.0]), np.ones(1)))


# --- updating and the blind run ----------------------------------------------------------------------


@pytest.mark.parametrize("modes", [1, 12])
@pytest.mark.parametrize("parameters", [None, {"E": (0.93, 0.004), "zone10.thickness": (1.2, np.nan)}])
def test_update_shows_errors_and_factors(
    modes: int, parameters: dict[str, tuple[float, float]] | None
) -> None:
    frequency = np.linspace(20, 2000, modes)
    figure = update_figure(
        frequency, np.full(modes, 4.0), np.full(modes, -0.5), sigma=np.full(modes, 0.1), parameters=parameters
    )
    assert "from 4 % to 0.5 % r.m.s." in words(figure)
    assert ("parameters" in panels(figure)) == (parameters is not None)
    assert_legible(figure)


def test_update_refuses_arrays_that_do_not_fit() -> None:
    with pytest.raises(InputError, match="one of each per mode"):
        update_figure(np.ones(3), np.ones(2), np.ones(3))


@pytest.mark.parametrize(("trials", "leave_out"), [(12, False), (60, False), (60, True), (1000, False)])
def test_blind_run_is_legible(trials: int, leave_out: bool) -> None:
    figures = blind_figures(score(honest_run(trials, 5, leave_out=leave_out)))
    assert {"blind_rates", "blind_confusion", "blind_abstention"} <= figures.keys()
    for figure in figures.values():
        assert_legible(figure)


def test_blind_confusion_shares_classes_and_gathers_pairs() -> None:
    result = score(
        run_of(
            (truth("E"), diagnosis("named", ("E",))),
            (truth("E"), diagnosis("class", ("E",), ("density",), others=[("length",)])),
            (truth("E", "length"), diagnosis("named", ("E", "length"))),
            (truth("E", "shear"), diagnosis("named", ("density", "shear"))),
            (truth("taper"), diagnosis("unknown")),
            (truth(), diagnosis("none")),
        )
    )
    counts = gathered(result.answers)
    assert counts.rows == ["E", "pairs", "taper", "none"]
    assert counts.columns == ["E", "density", "the pair", "other pair", "unknown", "none"]
    assert counts.trials.tolist() == [
        [1.5, 0.5, 0, 0, 0, 0],
        [0, 0, 1, 1, 0, 0],
        [0, 0, 0, 0, 1, 0],
        [0, 0, 0, 0, 0, 1],
    ]
    assert [(i, counts.columns[j]) for i, j in np.argwhere(counts.right)] == [
        (0, "E"),
        (1, "the pair"),
        (2, "unknown"),
        (3, "none"),
    ]
    figure = blind_figures(result)["blind_confusion"]
    assert "4 of 6 blind trials answered truly" in words(figure)


def test_blind_curves_show_what_they_are_given() -> None:
    result = score(honest_run(300, 8))
    figures = blind_figures(result)
    rule = result.abstention.rule
    assert f"{rule['count']} of {rule['total']} right" in words(figures["blind_abstention"])
    curve = panels(figures["blind_abstention"])["abstention"].get_lines()[0]
    np.testing.assert_allclose(curve.get_ydata(), 100 * result.abstention.curve["right"])
    dots = panels(figures["blind_reliability"])["reliability"].collections[-1].get_offsets()
    np.testing.assert_allclose(dots, 100 * result.reliability[["stated", "rate"]].to_numpy())
    covered = result.severity["covered"].astype(bool)
    assert f"{covered.sum()} of {len(covered)} parameters" in words(figures["blind_severity"])


def test_blind_figures_leave_out_what_the_run_has_nothing_for() -> None:
    figures = blind_figures(score(run_of((truth("taper"), None))))
    assert set(figures) == {"blind_rates", "blind_confusion"}
    for figure in figures.values():
        assert_legible(figure)
    with pytest.raises(InputError, match="no trials"):
        confusion_figure(pd.DataFrame())


# --- style, words, files -----------------------------------------------------------------------------


@given(st.lists(st.floats(0, 100), min_size=1, max_size=30), st.floats(0.5, 20))
def test_labels_stand_apart(places: list[float], spacing: float) -> None:
    places = sorted(places)
    groups = grouped(places, spacing)
    assert [i for group in groups for i in group] == list(range(len(places)))
    middles = [np.mean([places[i] for i in group]) for group in groups]
    assert all(b - a > 0 for a, b in pairwise(middles))


@given(st.text("abcdef ghij", min_size=1, max_size=80), st.floats(60, 400))
def test_text_is_broken_and_shortened_to_its_room(text: str, room: float) -> None:
    lines = broken(text, room, 11)
    assert " ".join(lines).split() == text.split()
    assert all(text_width(line, 11) <= room or " " not in line for line in lines)
    assert text_width(shortened(text, room, 11), 11) <= room


def test_files_are_whole_and_nothing_else_is_left(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "figures"
    figure = mac_figure(np.eye(2), ["1", "2"], ["1", "2"])
    files = save_figures({"mac": figure, "again": figure}, folder)
    assert files == [folder / "mac.png", folder / "again.png"]
    assert sorted(p.name for p in folder.iterdir()) == ["again.png", "mac.png"]
    assert all(
        p.read_bytes().startswith(b"\x89PNG") and p.read_bytes().endswith(b"IEND\xaeB`\x82") for p in files
    )


def test_files_that_cannot_be_written(tmp_path: Path) -> None:
    figure = mac_figure(np.eye(2), ["1", "2"], ["1", "2"])
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    with pytest.raises(InputError, match="give another folder"):
        save_figures({"mac": figure}, blocked)
    with pytest.raises(InputError, match="plain file name"):
        save_figures({"../mac": figure}, tmp_path)
