"""Video in logs: its packets, and which of them are needed to decode which."""
