"""Figures of a test and its identification: FRFs, hits, stabilisation, MAC."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from figure_cases import hammered, model_of, verdicts_of
from figure_text import assert_legible, panels, words
from hypothesis import given
from hypothesis import strategies as st

from acquisition import Dof, FrfSet, InputError, ModalData
from acquisition.quantities import hertz
from identification import mac, pole_origins
from modalkit.figures import auto_mac_figure, frf_figure, hits_figure, mac_figure, stabilisation_figure
from modalkit.views.charts.frf import pick
from modalkit.views.charts.poles import poles_title


@pytest.mark.parametrize("count", [1, 2, 3, 4, 50])
def test_frfs_show_magnitude_phase_and_coherence(count: int) -> None:
    figure = frf_figure(model_of(12).frfs, model_of(12), count=count)
    shown = min(count, len(model_of(12).frfs.responses))
    for end in ("+Z", "phase [°]", "γ² [-]"):
        assert sum(label.endswith(end) for label in panels(figure)) == shown
    drive = panels(figure)["5+Z / 5+Z"]
    assert drive.get_ylabel() == "|H| [1/kg]"
    assert drive.get_yscale() == "log"
    assert_legible(figure)


def test_frfs_without_fit_and_coherence() -> None:
    bare = replace(model_of(1).frfs, coherence=None, averages=None)
    figure = frf_figure(bare.to("receptance"), count=2)
    assert not any("γ²" in label for label in panels(figure))
    assert "[m/N]" in panels(figure)["5+Z / 5+Z"].get_ylabel()
    assert_legible(figure)


def test_the_fit_drawn_passes_through_the_data() -> None:
    lines = {
        str(line.get_label()): line
        for line in frf_figure(model_of(1).frfs, model_of(1), count=1).axes[0].get_lines()
    }
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


def test_stabilisation_shows_every_pole_of_the_band() -> None:
    for model in (model_of(1), model_of(12)):
        figure = stabilisation_figure(model)
        chart = panels(figure)["poles"]
        low, high = chart.get_xlim()
        inside = (model.chart.frequency >= low) & (model.chart.frequency <= high)
        marks = sum(len(c.get_offsets()) for c in chart.collections)  # type: ignore[arg-type]
        assert marks == np.count_nonzero(inside) + len(model)
        assert chart.get_xlabel() == "frequency [Hz]"
        assert_legible(figure)


def test_every_stable_column_that_is_no_mode_has_its_reason_under_the_chart() -> None:
    model = model_of(12)
    frequency = float(model.modal.frequency[4])
    origins = pole_origins(model)
    (chain,) = (i for i, reason in enumerate(origins.reasons) if reason.kind == "mode" and reason.mode == 4)
    without = replace(
        model,
        modal=model.modal.modes(np.arange(len(model)) != 4),
        poles=np.delete(model.poles, 4),
        constants=np.delete(model.constants, 4, axis=1),
        background_poles=np.append(model.background_poles, model.poles[4]),
    )
    figure = stabilisation_figure(without, drop=[frequency])
    assert "dropped by you: it stays in the fit" in words(figure)
    assert hertz(float(np.median(model.chart.frequency[origins.chain == chain]))) in words(figure)
    assert "1 stable column not taken" in words(figure) or "stable columns not taken" in words(figure)
    assert_legible(figure)


def test_modes_that_the_refinement_added_stand_in_the_chart() -> None:
    model = model_of(12)
    origins = pole_origins(model)
    stated = replace(origins, modes=("refinement", "named", *origins.modes[2:]))
    title = poles_title(stated, 321)
    assert title.startswith(
        f"{len(model)} modes: {len(model) - 2} of 321 poles; 1 added by the refinement; 1 picked by hand"
    )
    figure = stabilisation_figure(model, add=[float(model.modal.frequency[3])])
    markers = {
        str(marks.get_label()): len(marks.get_offsets())  # type: ignore[arg-type]
        for marks in panels(figure)["poles"].collections
    }
    assert markers["mode picked by hand"] == 1
    assert markers["mode from the chart"] == sum(o == "chain" for o in origins.modes) - 1


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
    written = np.where(matrix < 0.005, 0, (100 * matrix).round()).astype(int).ravel()
    assert [int(c) for c in cells] == written[written > 0].tolist()
    assert_legible(figure)


@pytest.mark.parametrize("shape", [(1, 1), (1, 12), (12, 3), (30, 30)])
def test_mac_of_any_size_is_legible(shape: tuple[int, int]) -> None:
    names = [[f"{i + 1}: {100.0 * i:.1f} Hz" for i in range(n)] for n in shape]
    assert_legible(mac_figure(np.full(shape, 0.5), *names, title="Pairs", note="a note"))


def test_mac_refuses_labels_that_do_not_fit() -> None:
    with pytest.raises(InputError, match="give one label each"):
        mac_figure(np.eye(3), ["1"], ["1", "2", "3"])


def test_auto_mac_names_the_modes_of_like_shape() -> None:
    assert_legible(auto_mac_figure(model_of(1).modal))
    shapes = np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 0.1], [0.0, 0.0, 0.0]])
    modal = ModalData(
        frequency=np.array([10.0, 20, 30]),
        frequency_sigma=np.ones(3),
        dofs=tuple(Dof(i, 3) for i in (1, 2, 3)),
        shapes=shapes.astype(complex),
    )
    assert "Modes 1 and 3 are similar (99 %)" in words(auto_mac_figure(modal))
    with pytest.raises(InputError, match="no shapes"):
        auto_mac_figure(ModalData(frequency=np.array([10.0]), frequency_sigma=np.ones(1)))


def test_auto_mac_of_one_degree_of_freedom_claims_nothing() -> None:
    dofs, shapes = (Dof(1, 3),), np.array([[1.0, -2.0]]).astype(complex)
    figure = auto_mac_figure(
        ModalData(frequency=np.array([10.0, 20]), frequency_sigma=np.ones(2), dofs=dofs, shapes=shapes)
    )
    assert "One degree of freedom: there is no shape to compare" in words(figure)
    assert not any(word.strip() == "100" for word in words(figure))
    assert_legible(figure)
