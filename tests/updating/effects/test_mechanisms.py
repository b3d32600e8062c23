"""What effects do, in currencies that they share: units, extents, and equal sizes where equal shifts are exact."""

from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from effect_cases import LOOK, admitted, form
from updating_cases import BEAM, ExactBeam

from updating import LIBRARY
from updating.effects.base import bending_stiffness
from updating.effects.mechanism import Channel, Extent


@admitted(formed=True)
def test_every_effect_has_an_extent_and_finite_sizes(name: str, place: str) -> None:
    effect, predictor = LIBRARY[name], LOOK[place]
    values = effect.settled(predictor, form(effect, predictor))
    assert effect.acts_in(predictor, values) in get_args(Channel)
    extent = effect.extent(predictor, values)
    assert extent in get_args(Extent)
    assert (extent == "chain") == (effect.channel == "measurement")
    if extent in ("local", "edge"):
        assert effect.locations(predictor, values)
    sizes = effect.sizes(predictor, values)
    assert len({size.quantity for size in sizes}) == len(sizes)
    assert all(np.isfinite(size.value) and size.unit for size in sizes)


def test_what_sits_at_a_place_adds_its_mass_whatever_it_is() -> None:
    beam = LOOK["beam"]
    body = LIBRARY["lumped_mass"].sizes(beam, {"mass": 0.02, "x": 0.1})
    sensor = LIBRARY["sensor_mass"].sizes(beam, {"mass": 0.02})
    values = {"x": 0.1, "extent": 0.05, "factor": 1.5}
    (coating,) = LIBRARY["local_mass"].sizes(beam, values)
    own = BEAM.material.density * BEAM.width * BEAM.thickness * 0.05
    assert body == sensor
    assert (body[0].quantity, body[0].unit) == (coating.quantity, coating.unit) == ("added mass", "kg")
    assert coating.value == pytest.approx(0.5 * own, rel=1e-6)


def test_a_clamp_a_length_and_a_soft_place_of_one_compliance_shift_frequencies_alike() -> None:
    """By an exact beam: to first order each shifts every mode by the same, small over the wavelength."""
    compliance, predictor = 5e-5, LOOK["beam"]
    slender = {"shear": False, "rotary": False}
    plain = ExactBeam(BEAM.length, BEAM.width, BEAM.thickness, **slender)  # type: ignore[arg-type]
    stiffness = bending_stiffness(BEAM) / compliance
    loss, extent = 0.2, 4 * compliance
    beams = {
        "clamp_rotation": (replace(plain, rotation=stiffness), {"stiffness": stiffness}),
        "length": (replace(plain, length=BEAM.length + compliance), {"extension": compliance}),
        "local_stiffness": (
            replace(plain, soft=(0.0, extent, loss)),
            {"x": extent / 2, "extent": extent, "loss": loss},
        ),
    }
    before = plain.frequencies(3)
    shifts = {name: np.log(beam.frequencies(3) / before) for name, (beam, _) in beams.items()}
    for name, (_, values) in beams.items():
        np.testing.assert_allclose(shifts[name], -2 * compliance / BEAM.length, rtol=0.02)
        sizes = {s.quantity: s for s in LIBRARY[name].sizes(predictor, values)}
        assert sizes["compliance"].unit == "m"
        if name != "local_stiffness":  # whose edges the mesh of the model makes soft
            assert sizes["compliance"].value == pytest.approx(compliance, rel=1e-9)


def test_modulus_and_thickness_share_what_all_frequencies_show() -> None:
    predictor, squared = LOOK["beam"], 1.1
    modulus = LIBRARY["E"].sizes(predictor, {"factor": squared})
    thickness = LIBRARY["thickness"].sizes(predictor, {"factor": np.sqrt(squared)})
    shared = {s.quantity for s in modulus} & {s.quantity for s in thickness}
    assert len(shared) == 1
    for sizes in (modulus, thickness):
        assert next(s.value for s in sizes if s.quantity in shared) == pytest.approx(squared - 1)


def test_a_spring_as_long_as_the_structure_has_no_place() -> None:
    spring, beam = LIBRARY["ground_spring"], LOOK["beam"]
    values = {"x": 0.19, "extent": 0.05, "stiffness": 1e3, "damping": 0.0}
    assert spring.extent(beam, values) == "local"
    assert spring.extent(beam, {**values, "extent": 0.9 * BEAM.length}) == "global"


def test_dashpots_alone_damp() -> None:
    spring, beam = LIBRARY["ground_spring"], LOOK["beam"]
    values = {"x": 0.19, "extent": 0.0, "stiffness": 0.0, "damping": 3.0}
    assert spring.acts_in(beam, values) == "damping"
    assert [(s.value, s.unit) for s in spring.sizes(beam, values)] == [(3.0, "N s/m")]
    assert spring.acts_in(beam, {**values, "stiffness": 10.0}) == "stiffness"


def test_supports_are_edges_and_a_free_length_is_everywhere() -> None:
    stiff, longer = {"stiffness": 1e3}, {"extension": 1e-3}
    assert LIBRARY["clamp_rotation"].extent(LOOK["beam"], stiff) == "edge"
    assert LIBRARY["length"].extent(LOOK["beam"], longer) == "edge"
    assert LIBRARY["length"].extent(LOOK["free"], longer) == "global"
