"""Features become meta-points and clusters (sections 2.2 and 3)."""
