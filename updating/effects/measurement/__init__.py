"""Effects of the measurement: windows, delays, gains, signs, labels and places."""
