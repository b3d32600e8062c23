"""Products of modes, from hits on a structure with a joint that slips: left out, and named with their sum."""

from __future__ import annotations

from pathlib import Path

import pytest
from joint_cases import cantilever, joint_test

from acquisition import UffContent
from modalkit.workflow.identification import from_content
from modalkit.workflow.processing_options import ProcessingOptions


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 1])
def test_products_are_left_out_and_named_with_their_sum(seed: int) -> None:
    joint = cantilever(-2e10)
    content = UffContent(tests=(joint_test(joint, seed),))
    model = from_content(content, [Path("joint.uff")], ProcessingOptions()).identify(band=(15.0, 750.0))
    assert model.modal.frequency == pytest.approx(joint.frequency, rel=0.008)
    (statement,) = [w for w in model.warnings if "products of modes" in w]
    assert " - 2 x 34.3" in statement
    assert any("frequencies follow the force" in w for w in model.warnings)
