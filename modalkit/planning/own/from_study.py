"""What a study states about a test of its own model: points, modes and doubts from the data, or as planned."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from modalkit.planning.design import Design
from modalkit.planning.own.bench import OwnBench
from modalkit.planning.own.candidates import candidates
from modalkit.planning.own.layout import Known, Layout, by_default, imagined, layout_of
from modalkit.planning.own.parts import where_supports_are
from modalkit.planning.own.tracked import Tracked
from modalkit.simulation.planned import spaced
from modalkit.study.read import Study
from modalkit.workflow.case import open_study
from modalkit.workflow.planned_points import PlannedPoints, planned_points
from updating import Case, Measured, Predictor, Spec
from updating.nominal import predictor_of
from updating.prediction.matching import pair_modes
from updating.problem.specimen import SpecimenProblem
from updating.tolerances import Tolerances

SHAPE_FLOOR = 1e-3
"""No constant is taken to be known better than this, relative to its mode's largest: points are not that good [-]."""

GAS = 10.0
"""A surrounding of less density moves nothing that can be seen [kg/m3]."""

FIRST_MODES, MANY = 5, 40
"""Modes that are examined where no band is stated, and most that a band may hold [-]."""

FAINT = 0.02
"""A mode moves no point if it moves all by less than this share of what the middle mode does [-]."""

ALONG = 8
"""Points along a beam where the points hit are not stated."""

HITS = 5
"""Hits at each point where their number is not stated [-]."""


@dataclass(frozen=True, eq=False)
class _Test:
    """A test, its model, and which of the model's modes are in it."""

    predictor: Predictor
    tolerances: Tolerances
    ranks: IntArray
    known: Known
    band: tuple[float, float]
    hits: int
    assumptions: tuple[str, ...]

    @property
    def measured(self) -> Measured:
        """The test's points and FRFs."""
        return self.predictor.measured


def bench_of(study: Study) -> OwnBench:
    """Return a study's own model and its test as the forecast takes them.

    Parameters
    ----------
    study : Study
        With data or without; what the data do not determine is taken by default, and reported.

    Raises
    ------
    StudyError
        If the points to be hit are not stated, or its band holds too few modes.
    """
    test = _with_data(study) if study.test.files or study.test.modes else _planned(study)
    shown = _shown(test.predictor)
    ranks = np.append(test.ranks, shown[shown > test.ranks[-1]][:1])
    layout = layout_of(test.measured, candidates(test.predictor, ranks, test.measured.points))
    blank = test.predictor.for_test(layout.blank)
    data = imagined(layout, blank, ranks, test.known.of(len(ranks)))
    problem = Tracked(predictor=blank.for_test(data), measured=data, tolerances=test.tolerances, order=ranks)
    around = study.surroundings().fluid_density
    without = ("fluid_added_mass", "fluid_damping") if around is not None and around < GAS else ()
    design = _design(study, test, layout, problem)
    return OwnBench(
        study=study,
        problem=problem,
        layout=layout,
        ranks=ranks,
        design=design,
        band=test.band,
        hits=test.hits,
        assumptions=(*test.assumptions, *_on_damping(design), *where_supports_are(test.predictor)),
        left_out=tuple(_left_out(study)),
        without=without,
    )


def _design(study: Study, test: _Test, layout: Layout, problem: SpecimenProblem) -> Design:
    table = study.test
    return Design(
        stations=layout.own,
        modes=len(test.ranks),
        calibration=table.calibration,
        repeatability=table.repeatability,
        noise=1.0,
        position_sigma=table.position_sigma,
        tolerances=tuple(problem.sigmas.tolist()),
        damping=problem.tolerances.damping,
        damping_known=bool(len(problem.damping_known)),
        shapes=test.measured.has_shapes,
        absolute=test.measured.absolute,
        baseline=study.baseline is not None,
    )


def _on_damping(design: Design) -> list[str]:
    stated = (
        "damping as expected by the model"
        if design.damping_known
        else "the model states no expected damping: damping is not used"
    )
    return [stated, *(["with the baseline, only changes since then are forecast"] if design.baseline else [])]


def _left_out(study: Study) -> list[str]:
    model = study.model
    effects = [] if model is None else [str(entry.get("name")) for entry in model.effect]
    return [f"effects put into the model stay as they are: {', '.join(effects)}"] if effects else []


def _with_data(study: Study) -> _Test:
    """Return the test that was made: its points, and those of its modes that have a partner in the model."""
    session = open_study(study, with_baseline=False)
    case, processed = session.case, session.processed
    predictor = predictor_of(case)
    paired = pair_modes(case.measured, predictor.predict())
    rising = np.argsort(paired.order)
    test = paired.measured.modes(rising)
    known, words = _as_found(test)
    band = study.test.band or (0.0, float(1.1 * test.frequency.max()))
    used = [] if processed is None else [v for v in processed.hits if v.used]
    hits = round(len(used) / max(len({v.point for v in used}), 1)) if used else (study.test.hits or HITS)
    where = f"{len(np.unique(test.points, axis=0))} points, {len(test.seen)} FRFs or components of shapes"
    assumptions = (
        where if len(test.seen) else "frequencies alone",
        f"{len(test.frequency)} modes that have a partner in the model",
        words,
    )
    inside = float(band[0]), float(band[1])
    return _Test(
        predictor.for_test(test), case.tolerances, paired.order[rising], known, inside, hits, assumptions
    )


