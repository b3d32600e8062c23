"""The forecast on a study's own model: regions, joints, supports and hypotheses by name, plates, what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from conforming import departures
from own_model_cases import MASSES, PARTS, PLATE, SPRINGS, K, M, bench, study
from typer.testing import CliRunner

from modalkit.cli import app
from modalkit.output.schemas.plan import CheckedForecast
from modalkit.output.whole import plain
from modalkit.planning import Forecast, forecast
from modalkit.planning.document import to_json
from modalkit.planning.note import brings, note, offered
from modalkit.planning.own import OwnBench, bench_of
from modalkit.planning.own.parts import PARTS as MAKERS
from modalkit.planning.own.parts import where_supports_are
from modalkit.planning.separability import SEEN, distances
from modalkit.planning.surface import Surface
from modalkit.planning.trials import check
from modalkit.study.read import read_study
from updating.effects.base import Parameter
from updating.models.imported.groups import Support


@pytest.fixture(scope="module")
def chained(tmp_path_factory: pytest.TempPathFactory) -> Forecast:
    hypothesis = '[[hypothesis]]\nname = "spring 3 is cracked"\nstiffness = "softer.mtx"'
    return forecast(bench(tmp_path_factory.mktemp("chain"), more=hypothesis))


def closed_form(factors: dict[int, float]) -> np.ndarray:
    """Return the chain's frequencies with some springs times a factor [Hz]."""
    k = np.zeros((MASSES, MASSES))
    for n in range(SPRINGS):
        own = K * factors.get(n, 1.0)
        k[n, n] += own
        if n:
            k[n - 1, n - 1] += own
            k[n - 1, n] -= own
            k[n, n - 1] -= own
    return np.sqrt(np.linalg.eigvalsh(k) / M) / (2 * np.pi)


def test_the_test_is_as_planned(tmp_path: Path) -> None:
    own = bench(tmp_path)
    assert own.design.modes == 5
    assert own.problem.measured.frequency == pytest.approx(closed_form({}), rel=1e-9)
    assert own.band == (1.0, 290.0)
    assert [own.problem.measured.nodes[i] for i in own.design.stations] == [2, 4, 6]
    assert own.layout.drive is None
    names = {family.name for family in own.families}
    assert {
        "local_stiffness of low",
        "local_mass of high",
        "lumped_mass at end",
        "ground_spring at end along x",
    } <= names
    assert "taper" in own.not_forecast
    assert not names & set(own.not_forecast)


def test_what_a_region_changes_is_what_its_springs_change(tmp_path: Path) -> None:
    own = bench(tmp_path)
    family = next(f for f in own.families if f.name == "local_stiffness of middle")
    change = own.change(family, float(np.log(1 / 0.7)), 0.0)
    softer = np.log(closed_form({2: 0.7, 3: 0.7}) / closed_form({}))
    assert change[:MASSES] == pytest.approx(softer, abs=1e-9)


def test_covariance_of_frequencies_is_that_of_the_stated_doubts(tmp_path: Path) -> None:
    own = bench(tmp_path)
    design = replace(own.design, shapes=False)
    white = own.whitener(design)
    covariance = np.linalg.inv(white.T @ white)
    noise = (2e-4) ** 2 + 5e-4**2
    common = (0.5 * 0.01) ** 2 + (0.5 * 0.003) ** 2
    assert covariance == pytest.approx(common * np.ones((5, 5)) + noise * np.eye(5), rel=1e-3, abs=1e-12)


def test_seen_is_where_the_closed_form_says(tmp_path: Path) -> None:
    """From frequencies alone, the size of a region's softness at three sigma is known from the springs."""
    own = bench(tmp_path)
    design = replace(own.design, shapes=False)
    family = next(f for f in own.families if f.name == "local_stiffness of middle")
    (found,) = distances([own.solve(family)], design, own)
    noise = ((2e-4) ** 2 + 5e-4**2) * np.eye(5) + ((0.5 * 0.01) ** 2 + (0.5 * 0.003) ** 2)
    step = 1e-4
    slope = (np.log(closed_form({2: 1 - step, 3: 1 - step}) / closed_form({}))[:5]) / step
    expected = SEEN / np.sqrt(slope @ np.linalg.solve(noise, slope))
    assert found.threshold(found.sigma[0]) == pytest.approx(expected, rel=0.05)


@pytest.mark.long
def test_a_hypothesis_is_named_or_in_a_class_like_any_effect(chained: Forecast) -> None:
    assert "spring 3 is cracked" in chained.now.names
    assert chained.now.limits["spring 3 is cracked"].clear == 1.0
    outcome = chained.now.outcomes["spring 3 is cracked"]
    assert outcome.kind == "named"
    seen = chained.now.limits["spring 3 is cracked"].seen
    assert 0 < seen < 0.2


