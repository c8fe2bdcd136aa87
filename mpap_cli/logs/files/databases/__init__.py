"""The SQLite files of rosbag2, whole and broken."""
