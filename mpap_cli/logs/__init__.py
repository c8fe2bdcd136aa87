"""Recorded logs: bytes on disk become scans and bumps in time order."""
