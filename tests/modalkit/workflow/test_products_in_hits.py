"""Products of modes, from hits on a structure with a joint that slips: left out, and named with their sum."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from joint_cases import cantilever, joint_test

from acquisition import UffContent
from identification import follows_level
from modalkit.workflow.identification import from_content
from modalkit.workflow.processing_options import ProcessingOptions


@pytest.mark.long
@pytest.mark.parametrize("seed", [0, 1])
def test_products_are_left_out_and_named_with_their_sum(seed: int) -> None:
    joint = cantilever(-2e10)
    content = UffContent(tests=(joint_test(joint, seed),))
    model = from_content(content, [Path("joint.uff")], ProcessingOptions()).identify(band=(15.0, 750.0))
    found = model.modal.frequency
    nearest = np.abs(found[:, None] - joint.frequency).argmin(axis=0)
    assert found[nearest] == pytest.approx(joint.frequency, rel=0.008)
    # a faint product may stay whose growth, 2.7 standard deviations, rounding decides; 14 peaks are above the noise
    assert len(found) - len(joint.frequency) <= 1
    assert not np.delete(follows_level(model.levels), nearest).any()
    (statement,) = [w for w in model.warnings if "products of modes" in w]
    assert " - 2 x 34.3" in statement
    assert any("frequencies follow the force" in w for w in model.warnings)
