"""Logs that are named by a URL, read in place (extra ``remote``)."""
