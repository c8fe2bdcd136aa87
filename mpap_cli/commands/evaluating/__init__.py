"""The parts of ``evaluate``: what is scored, and what is written and said of it."""
