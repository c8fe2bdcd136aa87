"""The experiments of section 5, one file each, and the bench that they work at."""
