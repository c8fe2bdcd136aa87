"""The boxes of Figure 1 joined into models (section 4)."""
