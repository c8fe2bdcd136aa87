"""A robot to try it on: worlds, laser, bumper, odometry, written as logs."""
