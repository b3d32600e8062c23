"""The three forms of an FRF: displacement, velocity or acceleration per force."""

from __future__ import annotations

from typing import Literal

Form = Literal["receptance", "mobility", "accelerance"]

FORMS: tuple[Form, ...] = ("receptance", "mobility", "accelerance")
"""In the order of differentiation: each is the one before it times i omega."""

UNITS: dict[Form, str] = {"receptance": "m/N", "mobility": "m/(N s)", "accelerance": "1/kg"}
