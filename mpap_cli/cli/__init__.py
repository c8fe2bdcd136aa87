"""Words of the command line become calls of the commands."""
