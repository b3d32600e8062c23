"""The charts of a report: pure functions from results to data, titles made of the numbers they stand over."""
