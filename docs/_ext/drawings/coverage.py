"""Errors over stated sigmas, for tests whose modes are known."""

import matplotlib.pyplot as plt
import numpy as np
from style import COLOURS, show

from acquisition import Dof, FrfSet
from identification import identify

HERTZ = np.array([62.0, 118, 187, 243, 310, 402, 478, 566, 655, 763, 884])
DAMPING = np.array([2.0, 1.2, 0.9, 0.7, 0.6, 0.5, 0.35, 0.3, 0.28, 0.24, 0.2]) / 100
poles = 2 * np.pi * HERTZ * (-DAMPING + 1j * np.sqrt(1 - DAMPING**2))
frequency = np.arange(20.0, 1000.0, 1.0)
s = 2j * np.pi * frequency
points = tuple(Dof(i + 1, 3) for i in range(8))

errors: list[list[float]] = [[], []]
for seed in range(40):
    rng = np.random.default_rng(seed)
    shapes = rng.standard_normal((8, len(HERTZ)))
    terms = (1 / (s[:, None] - poles) - 1 / (s[:, None] - poles.conj())) / (2j * poles.imag)
    values = (shapes * shapes[0]) @ terms.T * s**2
    noise = rng.standard_normal((2, *values.shape)) * 0.01 * np.sqrt(np.mean(np.abs(values) ** 2) / 2)
    modes = identify(FrfSet(frequency, values + noise[0] + 1j * noise[1], points, (Dof(1, 3),) * 8)).modal
    near = [int(np.argmin(np.abs(HERTZ - f))) for f in modes.frequency]
    errors[0] += list((modes.frequency - HERTZ[near]) / modes.frequency_sigma)
    errors[1] += list((modes.damping - DAMPING[near]) / modes.damping_sigma)

figure, both = plt.subplots(1, 2, figsize=(7, 2.6), sharey=True, layout="constrained")
bins = np.linspace(-4, 4, 25)
x = np.linspace(-4, 4, 200)
for axes, some, name in zip(both, errors, ("frequency", "damping ratio"), strict=True):
    inside = 100 * np.mean(np.abs(some) < 1.96)
    axes.hist(some, bins, density=True, color=COLOURS[2], alpha=0.7)
    axes.plot(x, np.exp(-(x**2) / 2) / np.sqrt(2 * np.pi), color=COLOURS[3])
    axes.set(xlabel="error / sigma [-]", title=f"{name}: {inside:.0f} % of {len(some)} within 1.96")
show(figure, "coverage")
