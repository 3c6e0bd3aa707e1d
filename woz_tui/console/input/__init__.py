"""What comes from the wizard's terminal: the stop, keys, the line's answers, signals."""
