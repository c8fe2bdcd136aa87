"""Files without an index, or a broken one: read through once."""
