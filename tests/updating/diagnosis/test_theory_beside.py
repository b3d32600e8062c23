"""A theory that leaves something out is a cause like others, beside others, too."""

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, case_of, specimen, struck

from updating import LIBRARY
from updating.diagnosis.diagnose import diagnose

pytestmark = pytest.mark.long

THICK = replace(BEAM.with_elements(20), thickness=0.012, theory="euler-bernoulli", regions=())
SEARCHED = [
    LIBRARY[name] for name in ("E", "thickness", "sensor_mass", "polarity", "clamp_rotation", "shear")
]


@pytest.mark.parametrize(
    ("tip", "reversed_point", "causes"),
    [
        (0.0, None, ("shear",)),
        (0.06, None, ("sensor_mass", "shear")),
        (0.0, 2, ("polarity", "shear")),
        (0.06, 2, ("polarity", "sensor_mass", "shear")),
    ],
)
def test_shear_is_named_beside_what_else_is_missing(
    tip: float, reversed_point: int | None, causes: tuple[str, ...]
) -> None:
    """A thick beam, exactly solved, beside a model without shear and rotary inertia."""
    rng = np.random.default_rng(11)
    beam = specimen(rng)
    body = {"masses": ((beam.length, tip),)} if tip else {}
    test = struck(replace(beam, thickness=THICK.thickness, **body), rng)
    if reversed_point is not None:
        signs = np.where(test.hit == reversed_point, -1.0, 1.0)[:, None]
        test = replace(test, constants=signs * test.constants)
    found = diagnose(case_of(test, THICK), library=SEARCHED)
    assert (found.verdict, [tuple(sorted(one)) for one in found.sets]) == ("named", [causes])
    assert not any("rough" in warning for warning in found.warnings if "polarity" in warning)
