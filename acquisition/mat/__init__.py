"""MATLAB files: numbers alone, each checked against the file before it is read."""
