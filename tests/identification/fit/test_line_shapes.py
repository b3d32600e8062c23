"""FRFs averaged with a Hann window, FRFs on lines far apart, and FRFs without any window."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, FrfSet
from acquisition.form import FORMS
from acquisition.frfs.line_shape import LineShape
from identification import identify, line_shapes
from identification.fit.course import course_of
from identification.fit.equations.basis import Axis
from identification.fit.equations.residues import Residues, synthesise
from identification.fit.fit import fit_candidates
from identification.fit.noise.leakage import leaked, shared
from identification.fit.noise.levels import local_mean
from identification.line_shapes import fit_shaped, worth_asking
from identification.uncertainty.line_scatter import line_factors

HERTZ = np.array([63.6, 81.5, 97.0, 115.0, 129.0, 142.0])


def structure(damping, seed=0):
    """Return poles [rad/s] and residues of six FRFs [m/(N s)]."""
    poles = 2 * np.pi * HERTZ * (-damping + 1j * np.sqrt(1 - damping**2))
    shapes = np.random.default_rng(seed).standard_normal((6, 6))
    shapes[0] = np.sign(shapes[0]) * np.maximum(np.abs(shapes[0]), 0.5)
    return poles, shapes * shapes[0] / (2j * poles.imag)


def response(poles, residues, s, form="accelerance"):
    """Return FRFs at points of the Laplace plane."""
    both = residues @ (1 / (s - poles[:, None])) + residues.conj() @ (1 / (s - poles.conj()[:, None]))
    return s ** FORMS.index(form) * both


def frf_set(frequency, values, form="accelerance"):
    dofs = tuple(Dof(i + 1, 3) for i in range(len(values)))
    return FrfSet(frequency, values, dofs, (dofs[0],) * len(values), form=form)


def noisy(values, relative, rng):
    size = relative * np.sqrt(np.mean(np.abs(values) ** 2, axis=1, keepdims=True) / 2)
    return values + size * (rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape))


def welch(
    poles, residues, *, df, rate, blocks, seed, form="accelerance", band=(40, 160), corner=np.inf, noise=0.0
):
    """Average FRFs of a random force over half-overlapping Hann blocks of 1/df, with numpy alone.

    The power of the force falls with the sixth power of frequency above the corner [Hz]; both signals have white noise
    of a part of their r.m.s. The coherence goes with them.
    """
    rng, samples = np.random.default_rng(seed), round(rate / df)
    length = samples * (blocks + 4)
    force = np.fft.rfft(rng.standard_normal(length))
    s = 2j * np.pi * np.fft.rfftfreq(length, 1 / rate)[1:]
    force[1:] /= np.sqrt(1 + (np.abs(s) / (2 * np.pi * corner)) ** 6)
    window = 0.5 - 0.5 * np.cos(2 * np.pi * np.arange(samples) / samples)
    starts = np.arange(4 * samples, length - samples + 1, samples // 2)
    kept = slice(round(band[0] / df), round(band[1] / df))

    def spectra(line):
        wave = np.fft.irfft(line, length)
        wave = wave + noise * np.std(wave) * rng.standard_normal(length)
        return np.array([np.fft.rfft(window * wave[a : a + samples])[kept] for a in starts])

    push = spectra(force)
    motion = [spectra(np.append(0.0, h) * force) for h in response(poles, residues, s, form)]
    power = np.sum(np.abs(push) ** 2, axis=0)
    values = np.array([np.sum(m * push.conj(), axis=0) / power for m in motion])
    coherence = np.abs(values) ** 2 * power / [np.sum(np.abs(m) ** 2, axis=0) for m in motion]
    frfs = frf_set(np.arange(kept.start, kept.stop) * df, values, form)
    return frfs if noise == 0.0 else replace(frfs, coherence=coherence)


def check(model, damping, *, off, sigmas=4.5):
    """See that all six modes are found and no other, near the truth and within their intervals."""
    assert len(model) == 6, model.table()
    modal = model.modal
    assert modal.frequency == pytest.approx(HERTZ, rel=off * damping)
    assert modal.damping == pytest.approx(damping, rel=off)
    assert np.max(np.abs(modal.frequency - HERTZ) / modal.frequency_sigma) < sigmas
    assert np.max(np.abs(modal.damping - damping) / modal.damping_sigma) < sigmas


@pytest.mark.long
@pytest.mark.parametrize("form", ["accelerance", "mobility"])
def test_hann_averages_whose_peaks_are_a_line_wide(form):
    frfs = welch(*structure(0.005), df=0.5, rate=400.0, blocks=200, seed=3, form=form)
    model = identify(frfs)
    check(model, 0.005, off=0.05)
    assert any("Hann window" in w and "state frf_window" in w for w in model.warnings)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("stated", [False, True])
def test_noise_that_grows_where_the_force_gets_weak_does_not_deny_the_window(seed, stated):
    """A force 30 dB down at the end leaves more noise there: with one level for all lines no window fits."""
    damping = 0.005
    frfs = welch(
        *structure(damping),
        df=0.5,
        rate=1600.0,
        blocks=200,
        seed=seed,
        band=(40, 700),
        corner=200.0,
        noise=0.01,
    )
    model = identify(frfs if stated else replace(frfs, coherence=None))
    assert model.frfs.line_shape is not None and model.frfs.line_shape.kind == "averaged"
    check(model, damping, off=0.05)


@pytest.mark.long
def test_a_window_that_is_stated_or_denied():
    frfs = welch(*structure(0.005), df=0.5, rate=400.0, blocks=200, seed=4)
    stated = identify(replace(frfs, window="hann"))
    check(stated, 0.005, off=0.05)
    assert any("Hann window" in w and "state" not in w for w in stated.warnings)
    assert identify(replace(frfs, window="none")).frfs.line_shape is None


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_peaks_far_narrower_than_lines_beside_broad_ones(seed):
    """What rings for many blocks errs by the size of its peak, and would carry the choice of the line shape."""
    damping = np.array([0.0006, 0.004, 0.0008, 0.006, 0.005, 0.004])
    poles, residues = structure(damping, seed)
    model = identify(welch(poles, residues, df=0.8, rate=400.0, blocks=60, seed=seed))
    modal = model.modal
    assert len(model) == 6, model.table()
    assert np.max(np.abs(modal.frequency - HERTZ) / modal.frequency_sigma) < 3.0
    assert np.max(np.abs(modal.damping - damping) / modal.damping_sigma) < 3.0
    assert np.max(model.modal.frequency_sigma / HERTZ) < 1e-3


def test_errors_by_leakage_follow_the_law():
    """The power that true poles leave is one number times what the law gives, in all FRFs together."""
    poles, residues = structure(np.array([0.001, 0.004, 0.002, 0.006, 0.005, 0.004]))
    frfs = welch(poles, residues, df=0.8, rate=400.0, blocks=200, seed=0)
    shaped = replace(frfs, line_shape=LineShape("averaged", 1 / 0.8))
    linear = Residues(residues, np.zeros((6, 2)), (-2, 0))
    left = frfs.values - synthesise(Axis.of(shaped), poles, linear)
    law = leaked(shaped, poles, residues)
    near = np.abs(frfs.frequency[:, None] - HERTZ).min(axis=1) < 3.0
    ratio = (np.abs(left) ** 2 / np.abs(law) ** 2)[:, near]
    assert 1 / np.mean(ratio) == pytest.approx(400, rel=0.3)  # blocks overlap by half
    assert np.std(np.log(local_mean(ratio, 9))) < 0.6
    variance = np.abs(law) ** 2 / 400
    assert shared(law, left, variance) * 400 > 0.7
    alone = np.abs(left) * np.exp(2j * np.pi * np.random.default_rng(0).random(left.shape))
    assert shared(law, alone, variance) * 400 < 0.1


@pytest.mark.long
def test_a_stated_window_counts_beside_a_drift():
    poles, residues = structure(0.004)
    shape, frequency = LineShape("averaged", 4.0), np.arange(40.0, 160.0, 0.25)
    residues = np.tile(residues, (2, 1))
    rows = [
        synthesise(
            Axis(2j * np.pi * frequency, "accelerance", shape=shape),
            poles * (1 + shift),
            Residues(row[None, :], np.zeros((1, 2)), (-2, 0)),
        )[0]
        for row, shift in zip(residues, np.linspace(-0.01, 0.01, 12), strict=True)
    ]
    frfs = frf_set(frequency, noisy(np.array(rows), 1e-3, np.random.default_rng(0)))
    assert course_of(frfs) is not None
    model = identify(replace(frfs, window="hann"))
    check(model, 0.004, off=0.02)
    assert model.frfs.line_shape is not None


@pytest.mark.long
def test_coarse_lines_smoothed_over_three():
    poles, residues = structure(0.03)
    frequency = np.arange(5.0, 156.0, 5.0)
    s = 2j * np.pi * np.concatenate([[1e-3], frequency, [160.0]])
    exact = response(poles, residues, s)
    smooth = 0.25 * exact[:, :-2] + 0.5 * exact[:, 1:-1] + 0.25 * exact[:, 2:]
    model = identify(frf_set(frequency, noisy(smooth, 0.002, np.random.default_rng(0))))
    check(model, 0.03, off=0.1)


def test_coarse_lines_without_a_window():
    poles, residues = structure(0.03)
    frequency = np.arange(5.0, 156.0, 5.0)
    exact = response(poles, residues, 2j * np.pi * frequency)
    model = identify(frf_set(frequency, noisy(exact, 0.01, np.random.default_rng(1))))
    check(model, 0.03, off=0.1)
    assert model.frfs.line_shape is None
    assert not any("drift" in w or "differ" in w for w in model.warnings)


@pytest.mark.long
def test_of_many_frfs_some_are_asked_and_all_get_the_shape(monkeypatch):
    """240 FRFs of smoothed lines: no more than 96 are fitted for the question, and the answer holds for all."""
    asked, of_few = [], line_shapes._of_few
    monkeypatch.setattr(line_shapes, "_of_few", lambda f, p: asked.append(len(f.values)) or of_few(f, p))
    poles, residues = structure(0.03)
    residues = residues * np.random.default_rng(5).uniform(0.5, 1.5, (40, 1, 6))
    frequency = np.arange(5.0, 156.0, 5.0)
    s = 2j * np.pi * np.concatenate([[1e-3], frequency, [160.0]])
    exact = response(poles, residues.reshape(-1, 6), s)
    smooth = 0.25 * exact[:, :-2] + 0.5 * exact[:, 1:-1] + 0.25 * exact[:, 2:]
    model = identify(frf_set(frequency, noisy(smooth, 0.002, np.random.default_rng(0))))
    check(model, 0.03, off=0.1)
    assert set(asked) == {96}
    assert model.frfs.line_shape is not None and len(model.frfs.values) == 240


@pytest.mark.long
@pytest.mark.parametrize("kind", ["averaged", "smoothed"])
def test_what_leaves_noise_alone_asks_for_no_second_fit_and_what_was_windowed_does(kind):
    """The score of a shape that is not there is chi-squared of one unknown; one that is there is never excluded."""
    poles, residues = structure(0.005)
    frequency, linear = np.arange(40.0, 160.0, 0.5), Residues(residues, np.zeros((6, 2)), (-2, 0))
    plain = Axis(2j * np.pi * frequency, "accelerance")
    for seed in range(6):
        rng = np.random.default_rng(seed)
        without = frf_set(frequency, noisy(synthesise(plain, poles, linear), 0.01, rng))
        assert worth_asking(fit_candidates(without, poles, band=(40.0, 160.0))) == []
        axis = replace(plain, shape=LineShape(kind, 2.0))
        windowed = frf_set(frequency, noisy(synthesise(axis, poles, linear), 0.01, rng))
        assert kind in worth_asking(fit_candidates(windowed, poles, band=(40.0, 160.0)))


@pytest.mark.long
@pytest.mark.parametrize(
    ("damping", "df", "blocks", "seed"),
    [(0.003232, 0.8, 20, 170), (0.0184, 1.6, 3, 374), (0.0161, 1.6, 3, 659)],
)
def test_averages_over_few_blocks_keep_their_line_shape(damping, df, blocks, seed):
    """Poles imitate the peaks without the shape, and leave nothing of it, or errors of averages hide it."""
    frfs = welch(*structure(damping, seed), df=df, rate=400.0, blocks=blocks, seed=seed)
    model = identify(frfs.select([0, 1, 2] if seed == 659 else [0, 1]))
    assert model.frfs.line_shape is not None
    check(model, damping, off=0.35)


@pytest.mark.long
def test_frfs_of_noise_alone_do_not_deny_a_window():
    """At nodes, or across the plane of the test: noise rings at all lags, and says nothing of the window."""
    frfs = welch(*structure(0.005), df=0.5, rate=400.0, blocks=200, seed=3)
    rng = np.random.default_rng(0)
    mute = noisy(np.ones((5, frfs.values.shape[1])) * np.abs(frfs.values).mean() * 1e-3, 1.0, rng)
    model = identify(frf_set(frfs.frequency, np.concatenate([frfs.values, mute])))
    assert model.frfs.line_shape is not None
    check(model, 0.005, off=0.05)


def test_two_close_modes_are_no_window():
    poles, residues = structure(0.005)
    poles[1] = poles[0] * (1 + 0.55 / 63.6)  # as far apart as the poles that imitate a window
    frequency = np.arange(40.0, 160.0, 0.5)
    exact = response(poles, residues, 2j * np.pi * frequency)
    model = identify(frf_set(frequency, noisy(exact, 0.005, np.random.default_rng(2))))
    assert model.frfs.line_shape is None
    assert np.sort(np.abs(poles)) / (2 * np.pi) == pytest.approx(model.modal.frequency, rel=1e-4)


@pytest.mark.long
def test_sharp_modes_that_move_from_frf_to_frf_are_no_window():
    """Peaks a fraction of a line wide and alone in their line ring to the end of a block: no window leaves that."""
    rng = np.random.default_rng(5)
    hertz, damping = np.array([445.5, 867.3, 1013.9]), np.array([7e-5, 1.4e-4, 2.6e-4])
    poles = 2 * np.pi * hertz * (-damping + 1j * np.sqrt(1 - damping**2))
    place = np.arange(1, 13) / 13
    shapes = np.array([np.sin(np.pi * k * place / 2) for k in (1, 3, 2)]).T
    load = np.where(place > 0.6, place, 0.0)[:, None] ** 4 * shapes**2  # by the mass of a sensor that roves
    frequency = np.arange(20.0, 1500.0, 0.25)
    s = 2j * np.pi * frequency
    residues = shapes / (2j * poles.imag)
    exact = np.concatenate(
        [
            response(poles * (1 - 1e-3 * moved), row[None, :], s)
            for row, moved in zip(residues, load, strict=True)
        ]
    )
    model = identify(frf_set(frequency, noisy(exact, 1e-4, rng)))
    assert model.frfs.line_shape is None
    assert model.modal.frequency == pytest.approx(hertz, rel=3e-4)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(3))
def test_smoothed_lines_far_wider_than_peaks(seed):
    """One pole on each of three lines imitates the shape; a first mode near the band's edge had none beside it."""
    rng = np.random.default_rng(seed)
    hertz = np.array([7.6, 47.5, 133.0]) * rng.uniform(0.95, 1.05, 3)
    damping = np.array([0.005, 0.002, 0.001])
    poles = 2 * np.pi * hertz * (-damping + 1j * np.sqrt(1 - damping**2))
    shapes = rng.standard_normal((12, 3))
    frequency = np.arange(3.0, 172.0, 0.45)
    s = 2j * np.pi * np.concatenate([[2.55], frequency, [frequency[-1] + 0.45]])
    exact = response(poles, shapes / (2j * poles.imag), s)
    smooth = 0.25 * exact[:, :-2] + 0.5 * exact[:, 1:-1] + 0.25 * exact[:, 2:]
    modal = identify(frf_set(frequency, noisy(smooth, 0.005, rng))).modal
    assert len(modal.frequency) == 3
    assert np.max(np.abs(modal.frequency - hertz) / modal.frequency_sigma) < 4.0


