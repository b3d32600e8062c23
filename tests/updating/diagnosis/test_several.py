"""Several specimens diagnosed together: what they share has one value, all else one for each."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from effect_cases import imported
from updating_cases import BEAM as FINE
from updating_cases import DOUBTS, POINTS, blank, exactly, observed
from updating_cases import PLATE as FINE_PLATE

from acquisition.errors import InputError
from updating import Case, Predictor, Spec, Tolerances
from updating.diagnosis.answer.result import Diagnosis
from updating.diagnosis.answer.where import locate
from updating.diagnosis.decision import on_one
from updating.diagnosis.diagnose import diagnose_together, pose
from updating.diagnosis.problem.recent import Recent
from updating.diagnosis.problem.several import Several
from updating.diagnosis.search.compared import Compared, Search
from updating.diagnosis.search.evidence import explain
from updating.effects import LIBRARY
from updating.effects.base import Variant
from updating.likelihood.comparison import Comparison
from updating.models.state import NOMINAL, State, combine
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

BEAM = FINE.with_elements(12)
PLATE = FINE_PLATE.with_elements(8, 5)
EXTENSION, MASS, SOFT, RATIO = 0.008, 0.012, 0.88, 0.7
LENGTH, SENSOR, STIFF, ACROSS = (LIBRARY[n] for n in ("length", "sensor_mass", "E", "orthotropy"))
BOTH = ("length", "sensor_mass")
FEW = (LENGTH, SENSOR, STIFF)


def grid(spec: Spec) -> np.ndarray:
    if spec.kind == "beam":
        return POINTS
    across = np.meshgrid(POINTS, np.array([0.0, 0.08, 0.2]), indexing="ij")
    return np.stack([a.ravel() for a in across], axis=1)


@cache
def specimen_of(kind: str, title: str, *causes: str) -> Case:
    """A specimen on a finer mesh, off by its own tolerances, with causes of the sizes above."""
    spec = BEAM if kind == "beam" else PLATE
    rng = np.random.default_rng([len(kind), len(causes), 21])
    points = grid(spec)
    finer = spec.with_elements(*(2 * n for n in spec.elements))
    predictor = Predictor(finer, blank(points, top=800.0))
    sizes = {
        "length": {"extension": EXTENSION},
        "sensor_mass": {"mass": MASS},
        "E": {"factor": SOFT},
        "orthotropy": {"ratio": RATIO},
    }
    built = State(factors={n: float(np.exp(s * rng.standard_normal())) for n, s in DOUBTS.items()})
    state = combine([built, *(LIBRARY[name].state(predictor, sizes[name]) for name in causes)])
    found = predictor.predict(state, count=5 if kind == "beam" else 7)
    damping = found.damping * np.exp(0.2 * rng.standard_normal(len(found.damping)))
    measured = observed(found.frequency, damping, found.constants, points, rng)
    return Case(title, spec, measured, tolerances=Tolerances(DOUBTS))


def several(*cases: Case, shared: tuple[str, ...] = ()) -> Several:
    problems = tuple(pose(case)[0] for case in cases)
    return Several(problems, tuple(case.title for case in cases), frozenset(shared))


@cache
def sharing(*shared: str) -> Several:
    return several(
        specimen_of("beam", "strip", "length", "sensor_mass", "E"),
        specimen_of("plate", "sheet", "length", "sensor_mass"),
        shared=shared,
    )


@cache
def together(*shared: str) -> Diagnosis:
    cases = (
        specimen_of("beam", "strip", "length", "sensor_mass"),
        specimen_of("plate", "sheet", "length", "sensor_mass"),
    )
    return diagnose_together(cases, shared=shared, library=FEW)


@pytest.mark.long
def test_shared_parameters_have_one_value_and_others_one_on_each() -> None:
    problem = sharing("length", "sensor_mass")
    candidate = Candidate((LENGTH, STIFF, SENSOR))
    names = [name for name, _ in problem.parameters(candidate)]
    assert names == [
        "length.extension",
        "E.factor (strip)",
        "E.factor (sheet)",
        "sensor_mass.mass",
        "sensor_mass.bulk",
        "sensor_mass.dx",
    ]
    coordinates = np.array([0.6, 0.3, 0.8, 0.5, 0.2, 0.5])
    values = problem.values(candidate, coordinates)
    assert list(values) == names
    states = problem.place(candidate, coordinates)
    for state, spec, quantile in zip(states, (BEAM, PLATE), (0.3, 0.8), strict=True):
        assert state.factors["length"] == pytest.approx(1 + values["length.extension"] / spec.length)
        own = STIFF.parameters(problem.predictor)[0].value(quantile)
        assert state.factors["E"] == pytest.approx(own)


def test_the_data_of_all_specimens_stand_side_by_side_and_share_no_nuisance() -> None:
    problem = sharing("length")
    candidate = Candidate((LENGTH,))
    whole = problem.at(candidate, np.array([0.55]))
    extension = problem.values(candidate, np.array([0.55]))["length.extension"]
    parts = [
        one.compare(
            LENGTH.state(one.predictor, {"extension": extension}), doubt=candidate.doubt_on(one.predictor)
        )
        for one in problem.specimens
    ]
    assert whole.residual == pytest.approx(np.concatenate([part.residual for part in parts]))
    first = len(parts[0].residual)
    columns = parts[0].nuisance.shape[1]
    assert not whole.nuisance[:first, columns:].any()
    assert not whole.nuisance[first:, :columns].any()
    assert len(np.unique(whole.mode)) == 5 + 7


@pytest.mark.long
def test_one_value_for_both_explains_as_well_as_one_for_each_and_is_more_probable() -> None:
    candidate = Candidate((LENGTH, SENSOR))
    cases = (
        specimen_of("beam", "strip", "length", "sensor_mass"),
        specimen_of("plate", "sheet", "length", "sensor_mass"),
    )
    joint = explain(several(*cases, shared=("length", "sensor_mass")), candidate)
    apart = explain(several(*cases), candidate, laplace_only=True)
    single = [explain(pose(case)[0], candidate).log_evidence for case in cases]
    assert joint.log_evidence > sum(single) + 1
    assert apart.best.marginal.log_likelihood >= joint.best.marginal.log_likelihood - 0.5


@pytest.mark.long
def test_without_anything_shared_the_evidence_is_that_of_each_alone() -> None:
    problem = several(specimen_of("beam", "strip"), specimen_of("plate", "sheet"))
    candidate = Candidate((LENGTH,))
    whole = explain(problem, candidate)
    alone = [explain(one, candidate).log_evidence for one in problem.specimens]
    # how much worse than thought the shapes are is one scale for all specimens together, whose prior counts once
    once = -np.log(problem.specimens[0].compare(NOMINAL).scale_prior[0])
    assert whole.log_evidence == pytest.approx(sum(alone), abs=2 * once + 0.1)


@pytest.mark.long
def test_a_cause_of_one_specimen_alone_is_found_beside_those_of_both() -> None:
    problem = sharing("length", "sensor_mass")
    found = explain(problem, Candidate((LENGTH, SENSOR, STIFF)))
    values = problem.values(found.candidate, found.best.coordinates)
    assert values["length.extension"] == pytest.approx(EXTENSION, abs=0.002)
    assert values["sensor_mass.mass"] == pytest.approx(MASS, rel=0.15)
    assert values["E.factor (strip)"] == pytest.approx(SOFT, abs=0.03)
    assert values["E.factor (sheet)"] == pytest.approx(1.0, abs=0.03)


@pytest.mark.long
def test_length_and_sensor_of_two_specimens_are_named() -> None:
    found = together("length", "sensor_mass")
    assert found.significant
    assert set(found.ranking[0].effects) == {"length", "sensor_mass"}
    assert set(found.gap.modes["study"]) == {"strip", "sheet"}
    assert found.title == "strip and sheet"


def test_titles_alike_and_unknown_shared_effects_are_refused() -> None:
    one = specimen_of("beam", "strip", "length", "sensor_mass")
    with pytest.raises(InputError, match="have the same title"):
        diagnose_together([one, one])
    other = replace(one, title="another")
    with pytest.raises(InputError, match="no such effect"):
        diagnose_together([one, other], shared=("lenght",))


@pytest.mark.long
@pytest.mark.parametrize("order", [("beam", "plate"), ("plate", "beam")])
@pytest.mark.parametrize("shared", [(), ("orthotropy",)])
def test_an_effect_that_cannot_be_on_one_specimen_is_sought_on_the_other(
    order: tuple[str, ...], shared: tuple[str, ...]
) -> None:
    cases = [specimen_of(k, k, *(("orthotropy",) if k == "plate" else ())) for k in order]
    problem = several(*cases, shared=shared)
    assert problem.applies(ACROSS) is None
    found = explain(problem, Candidate((ACROSS,)))
    values = problem.values(found.candidate, found.best.coordinates)
    whose = "" if shared else " (plate)"
    assert list(values) == [f"orthotropy.{name}{whose}" for name in ("ratio", "shear_ratio", "coupling")]
    assert next(iter(values.values())) == pytest.approx(RATIO, rel=0.1)
    states = problem.place(found.candidate, found.best.coordinates)
    assert [bool(state.factors) for state in states] == [k == "plate" for k in order]
    for i, kind in enumerate(order):
        part = found.restricted(*problem.part(found.candidate, i))
        assert part.names == (("orthotropy",) if kind == "plate" else ())
        assert part.samples.shape[1] == 3 * (kind == "plate")


@pytest.mark.long
def test_the_place_is_told_on_the_specimen_on_which_the_cause_acts() -> None:
    cases = [specimen_of("beam", "strip"), specimen_of("plate", "sheet", "orthotropy")]
    found = diagnose_together(cases, library=(ACROSS, LIBRARY["density"]))
    assert found.ranking[0].effects == ("orthotropy",)
    assert found.where.channels["stiffness"] > 0.95
    assert len(found.where.zones) == len(PLATE.regions)


@pytest.mark.long
def test_of_matrices_places_are_those_of_the_specimen_on_which_the_cause_acts() -> None:
    """Of two forms of one cause, a test point of both beams and a node set of the second, the first has the one."""
    spring, cases = LIBRARY["ground_spring"], []
    for title, sets in (("first", {}), ("second", {"tip": np.array([21])})):
        bare = imported()
        assert bare.spec.imported is not None
        whole = replace(bare.spec.imported, nodes=replace(bare.spec.imported.nodes, sets=sets))
        bare = bare.of(replace(bare.spec, imported=whole))
        at = dict(zip("xyz", bare.measured.points[2].tolist(), strict=True))
        state = spring.state(bare, {**at, "stiffness": 4e3})
        test = exactly(bare, bare.predict(state, count=4), damping=np.full(4, np.nan))
        cases.append(Case(title, bare.spec, test, tolerances=Tolerances({"E": 0.01})))
    problem = several(*cases)
    point = Variant({**at, "extent": 0.0, "damping": 0.0})
    tip = Variant({**point.values, "x": 0.5, "at": "tip", "along": "z"})
    one, other, nothing = (
        explain(problem, Candidate(effects, chosen=forms), laplace_only=True)
        for effects, forms in (((spring,), (point,)), ((spring,), (tip,)), ((), ()))
    )
    rows = (
        Compared(
            explanation=one, probability=1.0, p_value=0.5, as_stated=0.5, forms=((one, 0.6), (other, 0.4))
        ),
        Compared(explanation=nothing, probability=0.0, p_value=0.0, as_stated=0.0),
    )
    whole = Search(nothing, rows, {})
    found = locate(*on_one(problem, whole), verdict="named", whole=whole)
    assert found.locations == (pytest.approx(bare.measured.points[2]),)


@pytest.mark.long
def test_no_effect_on_either_is_no_gap() -> None:
    found = diagnose_together([specimen_of("beam", "strip"), specimen_of("plate", "sheet")], library=FEW)
    assert not found.significant
    assert found.verdict == "none"


@pytest.mark.long
def test_while_one_specimen_moves_the_others_are_not_compared_again(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, made = replace(sharing(), recent=Recent()), []
    assert all(one.linearised for one in problem.specimens)  # which takes a comparison of its own, once
    compare = SpecimenProblem.compare

    def counted(self: SpecimenProblem, *args: object, **options: object) -> Comparison:
        made.append(self)
        return compare(self, *args, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(SpecimenProblem, "compare", counted)
    candidate = Candidate((STIFF,))  # a modulus of each
    first = problem.at(candidate, np.array([0.4, 0.4]))
    moved = problem.at(candidate, np.array([0.4, 0.5]))
    assert made == [*problem.specimens, problem.specimens[1]]
    again = replace(problem, recent=Recent())
    for u, found in ((0.4, first), (0.5, moved)):
        anew = again.at(candidate, np.array([0.4, u]))
        assert np.array_equal(anew.residual, found.residual)
        assert np.array_equal(anew.nuisance, found.nuisance)


def test_the_strain_of_each_specimen_is_that_of_its_own_nuisances() -> None:
    """Whatever else a set of causes leaves in doubt beside them."""
    both = sharing()
    candidate = Candidate((LENGTH,))
    middle = np.full(len(both.parameters(candidate)), 0.5)
    found = both.at(candidate, middle)
    second = both.specimens[1]
    shift = np.zeros(found.nuisance.shape[1])
    shift[found.moving[-second.linearised :]] = 1.0
    assert both.strain(shift[found.moving]) == second.strain(np.ones(second.linearised))
    assert found.tolerances[-1] >= len(both.at(Candidate(), np.zeros(0)).tolerances)
