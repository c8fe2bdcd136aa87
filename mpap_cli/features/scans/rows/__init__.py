"""Rows of values, one a scan: what is done with them after binning."""
