"""A robot's camera in the wizard's terminal: paced by the line, drawn in one of three ways."""
