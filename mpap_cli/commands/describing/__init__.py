"""The parts of ``info``: what is said of a log, and the keys that it has in JSON."""
