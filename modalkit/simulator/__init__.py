"""Bodies of higher fidelity than any candidate model, what may be hidden in them, and hammer tests of them."""
