"""A robot's camera in the wizard's terminal: asked for, paced by the line, drawn in three ways."""
