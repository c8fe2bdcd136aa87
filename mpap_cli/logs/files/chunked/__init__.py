"""What bags and MCAP files have in common: messages in chunks, with an index."""
