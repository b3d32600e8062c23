"""A synthetic hammer test of a study's model, made as the study's own test was."""
