"""How frequencies follow the level of the hits."""
