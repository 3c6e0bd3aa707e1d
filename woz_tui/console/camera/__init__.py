"""A robot's camera in the wizard's terminal: requests at the pace of the line, three ways of drawing."""
