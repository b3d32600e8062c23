"""The study file, read strictly."""
