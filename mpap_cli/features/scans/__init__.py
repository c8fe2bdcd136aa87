"""Features of laser scans (section 4.1)."""
