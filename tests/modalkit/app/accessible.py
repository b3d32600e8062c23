"""What axe-core finds wrong with a page for those who see, hear or point badly."""

from __future__ import annotations

from typing import Any

import pytest

axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="no axe-core here")


def grave_findings(page: Any) -> list[str]:
    """Return what is serious or critical: the rule, how often, and the first place."""
    found = axe.Axe().run(page).response["violations"]
    return [
        f"{one['id']} ({one['impact']}) {len(one['nodes'])} times, at {one['nodes'][0]['target']}: "
        f"{one['nodes'][0]['failureSummary']}"
        for one in found
        if one["impact"] in ("serious", "critical")
    ]
