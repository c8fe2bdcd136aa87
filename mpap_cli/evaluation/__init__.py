"""Protocols, scores and baselines (section 5)."""
