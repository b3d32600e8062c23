"""Random specimens and tests, drawn without knowledge of what is hidden."""
