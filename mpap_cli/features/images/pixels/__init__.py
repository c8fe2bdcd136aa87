"""What is told of a single pixel: the bins of its color and the code of its neighborhood."""
