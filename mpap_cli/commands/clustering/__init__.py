"""Parts of ``cluster``."""
