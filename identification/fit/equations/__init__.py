"""The equations of the fit: basis functions, normal equations, residues, refinement, and pruning."""
