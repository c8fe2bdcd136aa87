"""MCAP files: their records, and how a file is opened."""