@pytest.mark.long
def test_end_lines_to_which_a_neighbour_is_missing():
    """An analyser that smooths over three lines leaves the first and the last as they are, which bias a mode there."""
    poles, residues = structure(0.03)
    frequency = np.arange(5.0, 156.0, 5.0)
    errors = []
    for seed in range(4):
        values = response(poles, residues, 2j * np.pi * frequency)
        values = noisy(values, 0.002, np.random.default_rng(seed))
        values[:, 1:-1] = 0.25 * values[:, :-2] + 0.5 * values[:, 1:-1] + 0.25 * values[:, 2:]
        model = identify(frf_set(frequency, values))
        assert model.frfs.frequency[[0, -1]] == pytest.approx([10.0, 150.0])
        errors.append(model.modal.frequency[-1] - 142.0)
    assert abs(np.mean(errors)) < 0.05


@pytest.mark.parametrize("before", [True, False])
def test_noise_smoothed_with_the_lines_differs_from_noise_that_came_after(before):
    poles, residues = structure(0.03)
    frequency = np.arange(5.0, 156.0, 5.0)
    rng = np.random.default_rng(1)
    values = response(poles, residues, 2j * np.pi * np.concatenate([[1e-3], frequency, [160.0]]))
    values = noisy(values, 0.01, rng) if before else values
    smooth = 0.25 * values[:, :-2] + 0.5 * values[:, 1:-1] + 0.25 * values[:, 2:]
    smooth = smooth if before else noisy(smooth, 0.01, rng)
    fitted = fit_shaped(frf_set(frequency, smooth), poles, band=(5.0, 155.0))
    assert fitted.frfs.line_shape == LineShape("smoothed", 0.2)
    factors = line_factors(fitted)
    assert np.all(factors > 1.3) if before else np.all(factors < 1.2)
