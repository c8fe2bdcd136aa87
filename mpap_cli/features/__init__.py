"""Observations become embedded histograms (sections 2.1 and 4.1)."""
