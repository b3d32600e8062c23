"""Figures of a test: hits, FRFs, stabilisation chart, CMIF."""
