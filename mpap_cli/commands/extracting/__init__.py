"""Parts of ``extract``: what is worth keeping, and the cutting of it."""
