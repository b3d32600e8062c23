"""Errors of the poles of LSCE, LSCF and maximum likelihood, on modes that are known."""

import matplotlib.pyplot as plt
import numpy as np
from style import COLOURS, show

from acquisition import Dof, FrfSet
from identification import identify, lsce, lscf

HERTZ = np.array([62.0, 118, 187, 243, 310, 402, 405.5, 478, 566, 655, 763, 884])
DAMPING = np.array([2.0, 1.2, 0.9, 0.7, 0.6, 0.5, 0.4, 0.35, 0.3, 0.28, 0.24, 0.2]) / 100

rng = np.random.default_rng(3)
frequency = np.arange(300.0, 1000.5, 0.5)
poles = 2 * np.pi * HERTZ * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2))
shapes = rng.standard_normal((25, len(HERTZ)))
s = 2j * np.pi * frequency
values = (
    (shapes * shapes[0])
    @ ((1 / (s[:, None] - poles) - 1 / (s[:, None] - poles.conj())) / (2j * poles.imag)).T
    * s**2
)
noise = rng.standard_normal((2, *values.shape)) * 0.01 * np.sqrt(np.mean(np.abs(values) ** 2) / 2)
points = tuple(Dof(i + 1, 3) for i in range(25))
frfs = FrfSet(frequency, values + noise[0] + 1j * noise[1], points, (Dof(1, 3),) * 25)

inside = poles[HERTZ > 300]
found = {
    "LSCE": lsce(frfs, orders=[60]).poles[0],
    "LSCF": lscf(frfs, orders=[60]).poles[0],
    "maximum likelihood": identify(frfs).poles,
}
figure, axes = plt.subplots(figsize=(7, 2.8), layout="constrained")
for number, (name, some) in enumerate(found.items()):
    error = np.min(np.abs(some[:, None] - inside), axis=0) / np.abs(inside)
    axes.semilogy(inside.imag / 2 / np.pi, error, "osD"[number], color=COLOURS[number], label=name)
axes.set(xlabel="frequency [Hz]", ylabel="|error of the pole| / |pole| [-]")
axes.legend(loc="upper right", ncols=3, fontsize=8)
axes.set_ylim(1e-7, 1e-2)
show(figure, "poles")
