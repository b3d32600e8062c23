"""What a model predicts for the points of a test, and which measured mode is which predicted one."""