def test_springs_and_bodies_at_one_place_are_one_cause_in_doubt_of_its_place(chained: Forecast) -> None:
    """The end is a node set and a point of the test: what holds it is the same under both names."""
    assert chained.now.outcomes["ground_spring at end along x"].kind == "place"
    assert chained.now.outcomes["ground_spring at end along x"].rivals == ("ground_spring",)
    body = chained.now.outcomes["lumped_mass at end"]
    assert body.kind == "class"
    assert set(body.rivals) == {"sensor_mass", "lumped_mass"}


def test_the_document_names_effects_places_and_what_is_expected(chained: Forecast) -> None:
    document = json.loads(json.dumps(to_json(chained), allow_nan=False))
    rows = {row["name"]: row for row in document["now"]["effects"]}
    assert rows["local_stiffness of low"]["effect"] == "local_stiffness"
    assert rows["local_stiffness of low"]["at"] == "low"
    assert rows["E"]["at"] is None
    assert {row["outcome"] for row in rows.values()} <= {"named", "place", "edge", "class", "unseen"}
    for row in rows.values():
        assert set(row["sigma"]) == {"none", *rows}
        assert (row["outcome"] in ("named", "unseen")) == (not row["not_told_from"])


def test_a_curve_is_met_between_the_severities_that_were_solved(chained: Forecast) -> None:
    own = chained.bench
    assert isinstance(own, OwnBench)
    have, white = own.columns(own.design), own.whitener(own.design)
    for curve in chained.curves:
        if len(curve.family.places):
            continue
        for share in (0.13, 0.37, 0.73):
            target = own.change(curve.family, share * curve.family.clear, 0.0)[have]
            (left,) = Surface(curve.cloud[..., have]).distance(target[None], white)
            assert left < max(1.0, curve.fidelity * np.linalg.norm(white @ target)), curve.family.name


def test_modes_are_known_again_when_all_frequencies_move(tmp_path: Path) -> None:
    """A modulus moves all frequencies alike and no shape: nothing else may be in its change."""
    own = bench(tmp_path)
    modulus = next(family for family in own.families if family.name == "E")
    for q in (0.02, 0.3, 0.8):
        change = own.change(modulus, q, 0.0)
        assert change[:MASSES] == pytest.approx(q / 2, abs=1e-9)
        assert np.abs(change[MASSES:]).max() < 1e-6


@pytest.mark.long
def test_a_trial_on_the_model_answers_as_was_forecast(tmp_path: Path) -> None:
    found = forecast(bench(tmp_path))
    checked = check(found, 3, 2)
    assert all(one.kept for one in checked.tried), checked.table.to_string()
    assert not departures(plain(checked.to_json()), CheckedForecast)


def test_softer_springs_at_the_foot_are_heavier_masses_at_the_end_to_frequencies_and_not_to_shapes(
    tmp_path: Path,
) -> None:
    """B' S B on masses M has the eigenvalues of B M^-1 B' on compliances S^-1, which is the chain turned round."""
    own = bench(tmp_path)
    pair = [f for f in own.families if f.name in ("local_stiffness of low", "local_mass of high")]
    curves = [own.solve(family) for family in pair]
    apart = {
        shapes: distances(curves, replace(own.design, shapes=shapes), own)[0].clear_of(pair[1].name)
        for shapes in (False, True)
    }
    assert apart[False] < 0.1
    assert apart[True] > SEEN


def test_where_frequencies_alone_are_known_shapes_are_proposed(tmp_path: Path) -> None:
    rows = "\n".join(f"{f:.6g},{1e-4 * f:.3g}" for f in closed_form({})[:5])
    (tmp_path / "modes.csv").write_text(f"frequency,sigma\n{rows}\n")
    own = bench(tmp_path, test='modes = "modes.csv"')
    assert not own.design.shapes
    assert len(own.columns(own.design)) == 5
    shapes = next(one for one in own.changes(own.design, lambda _: 0.0) if one.key == "shapes")
    assert "not frequencies alone" in shapes.measure
    assert len(own.columns(shapes.design)) > 5
    white = own.whitener(shapes.design)
    assert np.isfinite(white).all()


