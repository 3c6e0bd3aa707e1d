"""Behaviour Markup Language 1.0: what a behaviour planner writes, read and put in time; pure."""
