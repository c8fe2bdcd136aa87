"""Which things can be seen in which direction."""
