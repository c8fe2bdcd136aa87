"""Bumper topics: which they are, what their messages say."""
