"""Points are added to meta-points block by block (Algorithm 1)."""
