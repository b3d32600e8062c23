"""The cause as a mechanism: one statement for sets that do the same, and content for what has no name."""

from dataclasses import replace

import pytest
from test_summary import NAMED, TIP, lines, numbers, ranked

from modalkit.output.words import answer
from updating.diagnosis.answer.in_no_library import SomethingElse
from updating.diagnosis.answer.mechanism import Alike, Mechanism, MechanismSize
from updating.diagnosis.answer.ranked import ParameterEstimate

AT = (0.13, 0.0, 0.0)
LONG = ParameterEstimate(value=0.046, unit="m", low95=0.03, high95=0.06, at_bound=False)
BODY = ranked("lumped_mass", probability=0.93)
COATING = ranked("local_mass", probability=0.07, local_mass__extent=LONG)
MASS = Mechanism(
    channel="mass",
    extent="local",
    location=AT,
    locations=(AT,),
    location_low95=(0.12, 0.0, 0.0),
    location_high95=(0.14, 0.0, 0.0),
    size=MechanismSize("added mass", "kg", 0.0507, 0.0494, 0.052),
    probability=0.998,
    sets=(Alike(("lumped_mass",), 0.93), Alike(("local_mass",), 0.07)),
)
ALIKE = replace(
    NAMED,
    verdict="class",
    sets=(("lumped_mass",), ("local_mass",)),
    ranking=(BODY, COATING),
    level="mechanism",
    mechanisms=(MASS,),
)
OTHER = SomethingElse(0.98, 3.0, (), {"mass": 0.99, "stiffness": 0.01, "damping": 0.3}, ())
NAMELESS = replace(
    NAMED,
    verdict="unknown",
    lacks="library",
    sets=(),
    where=replace(TIP, points=()),
    level="mechanism",
    mechanisms=(replace(MASS, sets=(Alike(("something_else",), 0.98),), probability=0.97),),
    something_else=OTHER,
)


def test_sets_that_share_a_mechanism_stand_under_it() -> None:
    stated = lines(ALIKE)["Cause"]
    assert stated.startswith("mass near x = 130 mm, 50.7 g (49.4 to 52)")
    assert stated.index("lumped_mass") < stated.index("local_mass")
    assert numbers(stated) == ["130 mm", "50.7 g", "49.4", "52", "93 %", "46 mm", "7 %"]


def test_the_sentence_of_figures_and_the_app_has_the_mechanism() -> None:
    assert answer(ALIKE).startswith("Mass near x = 130 mm, 50.7 g (49.4 to 52): ")
    assert "cannot show which" in answer(ALIKE)
    assert "mass near x = 130 mm" in answer(NAMELESS)
    assert "mass near" not in answer(replace(ALIKE, level=None))


def test_a_class_without_a_shared_mechanism_stays_a_list() -> None:
    assert "mass near" not in lines(ALIKE, level=None)["Cause"]


def test_a_cause_without_a_name_has_channel_place_and_size_and_what_it_is_not() -> None:
    found = lines(NAMELESS)
    for fact in ("mass near x = 130 mm (120 to 140)", "50.7 g (49.4 to 52)", "97 %", "stiffness"):
        assert fact in found["Cause"]
    assert "damping" not in found["Cause"]  # neither sure nor excluded
    assert "mass near x = 130 mm" in found["Where"]


@pytest.mark.parametrize(
    ("extent", "places", "stated"),
    [
        ("global", (), "mass of the whole structure"),
        ("edge", (AT,), "mass at x = 130 mm"),
        ("chain", (), "mass of all points alike"),
        ("local", (AT, (0.67, 0.0, 0.0)), "mass near x = 130 mm and x = 670 mm"),
    ],
)
def test_extent_and_places_are_written(
    extent: str, places: tuple[tuple[float, float, float], ...], stated: str
) -> None:
    assert str(replace(MASS, extent=extent, locations=places)).startswith(stated)  # type: ignore[arg-type]
