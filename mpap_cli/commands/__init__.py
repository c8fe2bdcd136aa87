"""What each command does: one typed function a command, the public API."""
