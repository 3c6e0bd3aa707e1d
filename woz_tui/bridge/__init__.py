"""Other programs and devices that play the robot: MIDI panels, BML realizers."""
