"""ROS 1 bags: their records, and how a bag is opened."""
