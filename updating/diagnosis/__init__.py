"""From a gap between test and model to its cause."""
