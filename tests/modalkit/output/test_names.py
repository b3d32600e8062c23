"""Words in place of identifiers, and which of two alike effects is meant."""

from __future__ import annotations

from modalkit.output.names import in_words, is_numbered, owners, sizes, zone_in_words
from modalkit.output.words import short
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked


def _mass(value: float, unit: str = "kg") -> ParameterEstimate:
    return ParameterEstimate(value, unit, 0.9 * value, 1.1 * value, False)


def _row(effects: tuple[str, ...], **parameters: ParameterEstimate) -> Ranked:
    return Ranked(
        effects=effects,
        probability=0.9,
        equivalents=(),
        parameters={name.replace("__", ".").replace("_2.", "#2."): v for name, v in parameters.items()},
        plausible=True,
        p_value=0.4,
    )


TWO = _row(
    ("lumped_mass", "lumped_mass"),
    lumped_mass__mass=_mass(0.02),
    lumped_mass__x=_mass(0.1, "m"),
    lumped_mass_2__mass=_mass(0.005),
    lumped_mass_2__x=_mass(0.3, "m"),
)


def test_identifiers_become_words_and_everything_else_stays() -> None:
    assert in_words("length + sensor_mass. The sensor") == "length + sensor mass. The sensor"
    assert in_words("lumped_mass#2 and lumped_mass") == "second lumped mass and lumped mass"
    assert in_words("[model.effect] sensor_mass.mass = 9 g") == "[model.effect] sensor_mass.mass = 9 g"
    assert in_words('add name = "clamp_rotation"') == 'add name = "clamp_rotation"'
    assert in_words("my_sensor_mass") == "my_sensor_mass"
    assert short(("lumped_mass", "E", "lumped_mass")) == "lumped mass + E + another lumped mass"


def test_of_two_masses_each_is_named_by_its_place() -> None:
    assert [name for name, _ in owners(TWO)] == ["lumped_mass at x = 100 mm", "lumped_mass at x = 300 mm"]
    assert sizes(TWO)[1] == "lumped mass at x = 300 mm: mass 5 g (4.5 to 5.5), x 300 mm (270 to 330)"
    bare = _row(TWO.effects, lumped_mass__mass=_mass(0.02), lumped_mass_2__mass=_mass(0.005))
    assert [name for name, _ in owners(bare)] == ["first lumped_mass", "second lumped_mass"]


def test_one_effect_alone_needs_no_name_beside_its_size() -> None:
    assert sizes(_row(("sensor_mass",), sensor_mass__mass=_mass(0.01))) == ["mass 10 g (9 to 11)"]


def test_regions_with_a_number_are_called_by_it() -> None:
    assert [zone_in_words(name) for name in ("zone4", "zone2b", "bolt 3")] == ["zone 4", "zone 2b", "bolt 3"]
    assert is_numbered("zone10") and not is_numbered("root")
