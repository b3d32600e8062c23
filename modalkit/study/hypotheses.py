"""``[[hypothesis]]``: the user's own effects, for models given by matrices."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from acquisition.errors import StudyError
from acquisition.si_units import si_value
from modalkit.study.hypothesis_table import HypothesisTable
from modalkit.study.matrices import FACTORS_ALONE
from modalkit.study.strict import rising
from updating.models import Spec
from updating.models.fields import Sparse
from updating.models.imported import Imported, Names, read_matrix
from updating.models.imported.decks import KNOWN, DeckModel, deck_matrices
from updating.models.imported.hypothesis import Hypothesis, change_of, check_ends, same_as
from updating.models.imported.read import KINDS
from updating.models.imported.units import SI, matrix_in_si

UNITS = {"E": "Pa", "density": "kg/m^3"}

FAR = 1e3
"""A range of a modulus or density that lies wholly beyond so many times the model's value, or below one over it, is
one of factors or in the deck's own units [-]. Doubled: units whose ratio is small pass for SI."""


def check_names(tables: Sequence[HypothesisTable]) -> None:
    """See that no two hypotheses bear one name.

    Raises
    ------
    StudyError
        If two do.
    """
    names = [table.name for table in tables]
    if twice := [name for i, name in enumerate(names) if name in names[:i]]:
        raise StudyError(f"[[hypothesis]] {twice[0]!r} is given twice; give each its own name")


def with_hypotheses(
    spec: Spec,
    tables: Sequence[HypothesisTable],
    file: Callable[[str], Path],
    units: str | None,
    names: Names = (None, None),
) -> Spec:
    """Return a model with the hypotheses of its study.

    Parameters
    ----------
    spec : Spec
        Given by matrices.
    tables : sequence of HypothesisTable
        As the study has them.
    file : callable
        Takes a name of the study file to its path.
    units : str, optional
        What the matrices are in; left out, SI.
    names : (str or None, str or None)
        Names of stiffness and mass in files that have several matrices.

    Raises
    ------
    StudyError
        If one cannot be, or changes nothing.
    """
    check_names(tables)
    imported = spec.imported
    assert imported is not None
    found = tuple(
        _of_parameter(spec, table)
        if table.parameter
        else _of_matrices(imported, table, file, (units or SI, names))
        for table in tables
    )
    return replace(spec, hypotheses=(*spec.hypotheses, *found)) if found else spec


def _of_matrices(
    imported: Imported, table: HypothesisTable, file: Callable[[str], Path], how: tuple[str, Names]
) -> Hypothesis:
    stiffness, mass = (
        None if matrix is None else change_of(own, matrix, f"[[hypothesis]] {table.name!r}: {what}")
        for own, (matrix, what) in zip(
            (imported.stiffness, imported.bare_mass), _supposed(imported, table, file, how), strict=True
        )
    )
    low, high = _range(table, "")
    found = Hypothesis(table.name, table.why, low, high, stiffness, mass)
    check_ends(found, imported.stiffness, imported.mass)
    return found


def _supposed(
    imported: Imported, table: HypothesisTable, file: Callable[[str], Path], how: tuple[str, Names]
) -> list[tuple[Sparse | None, str]]:
    """Return stiffness and mass if it were so, None for one that is as modelled, and where they are from."""
    if table.deck is None:
        units, names = how
        return [
            (
                None
                if of is None
                else matrix_in_si(read_matrix(file(of), kind, name), imported.nodes, units),
                f"{kind} = {of!r}",
            )
            for kind, of, name in zip(KINDS, (table.stiffness, table.mass), names, strict=True)
        ]
    if imported.deck is None:
        raise StudyError(
            f'[[hypothesis]] {table.name!r}: a deck is for [model] type = "calculix"; export its matrices, and give '
            "stiffness and mass"
        )
    what = f"deck = {table.deck!r}"
    supposed = deck_matrices(file(table.deck), like=imported.deck)
    changed = [
        same_as(own, matrix)
        for own, matrix in zip((imported.stiffness, imported.bare_mass), supposed, strict=True)
    ]
    if all(changed):
        raise StudyError(
            f"[[hypothesis]] {table.name!r}: {what} is identical to the model's own, so it changes nothing"
        )
    return [(None if same else matrix, what) for matrix, same in zip(supposed, changed, strict=True)]


