"""The study file: a test, a model, doubts. Read strictly, so that a misspelt key is an error and not a default.

Models are loaded where a study is asked for one: a file with a mistake is refused without them.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from acquisition.errors import StudyError
from modalkit.study.errors import explain, known_keys
from modalkit.study.hypothesis_table import HypothesisTable
from modalkit.study.model_tables import MATRICES_ONLY, ModelTable
from modalkit.study.probable_units import check_units
from modalkit.study.strict import Strict
from modalkit.study.tables import EnvironmentTable, MeasurementTable, TolerancesTable, UpdateTable
from modalkit.study.toml import read_toml

if TYPE_CHECKING:
    from updating.environment import Environment
    from updating.models import Damping, Spec
    from updating.models.spec import Kind
    from updating.test_data.axes import Axes
    from updating.tolerances import Tolerances


NOTHING = 1e-9
"""Tolerances below this are none: their squares, and one over them, are no use as numbers [-]."""


class Study(Strict):
    """A whole study file.

    Use :func:`read_study`; paths are relative to ``folder``.
    """

    title: str = ""
    """Name of the study in outputs."""
    author: str = ""
    """Who signs for the report; left out, the environment variable MODALKIT_AUTHOR."""
    note: str = ""
    """Free text, not used."""
    test: MeasurementTable
    baseline: MeasurementTable | None = None
    model: ModelTable | None = None
    hypothesis: tuple[HypothesisTable, ...] = ()
    tolerances: TolerancesTable = TolerancesTable()
    environment: EnvironmentTable = EnvironmentTable()
    update: UpdateTable = UpdateTable()
    path: Path = Path("study.toml")

    def file(self, name: str) -> Path:
        """Return a file of the study, relative to the study file."""
        return self.path.parent / name

    def inputs(self) -> tuple[Path, ...]:
        """Return the study file and every file it names."""
        names: list[str | None] = []
        for table in (self.test, self.baseline):
            names += [] if table is None else [*table.files, table.modes, table.layout]
        if (model := self.model) is not None:
            names += [
                model.deck,
                model.stiffness,
                model.mass_matrix,
                model.nodes,
                *model.stiffness_parts,
                *model.mass_parts,
            ]
        names += [name for supposed in self.hypothesis for name in supposed.files]
        return (self.path, *(self.file(name) for name in names if name is not None))

    @property
    def name(self) -> str:
        """Title, or the folder's name."""
        return self.title or self.path.resolve().parent.name

    def spec(self) -> Spec:
        """Return the nominal model.

        Raises
        ------
        StudyError
            If there is no model, or one that cannot be.
        """
        try:
            return self._spec()
        except StudyError as error:
            raise StudyError(f"{self.path}: {error}") from error

    def _spec(self) -> Spec:
        from updating.models import Material, PointMass, Region, Spec
        from updating.models.places import check_places

        model = self.model
        if model is None:
            raise StudyError("this command needs a [model]")
        if model.type == "matrices":
            return self._of_matrices
        if model.type == "calculix":
            return self._of_deck
        if self.hypothesis:
            raise StudyError(
                f"[[hypothesis]] {self.hypothesis[0].name!r} is for models given by matrices or a deck, found type "
                f"{model.type}; for a beam or a plate use the effects of the library"
            )
        if given := [key for key in MATRICES_ONLY if getattr(model, key)]:
            raise StudyError(
                f"[model] of type {model.type} takes no {', '.join(given)}; they are of type matrices"
            )
        if model.deck or any(region.set for region in model.region):
            raise StudyError(
                f"[model] of type {model.type} takes no deck and no region.set; they are of type calculix"
            )
        if unplaced := [region.name for region in model.region if region.x is None]:
            raise StudyError(f"[[model.region]] {unplaced[0]!r} needs x")
        for key in ("length", "width", "thickness", "material"):
            if getattr(model, key) is None:
                raise StudyError(f"[model] of type {model.type} needs {key}")
        check_units(model)
        assert model.material is not None
        assert model.length is not None
        assert model.width is not None
        assert model.thickness is not None
        spec = Spec(
            model.type,
            length=model.length,
            width=model.width,
            thickness=model.thickness,
            elements=self._elements(model),
            clamped=tuple(model.clamped),
            theory=model.theory or ("euler-bernoulli" if model.type == "beam" else "kirchhoff"),  # type: ignore[arg-type]
            material=Material(model.material.E, model.material.density, model.material.poisson),
            regions=tuple(Region(**region.model_dump(exclude={"set"})) for region in model.region),
            masses=tuple(PointMass(tuple(mass.at), mass.mass, mass.inertia) for mass in model.mass),
            damping=_damping(model),
        )
        check_places(spec)
        return spec

    @cached_property
    def _of_matrices(self) -> Spec:
        """The model given by matrices, read once."""
        from modalkit.study.hypotheses import with_hypotheses
        from modalkit.study.matrices import matrices_of, matrices_spec

        assert self.model is not None
        spec = matrices_spec(self.model, matrices_of(self.model, self.file), _damping(self.model))
        names = self.model.stiffness_name, self.model.mass_name
        return with_hypotheses(spec, self.hypothesis, self.file, self.model.units, names)

    @cached_property
    def _of_deck(self) -> Spec:
        """The model that a deck is, run once."""
        from modalkit.study.decks import deck_of, deck_spec, known_values
        from modalkit.study.hypotheses import check_ranges, with_hypotheses

        assert self.model is not None
        deck = deck_of(self.model, self.file)
        check_ranges(self.hypothesis, known_values(deck))
        spec = deck_spec(self.model, deck, _damping(self.model))
        return with_hypotheses(spec, self.hypothesis, self.file, self.model.units)

    def _elements(self, model: ModelTable) -> tuple[int, ...]:
        if model.elements is None:
            return (40,) if model.type == "beam" else (38, 20)
        return (model.elements,) if isinstance(model.elements, int) else tuple(model.elements)

    def axes(self, table: MeasurementTable) -> Axes:
        """Return the model's axes in the coordinates of a test."""
        from updating.test_data.axes import Axes

        try:
            return Axes(table.axes.origin, table.axes.x, table.axes.y)
        except StudyError as error:
            raise StudyError(f"{self.path}: {error}") from error

    def doubts(self) -> Tolerances:
        """Return the tolerances."""
        from updating.tolerances import FREE, Tolerances

        stated = self.tolerances.model_dump()
        parts, bounds = stated.pop("parts"), stated.pop("bounds")
        free = frozenset(name for name, value in stated.items() if value == "free")
        stated |= dict.fromkeys(free, FREE)
        values = {name: value if value > NOTHING else 0.0 for name, value in stated.items()}
        parts = {name: value for name, value in parts.items() if value > NOTHING}
        damping = values.pop("damping")
        return Tolerances(values, damping, parts, bounds, free)

    def accepted(self) -> tuple[tuple[str, dict[str, Any]], ...]:
        """Return the effects put into the model, with the values of their parameters and the points they name.

        Raises
        ------
        StudyError
            If one is unknown, or a value is neither a number nor, where points are meant, node numbers; or if one
            is given twice that can be there but once.
        """
        if self.model is None:
            return ()
        from modalkit.study.stated_effects import accepted_values, check_repeated

        try:
            found = tuple(accepted_values(entry, kind_of(self.model)) for entry in self.model.effect)
            check_repeated([name for name, _ in found])
            return found
        except StudyError as error:
            raise StudyError(f"{self.path}: {error}") from error

    def since_baseline(self) -> tuple[int, ...]:
        """Return which of the effects put into the model, by rank, came after the baseline.

        Raises
        ------
        StudyError
            If ``before`` of one is neither true nor false.
        """
        entries = [] if self.model is None else self.model.effect
        if not entries:
            return ()
        from modalkit.study.stated_effects import was_before

        try:
            return tuple(i for i, entry in enumerate(entries) if not was_before(entry))
        except StudyError as error:
            raise StudyError(f"{self.path}: {error}") from error

    def baseline_stated(self) -> tuple[int, ...]:
        """Return of which effects put into the model, by rank, the study states whether the baseline had them."""
        entries = [] if self.model is None else self.model.effect
        return tuple(i for i, entry in enumerate(entries) if entry.get("before") is not None)

    def surroundings(self) -> Environment:
        """Return the environment."""
        from updating.environment import Environment

        return Environment(**self.environment.model_dump())


