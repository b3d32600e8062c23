"""Thin plates in water by a lattice of vortex rings, and tests of them, without any model of the library."""
