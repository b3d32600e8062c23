"""The answer: verdict, places, how far the gap closes, and in which terms."""
