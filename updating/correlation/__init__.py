"""Test beside model: pairs of modes, MAC, and FRFs one over the other."""
