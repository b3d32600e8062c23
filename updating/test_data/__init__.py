"""What a test measured, in the coordinates of the model."""
