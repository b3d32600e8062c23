"""What is asked of a diagnosis: one specimen or several, and whether it is of this model at all."""
