"""What the data of an update determine, how well, and what should not be believed of it."""
