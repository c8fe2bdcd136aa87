"""The parts of ``learn --merge``: leaf models, the workers that learn them, the manifest."""
