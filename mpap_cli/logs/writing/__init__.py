"""Writing logs into every container that the readers know."""
