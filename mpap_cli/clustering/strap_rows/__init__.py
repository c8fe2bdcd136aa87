"""What streaming affinity propagation keeps, one row a cluster or outlier (section 3.3)."""
