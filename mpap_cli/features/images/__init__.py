"""Features of camera images (section 4.2.2)."""
