"""The engagement model as the wizard sees it: who is there, are they with the robot, and why."""
