"""The data of an update: frequencies and shapes with their errors, one specimen or several."""