def _as_found(test: Measured) -> tuple[Known, str]:
    """Return how well the data are known by their own word, and that in words."""
    frequency, damping, shape = by_default(len(test.frequency))
    frequency = np.asarray(test.frequency_sigma / test.frequency)
    words = [f"frequencies known to {100 * np.median(frequency):.2g} %"]
    relative = test.damping_sigma / test.damping
    if np.isfinite(relative).all():
        damping = np.asarray(relative)
        words.append(f"damping to {100 * np.median(damping):.2g} %")
    if test.has_shapes:
        largest = np.abs(test.constants).max(axis=0)
        shape = np.maximum(np.median(test.constants_sigma, axis=0) / largest, SHAPE_FLOOR)
        words.append(f"constants to {100 * np.median(shape):.2g} % of their mode's largest")
    return Known(frequency, damping, shape), f"from the identification: {', '.join(words)}"


def _planned(study: Study) -> _Test:
    """Return the test that is only planned: its points, and the model's modes in its band."""
    spec, table = study.spec(), study.test
    stated = planned_points(study, spec)
    points = _spaced(study, spec) if stated is None else stated
    case = Case(
        study.name, spec, points.test(study, points.hit[0]), baseline=None, tolerances=study.doubts(),
        environment=study.surroundings(), accepted=study.accepted(),
    )  # fmt: skip
    predictor = predictor_of(case)
    ranks, band = _in_band(study, predictor.predict(count=MANY).frequency, _shown(predictor))
    sensor = points.sensor
    if sensor is None:
        sensor = points.hit[_strongest(predictor, np.array(points.hit), ranks)]
    test = predictor.for_test(points.test(study, sensor))
    frequency, damping, shape = by_default(len(ranks))
    whence = (
        "as planned" if stated is not None else "by default, since neither data nor [test] points state where"
    )
    assumptions = (
        f"{len(points.hit)} points hit, the sensor at point {points.nodes[sensor]} ({whence})",
        f"{len(ranks)} modes in {band[0]:g} to {band[1]:g} Hz",
        f"assumed, without data: frequencies to {100 * frequency[0]:g} %, damping to {100 * damping[0]:g} "
        f"%, constants to {100 * shape[0]:g} % of their mode's largest",
    )
    known = Known(frequency, damping, shape)
    return _Test(test, case.tolerances, ranks, known, band, table.hits or HITS, assumptions)


def _spaced(study: Study, spec: Spec) -> PlannedPoints:
    """Return evenly spaced points where a study names none.

    Raises
    ------
    StudyError
        If the model has no outline.
    """
    if not spec.outlined:
        raise StudyError(
            f"{study.path}: the points to be hit are not stated; give [test] points, a node and its direction "
            'as "12+Z" or [x, y, z, "+z"] each, or data'
        )
    points = spaced(spec, ALONG if spec.kind == "beam" else None)
    return PlannedPoints(points, tuple(range(1, len(points) + 1)), None, tuple(range(len(points))), None)


def _shapes(predictor: Predictor, points: IntArray) -> FloatArray:
    """Return how far the model's lowest modes, normalised by their mass, move some points of a test (n, n_modes)."""
    bare = replace(predictor.measured, seen=points, hit=np.full(len(points), -1))
    return np.abs(predictor.for_test(bare).predict(count=MANY).constants)


def _shown(predictor: Predictor) -> IntArray:
    """Return the ranks of the modes that move any of the points of a test: of one that moves none nothing is known."""
    test = predictor.measured
    if not len(test.seen):
        return np.arange(len(predictor.predict(count=MANY).frequency))
    moved = _shapes(predictor, np.unique([test.seen, np.maximum(test.hit, 0)])).max(axis=0)
    return np.flatnonzero(moved > FAINT * np.median(moved))


def _strongest(predictor: Predictor, hit: IntArray, ranks: IntArray) -> int:
    """Return which of the points hit moves most in the mode that moves it least, each over its largest."""
    shapes = _shapes(predictor, hit)[:, ranks]
    return int((shapes / np.maximum(shapes.max(axis=0), 1e-300)).min(axis=1).argmax())


def _in_band(study: Study, frequency: FloatArray, shown: IntArray) -> tuple[IntArray, tuple[float, float]]:
    """Return which modes, of those that the points show, a band holds; left out, it reaches over the first few.

    Raises
    ------
    StudyError
        If it holds fewer than two, or the points show fewer.
    """
    band = study.test.band
    if len(shown) < 2:
        raise StudyError(
            f"{study.path}: [test] points: {len(shown)} of the model's modes move any point, but a forecast needs two; "
            "check whether the points lie at supports, or along directions without motion"
        )
    if band is None:
        last, above = frequency[shown[min(FIRST_MODES, len(shown) - 1) - 1 :][:2]]
        band = (float(f"{0.25 * frequency[0]:.2g}"), float(f"{np.sqrt(last * above):.3g}"))
    ranks = shown[(frequency[shown] >= band[0]) & (frequency[shown] <= band[1])]
    if len(ranks) < 2:
        raise StudyError(
            f"{study.path}: [test] band = [{band[0]:g}, {band[1]:g}] Hz holds {len(ranks)} of the model's modes "
            f"that the points show, the lowest of which is at {frequency[shown[0]]:.4g} Hz; a forecast needs two"
        )
    return ranks, (float(band[0]), float(band[1]))
