"""Simulated hammer tests: what is put in is found again, whatever the study says of its test."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from simulate_cases import STEEL, STUDY, Run, pointed_at

from acquisition import Dof, read_uff, write_uff
from acquisition.errors import InputError, StudyError
from modalkit.samples import sample_file
from modalkit.simulation.setup import Options
from modalkit.simulation.simulate import simulate_test
from modalkit.study.named_effects import parse_effect
from modalkit.study.read import read_study
from modalkit.workflow.identification import read
from updating import LIBRARY, Damping, Measured, Predictor, Spec

TABLE = """
[model]
type = "{kind}"
length = 0.4
width = 0.03
thickness = 0.005
clamped = {clamped}
[model.material]
E = 210e9
density = 7850.0
"""


def blank(places: np.ndarray) -> Measured:
    """A test of points on a beam with its sensor at the last."""
    n = len(places)
    f = np.array([500.0, 1000.0])
    return Measured(
        frequency=f, frequency_sigma=f, damping=f, damping_sigma=f, points=places[:, None],
        nodes=tuple(range(1, n + 1)), seen=np.full(n, n - 1), hit=np.arange(n), constants=np.ones((n, 2)),
        constants_sigma=np.ones((n, 2)), absolute=True,
    )  # fmt: skip


BEAM = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(40,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=STEEL,
    damping=Damping(alpha=1e-3),
)


MODEL = Predictor(BEAM, blank(np.linspace(0.08, 0.4, 5)))


def study_of(folder: Path, test: str, *, kind: str = "beam", clamped: str = '["x0"]') -> Path:
    path = folder / "study.toml"
    path.write_text(f"[test]\n{test}\n{TABLE.format(kind=kind, clamped=clamped)}")
    return path


@pytest.mark.long
@pytest.mark.parametrize(
    ("effect", "name", "value"),
    [("sensor_mass:mass=0.0086", "mass", 0.0086), ("clamp_rotation:stiffness=1500", "stiffness", 1500.0)],
)
def test_what_was_put_in_is_named(run: Run, tmp_path: Path, effect: str, name: str, value: float) -> None:
    target, found, answer = (tmp_path / n for n in ("out.uff", "modes.json", "diagnosis.json"))
    code, out, _ = run("simulate", STUDY, "--effect", effect, "--seed", "4", "--hits", "6", "-o", target)
    assert code == 0
    assert "6 hits at each of 5 points" in out
    assert run("identify", target, "--band", "5", "500", "--json", found)[0] == 0
    predicted = simulate_test(
        read_study(STUDY), [parse_effect(effect)], seed=9, options=Options(hits=1)
    ).table()
    modes = json.loads(found.read_text())["modes"]
    for mode, frequency, damping in zip(modes, *predicted.to_numpy().T, strict=True):
        assert abs(mode["frequency_hz"] - frequency) < 4.5 * mode["frequency_sigma_hz"]
        assert abs(100 * mode["damping_ratio"] - damping) < 450 * mode["damping_sigma"]
    assert run("diagnose", pointed_at(target, tmp_path), "--json", answer)[0] == 0
    record = json.loads(answer.read_text())
    effect_name = effect.partition(":")[0]
    assert record["cause"]["verdict"] == "named"
    assert record["cause"]["sets"] == [[effect_name]]
    estimate = record["cause"]["ranking"][0]["parameters"][f"{effect_name}.{name}"]
    assert estimate["low95"] < value < estimate["high95"]


@pytest.mark.long
def test_the_file_depends_on_study_and_seed_alone(run: Run, tmp_path: Path) -> None:
    files = [tmp_path / f"{i}.uff" for i in range(3)]
    for path, seed in zip(files, ("7", "7", "8"), strict=True):
        assert run("simulate", STUDY, "--hits", "2", "--seed", seed, "-o", path)[0] == 0
    tests = [read_uff(path).tests[0] for path in files]
    assert np.array_equal(tests[0].points[2].motion, tests[1].points[2].motion)
    assert not np.array_equal(tests[0].points[2].motion, tests[2].points[2].motion)


@pytest.mark.long
def test_frfs_come_with_coherence_and_fewer_bytes(run: Run, tmp_path: Path) -> None:
    target = tmp_path / "frfs.uff"
    assert run("simulate", STUDY, "--hits", "4", "--frfs", "-o", target)[0] == 0
    content = read_uff(target)
    assert not content.tests
    assert content.frfs is not None
    assert content.frfs.coherence is not None
    assert content.frfs.decay == 8.0
    assert set(content.frfs.averages.tolist()) == {4}
    assert content.frfs.frequency[-1] == pytest.approx(500.0, abs=1.3)


def test_directions_of_the_transducers_stay_what_they_were(tmp_path: Path) -> None:
    frfs = read(STUDY.parent / "beam_dry.uff").frfs
    turned = replace(frfs, responses=tuple(Dof(d.node, -3) for d in frfs.responses))
    turned = turned.select([0, 2, 4]).scaled(np.array([-1.0, -1.0, -1.0]))
    write_uff(tmp_path / "turned.uff", frfs=turned, geometry=frfs.geometry)
    made = simulate_test(read_study(pointed_at(tmp_path / "turned.uff", tmp_path)), options=Options(hits=2))
    found = made.frfs().band(5.0, 20.0)  # below the first mode, where model and test hardly differ
    assert found.responses == turned.responses
    product = np.sum(found.values * turned.band(5.0, 20.0).values.conj(), axis=1).real
    size = np.linalg.norm(found.values, axis=1) * np.linalg.norm(turned.band(5.0, 20.0).values, axis=1)
    assert (product / size > 0.9).all()


def test_points_with_different_responses_are_different_tests(tmp_path: Path) -> None:
    frfs = read(STUDY.parent / "beam_dry.uff").frfs
    fewer = replace(frfs, responses=(*frfs.responses[:3], *frfs.references[3:4], frfs.responses[4]))
    write_uff(tmp_path / "two.uff", frfs=fewer, geometry=frfs.geometry)
    made = simulate_test(
        read_study(pointed_at(tmp_path / "two.uff", tmp_path)),
        [parse_effect("E:factor=1.01")],
        options=Options(hits=2),
    )
    assert len(made.tests) == 2
    pairs = {(d, p.reference) for test in made.tests for p in test.points for d in p.responses}
    assert pairs == set(zip(fewer.responses, fewer.references, strict=True))
    made.write(tmp_path / "made.uff")
    assert len(read(tmp_path / "made.uff").frfs.responses) == 5


def test_a_study_with_modes_alone_says_where_it_hits(run: Run, tmp_path: Path) -> None:
    target = tmp_path / "out.uff"
    published = sample_file("beam_dry/study.toml").parent / "published.toml"
    code, out, _ = run(
        "simulate", published, "--points", "4", "--hits", "2", "--samples", "2048", "-o", target
    )
    assert code == 0
    assert "the hammer goes to 4, evenly spaced" in out
    assert "0.5 % for every mode" in out
    nodes = read_uff(target).geometry
    assert nodes.coordinates[:, 0] == pytest.approx(0.376 * np.arange(1, 5) / 4)
    assert "the sensor sits at 4+Z" in out  # where the study knows of a mass


def test_a_planned_test_needs_no_data_and_a_free_beam_hangs(tmp_path: Path) -> None:
    study = read_study(
        study_of(tmp_path, "axes = { x = [0.0, 1.0, 0.0], y = [-1.0, 0.0, 0.0] }", clamped="[]")
    )
    made = simulate_test(study, options=Options(hits=2, samples=4096))
    assert len(made.table()) == 5
    assert any("hung on cords" in r for r in made.notes)
    made.write(tmp_path / "out.uff")
    processed = read(tmp_path / "out.uff")
    assert processed.frfs.geometry.coordinates[:, 1] == pytest.approx(np.linspace(0, 0.4, 5))
    model = processed.identify(band=(20.0, made.test_setup.band[1]))
    assert model.modal.frequency == pytest.approx(made.table()["frequency [Hz]"].to_numpy(), rel=1e-4)
    written = tmp_path / "back.toml"
    written.write_text(
        study.path.read_text().replace(
            "[test]", f'[test]\nfiles = ["out.uff"]\nband = {list(made.test_setup.band)}'
        )
    )
    again = simulate_test(read_study(written), options=Options(hits=1))
    assert again.table()["frequency [Hz]"].to_numpy() == pytest.approx(
        made.table()["frequency [Hz]"].to_numpy()
    )


def test_transducers_along_turned_axes_point_the_model_s_way(tmp_path: Path) -> None:
    """The model's z is the test's -y, then no axis of the test at all."""
    for axes, direction in (
        ("x = [1.0, 0.0, 0.0], y = [0.0, 0.0, 1.0]", -2),
        ("x = [1.0, 0.0, 0.0], y = [0.0, 0.6, 0.8]", 3),
    ):
        study = read_study(study_of(tmp_path, f"axes = {{ {axes} }}"))
        made = simulate_test(study, options=Options(hits=1, samples=256))
        assert {dof.direction for dof in made.test_setup.references} == {direction}
        way = made.test_setup.geometry.direction(made.test_setup.references[0])
        assert way == pytest.approx(study.axes(study.test).rotation[2])


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        ("senser_mass:mass=0.01", "did you mean sensor_mass?"),
        ("warp", "`modalkit effects` lists them"),
        ("sensor_mass", "it takes mass [kg], bulk [-], dx [m], found none"),
        ("sensor_mass:mass=heavy", "is not PARAM=VALUE"),
        ("sensor_mass:mass=-1", "must be positive"),
        ("shear:factor=2", "it takes no parameters, found factor"),
        ("sensor_mass:mass=nan", "is not PARAM=VALUE"),
    ],
)
def test_a_wrong_effect_is_one_line_and_no_file(run: Run, tmp_path: Path, effect: str, message: str) -> None:
    target = tmp_path / "out.uff"
    code, _, err = run("simulate", STUDY, "--effect", effect, "-o", target)
    assert code == 2
    assert message in err
    assert err.strip().count("\n") == 0
    assert list(tmp_path.iterdir()) == []


@pytest.mark.long
def test_what_does_not_apply_is_refused(tmp_path: Path) -> None:
    free = read_study(study_of(tmp_path, "", clamped="[]"))
    with pytest.raises(StudyError, match="no clamped edge"):
        simulate_test(free, [parse_effect("clamp_rotation:stiffness=100")])
    with pytest.raises(InputError, match="states which points"):
        simulate_test(read_study(STUDY), options=Options(points=3))
    with pytest.raises(StudyError, match="at least 2"):
        simulate_test(free, options=Options(points=1))


def test_shear_and_a_sensor_at_once(tmp_path: Path) -> None:
    """Two effects, one of them another theory: both act."""
    study = read_study(study_of(tmp_path, "band = [10.0, 1200.0]"))
    quick = Options(hits=1, samples=256)
    both = [parse_effect("shear"), parse_effect("sensor_mass:mass=0.02")]
    plain, sheared, heavy, all_of_it = (
        simulate_test(study, effects, options=quick).table()["frequency [Hz]"].to_numpy()
        for effects in ([], both[:1], both[1:], both)
    )
    assert (sheared < plain).all()
    assert all_of_it / plain == pytest.approx((sheared / plain) * (heavy / plain), rel=2e-3)


NODES = {"points": "3/4", "point": "3"}


EVERYTHING = {
    name: ",".join(
        [f"{label}={NODES[label]}" for label in effect.labels]
        + [
            f"{p.name}={p.value(0.3 if effect.channel == 'damping' else 0.6):.9g}"
            for p in effect.parameters(MODEL)
            if p.like != "nothing"  # a law beside the one that acts
        ]
    )
    for name, effect in LIBRARY.items()
    if "beam" in effect.models
}


@pytest.mark.parametrize(
    "name",
    [n for n in sorted(EVERYTHING) if LIBRARY[n].channel == "measurement" or not LIBRARY[n].why_not(MODEL)],
)
def test_every_effect_can_be_simulated_and_acts_as_in_a_prediction(tmp_path: Path, name: str) -> None:
    study = read_study(study_of(tmp_path, "band = [4.0, 1100.0]"))
    effect = parse_effect(f"{name}:{EVERYTHING[name]}")
    made = simulate_test(study, [effect], options=Options(hits=1, samples=128)).table()
    state = LIBRARY[name].state(MODEL, effect[1])
    expected = MODEL.predict(state, count=12).frequency
    decay = state.decay / (2 * np.pi * expected)
    found = made["frequency [Hz]"].to_numpy()[: len(expected)]
    damped = LIBRARY[name].channel == "damping" or any(
        LIBRARY[name].damps(p) for p in effect[1]
    )  # a damped mode's |pole| is its undamped frequency to second order
    wanted = (expected * np.sqrt(1 + 0.01 * decay + decay**2))[: len(found)]
    assert found == pytest.approx(wanted, rel=2e-3 if damped else 1e-6)


def test_nothing_is_left_where_nothing_can_be_written(run: Run, tmp_path: Path) -> None:
    code, _, err = run("simulate", STUDY, "--hits", "1", "-o", tmp_path / "nowhere" / "out.uff")
    assert code == 2
    assert "cannot be written" in err
    assert err.strip().count("\n") == 0
