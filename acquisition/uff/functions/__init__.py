"""Functions: data set 58, from its header lines to hits and FRFs."""
