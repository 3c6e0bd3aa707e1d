"""A session once more: on the console's screen, or on the robot."""
