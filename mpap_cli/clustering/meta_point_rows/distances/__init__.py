"""Distances of points and meta-points, exact ones and those that only rule out."""
