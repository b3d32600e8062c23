"""Raw hits: records, verdicts with their reasons, windows, and long records cut into hits."""
