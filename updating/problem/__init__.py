"""The problem of one specimen: a test, a model, and everything that is doubted about either."""
