"""The parts of ``predict``: scans, images, and the pictures and logs made of them."""
