"""Standard deviations of what is reported, and doubts about modes."""