def kind_of(model: ModelTable) -> Kind:
    """Return the kind of model that a table describes: a deck becomes matrices."""
    return "matrices" if model.type == "calculix" else model.type


def _damping(model: ModelTable) -> Damping:
    """Return the damping that a model states."""
    from updating.models import Damping

    stated = model.damping
    ratios = None if stated.ratios is None else tuple(stated.ratios)
    return Damping(stated.alpha, stated.beta, stated.loss_factor, ratios)


def read_study(path: Path | str) -> Study:
    """Read a study file.

    Parameters
    ----------
    path : path
        The TOML file.

    Returns
    -------
    Study

    Raises
    ------
    StudyError
        If the file cannot be read, is no TOML, or has a key or value that does not belong there.
    """
    return study_of(read_toml(Path(path), "study file"), Path(path))


def study_of(content: dict[str, Any], path: Path) -> Study:
    """Return the study that the tables of a file are.

    Parameters
    ----------
    content : dict
        As TOML gives it; it stays as it is.
    path : path
        The file it is of, for messages, and because its files are relative to it.

    Raises
    ------
    StudyError
        If it has a key or value that does not belong there.
    """
    content = dict(content)
    if "path" in content:
        raise StudyError(f"{path}: unknown key path; known here: {', '.join(known_keys((), Study))}")
    model = content.get("model", {})
    if isinstance(model, dict) and isinstance(model.get("mass"), str):
        content["model"] = {"mass_matrix" if key == "mass" else key: value for key, value in model.items()}
    try:
        return Study(**content, path=path)
    except ValidationError as error:
        raise StudyError(f"{path}: {explain(error, Study)}") from error
