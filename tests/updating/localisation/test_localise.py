"""All methods side by side: who puts which region first, how far they agree, and what cannot be compared."""

from dataclasses import replace

import numpy as np
import pytest
from imported_cases import LENGTH, imported_beam, seen_from, spec_of
from test_localisation import BEAM, altered, soft
from updating_cases import ExactBeam, case_of, specimen, struck

from acquisition import InputError
from updating import Predictor
from updating.diagnosis.diagnose import pose
from updating.localisation import METHODS, Localisation, Ranked, localise


def ranked(*rows: list[float]) -> Localisation:
    """A localisation with these scores of each method."""
    found = tuple(Ranked(name, np.array(row)) for name, row in zip(METHODS, rows, strict=False))
    names = tuple("abcdef"[: len(rows[0])])
    return Localisation("case", "stiffness", names, np.zeros((len(names), 1)), found, {})


@pytest.mark.parametrize("zone", [1, 4, 6])
def test_the_soft_zone_is_first_by_the_methods_that_claim_it(zone: int) -> None:
    found = localise(
        soft(zone, 0.5, as_designed=True), methods=("evidence", "subspace", "subspace-plain", "comac")
    )
    assert found.favourite[0] == zone
    table = found.table()
    assert table["region"][0] == f"zone{zone + 1}"
    assert table.loc[0, ["evidence", "subspace", "subspace-plain"]].tolist() == [1, 1, 1]
    assert table["probability"][0] > 0.9
    assert found.unchanged is not None and found.unchanged < 0.01
    assert found.centres[zone, 0] == pytest.approx(BEAM.length * (zone + 0.5) / 10)


@pytest.mark.long
def test_without_a_gap_no_change_is_the_most_probable() -> None:
    rng = np.random.default_rng(8)
    found = localise(pose(case_of(struck(specimen(rng), rng), BEAM))[0], methods=("evidence",))
    assert found.unchanged is not None and found.unchanged > 0.5
    assert found.concordance is None
    assert found.spread == ""


@pytest.mark.parametrize("kind", ["mass", "damping"])
def test_methods_of_stiffness_say_so_when_another_kind_is_compared(kind: str) -> None:
    found = localise(altered(kind), kind=kind)  # type: ignore[arg-type]
    assert found.regions[found.favourite[0]] == "zone8"
    assert {"mece", "force-serep", "force-dynamic", "comac"} <= set(found.not_used)
    assert found.not_used["mece"] == "compares stiffness alone"


def test_concordance_is_that_of_a_published_example() -> None:
    """Kendall, Rank Correlation Methods (1948), chapter 6: three judges, six objects, S = 25.5, W = 0.16."""
    orders = ([5, 4, 1, 6, 3, 2], [2, 3, 1, 5, 6, 4], [4, 1, 6, 3, 2, 5])
    assert ranked(*([-float(r) for r in row] for row in orders)).concordance == pytest.approx(
        0.1619, abs=1e-4
    )


def test_concordance_is_one_where_all_rank_alike_equal_ranks_too() -> None:
    assert ranked([3.0, 1.0, 1.0], [9.0, 2.0, 2.0]).concordance == pytest.approx(1.0)
    assert ranked([3.0, 2.0, 1.0], [1.0, 2.0, 3.0]).concordance == pytest.approx(0.0)


def test_equals_share_their_rank_and_put_nothing_first() -> None:
    found = ranked([2.0, 2.0, 1.0], [1.0, 0.0, 2.0])
    assert found.found[0].ranks.tolist() == [1.5, 1.5, 3.0]
    assert found.found[0].first is None
    assert found.favourite == (2, 1)


def test_what_cannot_be_compared_is_refused_with_the_reason() -> None:
    problem = soft(3, 0.4)
    with pytest.raises(InputError, match="no method 'guess'"):
        localise(problem, methods=("guess",))
    one = replace(BEAM, regions=BEAM.regions[:1])
    rng = np.random.default_rng(3)
    test = struck(ExactBeam(BEAM.length, BEAM.width, BEAM.thickness), rng)
    with pytest.raises(InputError, match=r"one region.*\[\[model.region\]\]"):
        localise(pose(case_of(test, one))[0])
    with pytest.raises(InputError, match=r"comac.*mode shapes"):
        none, nothing = np.zeros(0, int), np.zeros((0, 5))
        alone = replace(test, seen=none, hit=none, constants=nothing, constants_sigma=nothing)
        localise(pose(case_of(alone, BEAM))[0], methods=("comac",))


def test_matrices_without_parts_say_which_are_missing() -> None:
    spec = spec_of(imported_beam(20))
    points = np.zeros((5, 3))
    points[:, 0] = LENGTH * np.linspace(0.2, 1.0, 5)
    seen = seen_from(points, np.tile([0.0, 0.0, 1.0], (5, 1)), np.linspace(10.0, 300.0, 4))
    found = Predictor(spec, seen).predict(count=4)
    test = replace(
        seen, frequency=found.frequency, frequency_sigma=1e-3 * found.frequency, constants=found.constants,
        constants_sigma=0.01 * np.abs(found.constants) + 1e-4,
    )  # fmt: skip
    with pytest.raises(InputError, match="needs stiffness_parts in"):
        localise(pose(case_of(test, spec))[0])
