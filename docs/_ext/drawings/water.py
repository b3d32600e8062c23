"""Errors of the wet plate's modes: one factor on the mass, and the water computed."""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from style import show

PRINTED = np.array([27.65, -4.34, 18.99, -6.31, 10.69, -14.51, -9.99])
"""Paper A, Table 4, errors after updating one factor [%]."""

lines = Path("fluid.md").read_text(encoding="utf-8").splitlines()
row = next(n for n in lines if n.startswith("| measured dry; tank, thick, coupled") and n.count("|") > 10)
computed = np.array([float(cell) for cell in row.split("|")[2:-1]])
figure, axes = plt.subplots(figsize=(7, 2.6), layout="constrained")
modes = np.arange(1, len(computed) + 1)
axes.bar(
    modes[:7] - 0.2,
    PRINTED,
    0.38,
    color="#e69f00",
    label="one factor on the mass, fitted to modes 1 to 7 (printed)",
)
axes.bar(modes + 0.2, computed, 0.38, color="#0072b2", label="water computed, nothing fitted")
axes.axhline(0, color="k", linewidth=0.8)
axes.set(xlabel="mode", ylabel="error [%]", xticks=modes)
axes.legend(fontsize=8)
show(figure, "water")
