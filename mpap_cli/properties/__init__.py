"""Bumps become presses, labels, counts and probabilities (sections 2.3 and 4.1)."""
