"""Figures of a diagnosis: the whole answer on one page, and where the gap sits on a page of its own."""