def test_a_mode_without_a_partner_in_the_model_does_not_stand_in_the_way(tmp_path: Path) -> None:
    """A table of modes of which one is not one of the model's is forecast by the others."""
    rows = ["frequency,sigma,2+X,4+X,6+X"]
    own = np.sin(np.outer((2, 4, 6), (2 * np.arange(1, 4) - 1) * np.pi / 13))
    for f, shape in zip(closed_form({}), own.T, strict=False):
        rows.append(f"{f:.6g},{1e-3 * f:.3g}," + ",".join(f"{v:.5g}" for v in shape))
    rows.append("130,0.1,1,-1,0.02")
    (tmp_path / "modes.csv").write_text("\n".join(rows) + "\n")
    found = bench(tmp_path, test='modes = "modes.csv"')
    assert found.design.modes == 3
    family = next(f for f in found.families if f.name == "local_stiffness of middle")
    change = found.change(family, float(np.log(1 / 0.7)), 0.0)
    softer = np.log(closed_form({2: 0.7, 3: 0.7}) / closed_form({}))
    assert change[:4] == pytest.approx(softer[:4], abs=1e-9)


def test_points_are_proposed_by_node_direction_and_region(chained: Forecast) -> None:
    points = next(one for one in chained.advice if one.change.key == "points")
    assert "node" in points.change.measure
    assert "along x" in points.change.measure
    assert any(part in points.change.measure for part in PARTS)
    assert len(points.change.design.stations) == 5


def test_a_support_has_one_name_and_its_place_is_printed() -> None:
    """One that is no node set bears a number, which says nothing by itself."""
    supports = (support("support 1"), support("FOOT"))
    predictor: Any = SimpleNamespace(spec=SimpleNamespace(imported=SimpleNamespace(supports=supports)))
    assert where_supports_are(predictor) == [
        "support 1 is about x = 20, y = 15, z = -5 mm",
        "support FOOT is about x = 20, y = 15, z = -5 mm",
    ]
    effect: Any = SimpleNamespace(
        name="clamp_translation", parameters=lambda _: (Parameter("stiffness", "N/m", 1e3, 1e9, ""),)
    )
    words = [family.words for family in MAKERS["clamp_translation"](effect, predictor)]
    assert words == ["support 1 softer than"] * 3 + ["support FOOT softer than"] * 3


def support(name: str) -> Support:
    whole = np.eye(6)
    return Support(
        name=name,
        centre=np.array([0.02, 0.015, -0.005]),
        loads=np.zeros((6, 6)),
        own=whole,
        mass=whole,
        inertia=whole,
        held_by=whole[0],
        carried_by=whole[0],
    )


def test_a_change_that_makes_the_test_worse_is_not_offered(chained: Forecast) -> None:
    best = chained.advice[0]
    worse = replace(best, worth=-0.2, factor=0.85, separates=())
    trade = replace(best, worth=0.1, factor=0.8, separates=(("E", "density"),))
    found = replace(chained, advice=(best, trade, worse))
    assert offered(found) == [best, trade]
    assert brings(trade) == "E from density; separable severities become 1.25 times larger"
    assert not brings(replace(best, separates=(), factor=1.0))
    assert note(replace(found, advice=(trade,)))[-1].endswith("separable severities become 1.2 times larger.")


def test_a_plate_is_forecast_by_its_own_model(tmp_path: Path) -> None:
    path = tmp_path / "plate.toml"
    path.write_text(
        PLATE.format(test="points = [[0.2, 0.05], [0.2, 0.15], [0.4, 0.0], [0.4, 0.2]]\nband = [1.0, 150.0]")
    )
    own = bench_of(read_study(path))
    assert isinstance(own, OwnBench)
    assert len(own.design.stations) == 4
    names = {family.name for family in own.families}
    assert {"E", "thickness", "local_stiffness", "local_mass", "orthotropy", "clamp_rotation"} <= names
    assert "lumped_mass" in names
    modulus = next(family for family in own.families if family.name == "E")
    assert own.change(modulus, 0.1, 0.0)[: own.design.modes] == pytest.approx(0.05, abs=1e-9)
    path.write_text(PLATE.format(test=""))
    assert len(bench_of(read_study(path)).design.stations) == 20


@pytest.mark.long
def test_the_command_prints_writes_and_draws(tmp_path: Path) -> None:
    path = study(tmp_path)
    document, report = tmp_path / "plan.json", tmp_path / "plan.html"
    wanted = [
        "blind",
        str(path),
        "--json",
        str(document),
        "--report",
        str(report),
        "--figures",
        str(tmp_path / "f"),
    ]
    done = CliRunner().invoke(app, wanted)
    assert done.exit_code == 0, done.output
    assert "Named:" in done.output
    assert "local_stiffness of middle" in done.output
    assert json.loads(document.read_text())["schema"] == "modalkit.plan/1"
    assert "local_stiffness of middle" in report.read_text()
    assert (tmp_path / "f" / "planning.png").exists()
