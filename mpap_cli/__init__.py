"""Learn from robot logs, without labels, what the surroundings look like and what means a collision."""
