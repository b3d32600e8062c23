"""Lines without force, offsets under windows, and files in which nothing can be used."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import (
    Dof,
    EstimationError,
    HammerPlan,
    HammerTest,
    Hits,
    InputError,
    Windows,
    apply_windows,
    estimate_frfs,
    hammer_test,
    layout_from,
    modal_system,
    read_test,
    read_uff,
    write_uff,
)

SDOF = modal_system(
    frequency=np.array([80.0]),
    damping=np.array([0.01]),
    response_shapes=np.array([[0.8]]),
    point_shapes=np.array([[0.8]]),
    responses=(Dof(1, 3),),
    points=(Dof(1, 3),),
)


@pytest.mark.parametrize("estimator", ["H1", "H2", "Hv"])
@pytest.mark.parametrize("silent", [slice(None), slice(1, None)])
def test_a_line_without_force_costs_that_line_only(estimator, silent, rng):
    """Force spectra that are exactly zero at the Nyquist line, in all hits or in all but one."""
    force = rng.integers(-40, 40, (3, 64)).astype(float)
    force[silent, -1] -= (force * (-1.0) ** np.arange(64)).sum(axis=1)[silent] * -1.0
    assert np.all(np.fft.rfft(force)[silent, -1] == 0)
    motion = 2.0 * force[:, None] + 0.1 * rng.standard_normal((3, 1, 64))
    frfs = estimate_frfs(
        HammerTest(64.0, (Hits(Dof(1, 3), (Dof(1, 3),), force, motion),)), estimator=estimator
    )
    assert np.allclose(frfs.values[:, :-1], 2.0, atol=0.3)
    assert np.isfinite(frfs.variance).all() and np.isfinite(frfs.coherence).all()
    assert frfs.variance[0, -1] > 100 * np.median(frfs.variance)
    assert np.allclose(frfs.variance, frfs.scatter.variance(1), rtol=1e-5)
    if silent == slice(None):
        assert frfs.values[0, -1] == 0 and frfs.coherence[0, -1] == 0


def test_a_force_of_zero_is_refused():
    hits = Hits(Dof(1, 3), (Dof(1, 3),), np.zeros((2, 64)), np.ones((2, 1, 64)))
    with pytest.raises(EstimationError, match="is zero"):
        estimate_frfs(HammerTest(64.0, (hits,)))


def test_an_offset_does_not_go_through_an_exponential_window(rng):
    plan = HammerPlan(rate=2048.0, samples=4096, hits=4, width=2e-3, pre_trigger=0.1, adc_bits=None)
    test = hammer_test(SDOF, plan, rng=rng)
    (p,) = test.points
    shifted = replace(test, points=(replace(p, force=p.force + 3.0, motion=p.motion - 2.0),))
    plain, other = (estimate_frfs(t, windows=Windows(decay=8.0)).values for t in (test, shifted))
    assert np.abs(other - plain)[:, :600].max() < 1e-3 * np.abs(plain[:, :600]).max()


def test_without_samples_before_the_hit_the_response_is_left(rng):
    plan = HammerPlan(rate=2048.0, samples=4096, hits=2, width=2e-3, pre_trigger=0.003, adc_bits=None)
    test = hammer_test(SDOF, plan, rng=rng)
    (p,) = test.points
    moved = replace(test, points=(replace(p, motion=p.motion + 1.0),))
    one, two = (apply_windows(t, Windows(decay=2.0)).points[0].motion for t in (test, moved))
    time = np.arange(4096) / 2048
    peak = np.abs(p.force).argmax(axis=1) / 2048
    assert np.allclose(two - one, np.exp(-2.0 * (time - peak[:, None]))[:, None])


def test_windows_point_by_point_are_those_of_the_whole_test(rng):
    plan = HammerPlan(rate=2048.0, samples=4096, hits=3, width=2e-3, adc_bits=None)
    test = hammer_test(SDOF, plan, rng=rng)
    windows = Windows(decay=4.0, force_length=0.05)
    inside = estimate_frfs(test, windows=windows)
    before = estimate_frfs(apply_windows(test, windows))
    assert np.array_equal(inside.values, before.values)
    assert inside.decay == before.decay == 4.0
    assert inside.record == before.record


def test_universal_files_without_anything_to_use_say_why(tmp_path):
    bad = tmp_path / "bad.uff"
    bad.write_text("    -1\n    58\nshort\n    -1\n", encoding="ascii")
    with pytest.raises(InputError, match=r"bad\.uff"):
        read_test(bad)


def test_si_units_are_called_so(tmp_path, rng):
    plan = HammerPlan(rate=2048.0, samples=4096, hits=2, width=2e-3, adc_bits=None)
    write_uff(tmp_path / "a.uff", tests=hammer_test(SDOF, plan, rng=rng))
    (units,) = [d for d in read_uff(tmp_path / "a.uff").datasets if d.number == 164]
    assert units.description == "SI"


def test_units_whose_unused_offset_has_more_digits_are_read(tmp_path):
    """Else a file in mm would be taken for one in m, as nothing said its units."""
    units = f"{5:10d}{'mm':20s}{2:10d}\n  1.0E+03  1.0E+00  1.0E+00\n  2.7315E+02\n"
    node = "1".rjust(10) + 3 * "0".rjust(10) + 3 * f"{250.0:13.5E}" + "\n"
    sets = (("164", units), ("15", node))
    (tmp_path / "a.uff").write_text("".join(f"    -1\n{n:>6}\n{body}    -1\n" for n, body in sets), "ascii")
    content = read_uff(tmp_path / "a.uff")
    assert content.geometry.coordinates.tolist() == [[0.25, 0.25, 0.25]]


def test_text_that_begins_with_a_negative_number_is_text(tmp_path):
    table = np.stack([-1.0 - np.arange(50.0), np.arange(50.0)], axis=1)
    np.savetxt(tmp_path / "a.csv", table, delimiter=",")
    layout = layout_from(LAYOUT)
    (test,) = read_test(tmp_path / "a.csv", layout=layout)
    assert np.allclose(test.points[0].force[0], table[:, 0])
    assert test.geometry.nodes == (1, 3)
    assert np.allclose(test.geometry.coordinates, [[0, 0, 0], [0.2, 0, 0.1]])


LAYOUT = {
    "rate": 100.0,
    "column": [
        {"index": 0, "quantity": "force", "node": 3},
        {"index": 1, "quantity": "acceleration", "node": 1},
    ],
    "nodes": {"1": [0, 0, 0], "3": [0.2, 0, 0.1]},
}


@pytest.mark.parametrize(
    "nodes", [{"a": [0, 0, 0]}, {"1": [0, 0]}, {"1": "here"}, {"1": [0, 0, float("nan")]}, 3]
)
def test_nodes_that_are_none_are_refused(nodes):
    with pytest.raises(InputError, match="nodes"):
        layout_from({**LAYOUT, "nodes": nodes})


@pytest.mark.parametrize(("text", "dof"), [("12+Z", Dof(12, 3)), (" 3-x ", Dof(3, -1)), ("7+RY", Dof(7, 5))])
def test_a_degree_of_freedom_is_read_as_it_prints(text, dof):
    assert Dof.of(text) == dof
    assert Dof.of(str(dof)) == dof
    with pytest.raises(InputError, match="not a degree of freedom"):
        Dof.of(text + "!")
