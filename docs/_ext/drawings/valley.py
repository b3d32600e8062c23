"""What tolerances do to a misfit along which the data say nothing."""

import matplotlib.pyplot as plt
import numpy as np
from style import show

e, density = np.meshgrid(np.linspace(-0.35, 0.15, 200), np.linspace(-0.15, 0.35, 200))  # ln of the factors
data = ((0.5 * (e - density) + 0.12) / 0.005) ** 2
tolerance = (e / 0.01) ** 2 + (density / 0.003) ** 2
figure, both = plt.subplots(1, 2, figsize=(7, 2.9), sharey=True, layout="constrained")
for axes, misfit, name in ((both[0], data, "data alone"), (both[1], data + tolerance, "with tolerances")):
    levels = misfit.min() + np.array([1, 4, 16, 64, 256, 1024])
    axes.contour(np.exp(e), np.exp(density), misfit, levels, colors="#0072b2", linewidths=0.9)
    axes.plot(1, 1, "k+", label="nominal")
    axes.set(title=name, xlabel="factor of E [-]")
best = np.unravel_index(np.argmin(data + tolerance), e.shape)
both[1].plot(np.exp(e[best]), np.exp(density[best]), "o", color="#e69f00", label="most probable")
both[1].legend(loc="lower left", fontsize=8)
both[0].set_ylabel("factor of density [-]")
show(figure, "valley")
