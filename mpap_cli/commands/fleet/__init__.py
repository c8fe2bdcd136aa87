"""``learn --merge``: leaf models of many logs, the workers that learn them, the manifest."""
