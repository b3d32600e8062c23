"""The app: one page on this machine that goes the way of the work, from hits to a diagnosis."""
