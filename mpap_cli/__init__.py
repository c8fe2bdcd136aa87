"""Learn from robot logs, without labels: surroundings, collisions, novelty."""
