"""Tables of meta-points and the compiled Algorithm 1 on them."""
