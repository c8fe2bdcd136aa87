"""Learn from robot logs, without labels: surroundings, collisions, novelty."""

__version__ = "0.1.0"
