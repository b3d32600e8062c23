"""What is written into a cell has a contrast of 4.5 at every value, in figures and in both schemes of a page."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from modalkit.figures.style import PROBABILITY, SIGNED, ink_on

STATIC = Path(__file__).resolve().parents[3] / "modalkit"
SHARES = np.linspace(0.0, 1.0, 101)
LEAST = 4.5  # WCAG 2.2, success criterion 1.4.3


def luminance(colour: object) -> float:
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)]  # type: ignore[arg-type]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


def contrast(one: object, other: object) -> float:
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("colours", [PROBABILITY, SIGNED])
def test_in_a_figure(colours: object) -> None:
    assert min(contrast(ink_on(colours(v)), colours(v)) for v in SHARES) > LEAST  # type: ignore[operator]


@pytest.mark.parametrize("page", ["app", "report"])
def test_in_both_schemes_of_a_page(page: str) -> None:
    """The share of colour over a cell, and from which share on the text is black, are those of the script."""
    script = (STATIC / "views/static/marks.js").read_text(encoding="utf-8")
    bright = float(re.search(r"const BRIGHT = ([\d.]+)", script)[1])  # type: ignore[index]
    full = float(re.search(r"\(([\d.]+) \* size\)", script)[1])  # type: ignore[index]
    style = (STATIC / page / "static/style.css").read_text(encoding="utf-8")
    schemes = [
        dict(re.findall(r"--(cell|in-cell|blue|orange): (#[0-9a-f]{6})", block))
        for block in re.findall(r":root[^{]*\{([^}]*)\}", style)
    ]
    schemes = [one for one in schemes if "in-cell" in one]
    assert len(schemes) >= 2
    for one in schemes:
        for colour in (one["blue"], one["orange"]):
            for share in SHARES:
                laid = full * share * np.array(to_rgb(colour)) + (1 - full * share) * np.array(
                    to_rgb(one["cell"])
                )
                text = "#000000" if share > bright else one["in-cell"]
                assert contrast(text, laid) > LEAST, (one, colour, share)
