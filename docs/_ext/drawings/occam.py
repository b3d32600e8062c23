"""Why an explanation that could have explained anything has less evidence."""

import matplotlib.pyplot as plt
import numpy as np
from style import show

x = np.linspace(-8, 8, 800)
narrow, wide = (np.exp(-(x**2) / 2 / s**2) / s / np.sqrt(2 * np.pi) for s in (1.2, 4.0))
figure, axes = plt.subplots(figsize=(7, 2.4), layout="constrained")
axes.plot(x, narrow, color="#0072b2", label="a cause with a known size")
axes.plot(x, wide, color="#e69f00", label="a cause of any size, anywhere")
axes.axvline(1.0, color="k", linewidth=0.8)
axes.text(1.1, 0.33, "measured", fontsize=8)
axes.set(xlabel="shift of a frequency [sigma]", ylabel="predicted before the test", yticks=[])
axes.legend(fontsize=8)
show(figure, "occam")
