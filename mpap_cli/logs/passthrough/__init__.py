"""Messages as they are recorded: bytes, stamps and what the container says of their channels."""
