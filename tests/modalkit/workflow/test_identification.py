"""What is said of hits, windows and sensors on the way to FRFs, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from acquisition import (
    Dof,
    FrfSet,
    HammerTest,
    Hits,
    InputError,
    ModalData,
    estimate_frfs,
    hammer_test,
    judge_hits,
    register_reader,
    remove_sensor_mass,
    write_uff,
)
from acquisition.synthetic import HammerPlan, modal_system
from modalkit.figures.hits import _gather
from modalkit.output.documents import modes_document
from modalkit.workflow.files import read_files
from modalkit.workflow.identification import read
from modalkit.workflow.joining import together
from modalkit.workflow.judged_hits import decided, proposed
from modalkit.workflow.processing_options import ProcessingOptions, sensor_mass

RATE, SAMPLES = 2048.0, 4096
SYSTEM = modal_system(
    frequency=np.array([80.0, 200.0]),
    damping=np.array([0.01, 0.01]),
    response_shapes=np.array([[1.0, 0.8]]),
    point_shapes=np.array([[1.0, 0.8], [0.6, -0.9], [0.3, 0.7]]),
    responses=[Dof(1, 3)],
    points=[Dof(1, 3), Dof(2, 3), Dof(3, 3)],
)
PLAN = HammerPlan(
    rate=RATE, samples=SAMPLES, hits=3, width=4e-3, pre_trigger=0.05, response_noise=1e-4, adc_bits=None
)


def drawn_runs() -> tuple[list[str], list[str]]:
    """Return the names of the hits not used, as drawn and as judged, of a point hit in two runs."""
    test = three()
    runs = replace(test, points=(test.points[0], quieter(test.points[0], 1, 0.02), test.points[1]))
    verdicts = judge_hits(runs)
    drawn = _gather(runs, verdicts)
    return (
        [name for name, used in zip(drawn.names, drawn.used, strict=True) if not used],
        [f"{v.point} hit {v.hit}" for v in verdicts if not v.used],
    )


def three(**more: object) -> HammerTest:
    return hammer_test(SYSTEM, replace(PLAN, **more), rng=np.random.default_rng(3))  # type: ignore[arg-type]


def kept(test: HammerTest, counts: tuple[int, ...]) -> HammerTest:
    points = tuple(
        replace(p, force=p.force[:n], motion=p.motion[:n]) for p, n in zip(test.points, counts, strict=True)
    )
    return replace(test, points=points)


def quieter(hits: Hits, which: int | slice, factor: float) -> Hits:
    force, motion = np.array(hits.force), np.array(hits.motion)
    force[which] *= factor
    motion[which] *= factor
    return replace(hits, force=force, motion=motion)


def saved(folder: Path, name: str, **content: object) -> Path:
    write_uff(folder / name, **content)  # type: ignore[arg-type]
    return folder / name


def frf_file(folder: Path) -> Path:
    return saved(folder, "f.uff", frfs=estimate_frfs(three()))


def test_hits_of_several_tests_are_numbered_through(tmp_path: Path) -> None:
    """The same point in two tests of different length of record, one hit of the second too weak."""
    one = kept(three(), (3, 3, 3))
    weak = three()
    weak = replace(weak, points=(quieter(weak.points[0], 1, 0.02), *weak.points[1:]))
    other = replace(weak, rate=RATE, source="b")
    from modalkit.workflow import processed

    judged = decided(proposed([one, other], ProcessingOptions()), ProcessingOptions(), [])
    drawn = _gather(judged[1].test, judged[1].verdicts)
    assert [name for name, used in zip(drawn.names, drawn.used, strict=True) if not used] == ["1+Z hit 5"]
    names = [(str(v.point), v.hit) for j in judged for v in j.verdicts]
    assert len(set(names)) == 18
    assert [n for n in names if n[0] == "1+Z"] == [("1+Z", k) for k in range(1, 7)]
    assert [(str(v.point), v.hit) for j in judged for v in j.verdicts if not v.used] == [("1+Z", 5)]
    leaving = ProcessingOptions(leave=(("1+Z", 4),))
    after = decided(proposed([one, other], leaving), leaving, [])
    frfs = processed._estimated(after, ProcessingOptions())
    assert frfs.averages is not None
    assert frfs.averages.tolist() == [3, 3, 3, 1, 3, 3]


def test_runs_are_drawn_as_they_are_judged() -> None:
    drawn, judged = drawn_runs()
    assert drawn == judged == ["1+Z hit 5"]


def test_a_point_without_hits_is_named_everywhere(tmp_path: Path) -> None:
    test = three()
    test = replace(test, points=(test.points[0], quieter(test.points[1], slice(None), 0.0), test.points[2]))
    processed = read(saved(tmp_path, "r.uff", tests=test))
    assert any("no hit is used at 2+Z" in w for w in processed.warnings)
    model = processed.identify(band=(20.0, 300.0))
    record = modes_document(model, processed.hits, processed.warnings)
    assert record["points_rejected"] == ["2+Z: none of its hits is used"]
    fine = read(saved(tmp_path, "fine.uff", tests=three()))
    assert modes_document(fine.identify(band=(20.0, 300.0)), fine.hits, ())["points_rejected"] == []


def test_the_band_ends_where_the_force_does(tmp_path: Path) -> None:
    """A half-sine of width w is 20 dB down near 1.4 / w or, for a haversine, near 1.8 / w."""
    processed = read(saved(tmp_path, "h.uff", tests=three()))
    model = processed.identify()
    assert 1.2 / 4e-3 < model.band[1] < 2.0 / 4e-3
    assert any("20 dB down" in w and "give a band" in w for w in model.warnings)
    wide = processed.identify(band=(20.0, 700.0))
    assert wide.band == (20.0, 700.0)
    assert not any("20 dB down" in w for w in wide.warnings)
    alone = read(saved(tmp_path, "f.uff", frfs=estimate_frfs(three(), band=(0.0, 600.0)))).identify()
    assert alone.band[1] == pytest.approx(600.0)


@pytest.mark.parametrize(
    "message",
    [{"use": (("1+Z", 1),)}, {"leave": (("1+Z", 1),)}, {"window": 3.0}],
)
def test_what_is_for_hits_is_refused_for_frfs(tmp_path: Path, message: dict[str, object]) -> None:
    with pytest.raises(InputError, match=f"--{next(iter(message))} .*the files hold FRFs"):
        read(frf_file(tmp_path), processing=ProcessingOptions(**message))  # type: ignore[arg-type]


def test_what_cannot_act_is_said(tmp_path: Path) -> None:
    stated = read(frf_file(tmp_path), processing=ProcessingOptions(estimator="Hv"))
    assert any("estimator Hv is not used" in w for w in stated.warnings)
    with pytest.raises(InputError, match="a window on responses is stated without its decay"):
        read(frf_file(tmp_path), processing=ProcessingOptions(window_on="responses"))
    stated = read(frf_file(tmp_path), processing=ProcessingOptions(window_on="responses", decay=2.0))
    assert any("cannot be corrected" in w for w in stated.warnings)


def test_a_point_with_a_single_hit_is_named(tmp_path: Path) -> None:
    stated = read(saved(tmp_path, "s.uff", tests=kept(three(), (3, 1, 3))))
    assert stated.frfs.variance is None
    assert any("only one usable hit at 2+Z:" in w for w in stated.warnings)
    every = read(saved(tmp_path, "e.uff", tests=kept(three(), (1, 1, 1))))
    assert any("only one usable hit at every point" in w for w in every.warnings)
    assert not any("usable hit" in w for w in read(saved(tmp_path, "f.uff", tests=three())).warnings)


def test_a_dead_response_is_named(tmp_path: Path) -> None:
    def with_dead(p: Hits) -> Hits:
        return replace(
            p, responses=(*p.responses, Dof(7, 3)), motion=np.concatenate([p.motion, 0 * p.motion], axis=1)
        )

    test = three()
    test = replace(test, points=tuple(with_dead(p) for p in test.points))
    stated = read(saved(tmp_path, "d.uff", tests=test))
    assert any("7+Z is dead in every hit" in w for w in stated.warnings)
    assert all(v.used for v in stated.hits)


def test_an_unstated_window_is_heard(tmp_path: Path) -> None:
    test = three(force_noise=0.05)
    window = np.exp(-6.0 * np.arange(SAMPLES) / RATE)
    test = replace(
        test, points=tuple(replace(p, force=p.force * window, motion=p.motion * window) for p in test.points)
    )
    stated = read(saved(tmp_path, "w.uff", tests=test))
    assert any("state it with --decay" in w for w in stated.warnings)
    for fine in (
        read(saved(tmp_path, "s.uff", tests=test), decay=6.0),
        read(saved(tmp_path, "p.uff", tests=three(force_noise=0.05))),
    ):
        assert not any("seems to have been applied" in w for w in fine.warnings)


LAYOUT = """
rate = 2048.0
[[column]]
index = 0
quantity = "force"
node = 3
[[column]]
index = 1
quantity = "acceleration"
node = 1
[nodes]
1 = [0.0, 0.0, 0.0]
3 = [0.2, 0, 0]
"""


def test_files_of_several_kinds_are_one_test(tmp_path: Path) -> None:
    """Text goes with a universal file, whose warnings, data sets and title are kept."""
    test = three()
    paths = [saved(tmp_path, "u.uff", tests=replace(test, points=test.points[:2]), title="A rig")]
    for number, (force, motion) in enumerate(
        zip(test.points[2].force, test.points[2].motion[:, 0], strict=True)
    ):
        paths.append(tmp_path / f"p{number}.csv")
        np.savetxt(paths[-1], np.stack([force, motion], axis=1), delimiter=",")
    (tmp_path / "layout.toml").write_text(LAYOUT, encoding="utf-8")
    content = read_files(paths, layout=tmp_path / "layout.toml")
    assert content.title == "A rig"
    assert len(content.datasets) == len(read_files(paths[:1]).datasets)
    assert [len(t.points) for t in content.tests] == [2, 1]
    assert content.geometry.nodes == (1, 3)
    assert all(t.geometry.nodes == (1, 3) for t in content.tests)
    joined = read(paths, processing=ProcessingOptions(layout=tmp_path / "layout.toml")).frfs
    whole = estimate_frfs(test)
    assert np.allclose(joined.values, whole.values, rtol=1e-5, atol=1e-5 * np.abs(whole.values).max())


def test_joined_sets_have_the_mean_trigger_and_one_duration() -> None:
    one, two = estimate_frfs(three()), estimate_frfs(kept(three(pre_trigger=0.3), (2, 2, 2)))
    both = together([one, two.select([0])])
    assert both.record is not None and one.record is not None and two.record is not None
    assert both.record.trigger == pytest.approx((3 * one.record.trigger + two.record.trigger) / 4)
    other = estimate_frfs(three(samples=8192))
    with pytest.raises(InputError, match=r"a, 1\+Z, .*from 2 s; b, 1\+Z, .*from 4 s\)"):
        together([replace(one, source="a"), replace(other, source="b")])


def test_the_mass_of_a_sensor_is_taken_out_where_it_is_given(tmp_path: Path) -> None:
    path = saved(tmp_path, "m.uff", tests=three())
    plain = read(path).frfs
    stated = read(path, processing=ProcessingOptions(sensor_masses=(("1-z", 0.01),)))
    expected = remove_sensor_mass(plain, mass=0.01)
    assert isinstance(stated.frfs, FrfSet)
    assert np.array_equal(stated.frfs.values, expected.values)
    assert not np.allclose(stated.frfs.values, plain.values)
    assert any("10 g at 1+Z" in w for w in stated.warnings)
    with pytest.raises(InputError, match="no response at 9\\+Z"):
        read(path, processing=ProcessingOptions(sensor_masses=(("9+Z", 0.01),)))


@pytest.mark.parametrize("text", ["25+Z", "25+Z=heavy", "25+Z=-1", "25+Z=inf"])
def test_a_sensor_written_otherwise_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="POINT=MASS"):
        sensor_mass(text)
    assert sensor_mass(" 25+Z = 0.0086") == ("25+Z", 0.0086)


def test_modes_of_a_registered_reader_are_a_test_s_modes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("acquisition.own_readers._REGISTERED", {})
    (tmp_path / "beam.xyz").write_text("24.5 153.9 429.2")
    register_reader(
        ".xyz", lambda path: ModalData(frequency=np.loadtxt(path), frequency_sigma=1e-3 * np.loadtxt(path))
    )
    modes = read(tmp_path / "beam.xyz")
    assert modes.identify(band=(100, 500)).table().iloc[:, 0].tolist() == [153.9, 429.2]
    with pytest.raises(InputError, match="read as tables of modes, of which a test has one"):
        read([tmp_path / "beam.xyz", tmp_path / "beam.xyz"])
