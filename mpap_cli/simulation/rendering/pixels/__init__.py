"""What is done to finished pixels."""
