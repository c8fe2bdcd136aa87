"""From a scene to the pixels of one image."""
