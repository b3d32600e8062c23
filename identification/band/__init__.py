"""Where in a band FRFs carry information, and whether they are good enough to explain a gap by."""
