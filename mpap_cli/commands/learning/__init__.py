"""The parts of ``learn``: models on their way through the logs, and what is kept of them."""
