"""Matrices in the files of Nastran's modules OUTPUT2 and OUTPUT4."""
