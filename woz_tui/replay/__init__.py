"""Replays a session from its log: on the console's screen, or on the robot."""
