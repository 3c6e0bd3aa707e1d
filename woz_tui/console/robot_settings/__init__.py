"""The settings of a whole robot: what the wizard sees of them, and how they are changed."""
