"""Effects on the structure: its stiffness, mass and damping, its supports and what surrounds it."""