def _range(table: HypothesisTable, unit: str, hint: str = "") -> tuple[float, float]:
    try:
        low, high = (float(si_value(end, unit)) for end in (table.range or [0.0, 1.0]))
        rising("range", (low, high))
    except ValueError as error:
        raise StudyError(f"[[hypothesis]] {table.name!r}: {error}{hint}") from error
    if not table.parameter and low <= 0.0 <= high and max(-low, high) <= 0:
        raise StudyError(f"[[hypothesis]] {table.name!r}: its range contains only the unchanged model")
    return low, high


def _of_parameter(spec: Spec, table: HypothesisTable) -> Hypothesis:
    """Return a hypothesis on a modulus or a density, of the whole or of a region."""
    assert spec.imported is not None
    deck = spec.imported.deck
    region, _, factor = str(table.parameter).rpartition(".")
    if deck is not None and factor not in UNITS and (number := _number(deck, table)) is not None:
        return number
    names = [one.name for one in spec.regions]
    if factor not in UNITS or (region and region not in names):
        known = ", ".join([*UNITS, *(f"{name}.{factor}" for name in names for factor in UNITS)])
        known += f"; of the deck {KNOWN}" if deck is not None else ""
        raise StudyError(f"[[hypothesis]] {table.name!r}: no parameter {table.parameter!r}; known: {known}")
    if why := spec.imported.obstacle(factor, regional=bool(region)):
        raise StudyError(f"[[hypothesis]] {table.name!r}: {table.parameter}: {why}")
    own = getattr(spec.regions[names.index(region)], factor) if region else None
    nominal = float(getattr(spec.material, factor) if own is None else own)
    unit, low, high = _factor_range(table, nominal, of_deck=deck is not None)
    index = names.index(region) if region else -1
    return Hypothesis(
        table.name, table.why, low, high, factor=factor, region=index, nominal=nominal, unit=unit
    )


def check_ranges(tables: Sequence[HypothesisTable], known: Mapping[str, float]) -> None:
    """See that ranges of moduli and densities of a deck can be, before CalculiX runs.

    Parameters
    ----------
    tables : sequence of HypothesisTable
        As the study has them.
    known : mapping of str to float
        Value of each modulus and density by the parameter's name, 1 where no card states it [Pa], [kg/m3].

    Raises
    ------
    StudyError
        If one is in another unit, or far from the value.
    """
    for table in tables:
        if table.parameter is not None and table.parameter in known:
            _factor_range(table, known[table.parameter], of_deck=True)


def _factor_range(table: HypothesisTable, nominal: float, *, of_deck: bool) -> tuple[str, float, float]:
    """Return unit and range of a modulus or density: in SI where the model has its value, as update has it."""
    name = str(table.parameter)
    what = f"[[hypothesis]] {table.name!r}"
    if nominal == FACTORS_ALONE.E:
        lacks = (
            "no single card of the deck states it for all elements"
            if of_deck
            else "the study has no [model.material]"
        )
        unit, (low, high) = "-", _range(table, "", f"; {name} is a factor where {lacks}")
    else:
        unit = UNITS[name.rpartition(".")[2]]
        low, high = _range(table, unit)
        if high < nominal / FAR or low > nominal * FAR:
            raise StudyError(
                f"{what}: range = [{low:g}, {high:g}] {unit} is far from the model's value, {name} = {nominal:.4g} "
                f"{unit}; give values of {name} in {unit} or with a unit, not factors"
            )
    if not low > 0:
        raise StudyError(f"{what}: {name} must be positive over its whole range")
    return unit, low, high


def _number(deck: DeckModel, table: HypothesisTable) -> Hypothesis | None:
    """Return a hypothesis on a number of a deck; None where its parameter is none.

    Raises
    ------
    StudyError
        If the range leaves what the deck can follow, or holds nothing but the number as it is.
    """
    what = f"[[hypothesis]] {table.name!r}"
    try:
        found = deck.parameter(str(table.parameter))
    except StudyError as error:
        raise StudyError(f"{what}: {error}") from error
    if found is None:
        return None
    low, high = _range(table, found.unit)
    ends = found.nominal * found.low, found.nominal * found.high
    if low < ends[0] or high > ends[1]:
        raise StudyError(
            f"{what}: range = [{low:g}, {high:g}] {found.unit} exceeds [{ends[0]:.4g}, {ends[1]:.4g}] {found.unit}, "
            f"the range in which the deck is run; its own {found.name} is {found.nominal * found.start:.4g}"
        )
    changes = tuple(
        deck.change({found: end / found.nominal}) for end in (low, high) if end / found.nominal != found.start
    )
    return Hypothesis(
        table.name,
        table.why,
        low,
        high,
        nominal=found.nominal,
        unit=found.unit,
        of_deck=found,
        changes=changes,
    )
