"""Universal files out."""
