"""What an update that proves nothing says of itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from test_pairs_of_causes import AT, FREE, two_sensors
from updating_cases import case_of

from updating import Measured
from updating.models import Spec
from updating.update import Update, update

LIGHT: Spec = replace(FREE, theory="euler-bernoulli")


def of_body(modes: list[int], *, upside_down: int | None = None) -> Update:
    test: Measured = two_sensors(upside_down=upside_down).modes(np.array(modes))
    return update(case_of(test, LIGHT), parameters=["lumped_mass"], weights="relative")


def test_without_a_degree_of_freedom_nothing_is_tested() -> None:
    result = of_body([0, 1])
    assert result.dof <= 0
    assert any(w.startswith("the fit is not tested: 2 data and 2 parameters") for w in result.warnings)
    assert "NOTHING IS TESTED" in result.report() and "nan" not in result.report()


def test_the_mirror_image_of_a_place_is_warned_of() -> None:
    """Two frequencies put the body at a wrong place, and its mirror image would do as well."""
    result = of_body([0, 1])
    place = next(p.value for p in result.parameters if p.name == "lumped_mass.x")
    assert abs(place - AT) > 0.02
    assert any(f"mirror image at x = {FREE.length - place:.4g} m" in w for w in result.warnings)


def test_a_pair_of_poor_mac_is_warned_of() -> None:
    test = two_sensors(upside_down=None)
    constants = test.constants.copy()
    constants[test.hit == 2, 1] *= -1
    test = replace(test, constants=constants)
    result = update(case_of(test, LIGHT), parameters=["E"], weights="relative")
    poor = next(w for w in result.warnings if "shape is not that of test mode" in w)
    assert "2 (MAC 0." in poor
    for mode, mac in zip(result.pairs["test_mode"], result.pairs["mac"], strict=True):
        assert (f"{mode} (MAC {mac:.2f})" in poor) == (mac < 0.9)


def test_a_good_update_is_not_doubted() -> None:
    result = update(case_of(two_sensors(upside_down=None), LIGHT), parameters=["E"], weights="relative")
    assert not any("the fit is not tested" in w or "mirror" in w for w in result.warnings)


def test_a_sensor_upside_down_alone_makes_no_pair_poor() -> None:
    message = [
        [
            w
            for w in of_body([0, 1, 2, 3], upside_down=which).warnings
            if "shape is not that of test mode" in w
        ]
        for which in (None, 4)
    ]
    assert len(message[0]) == len(message[1])
