"""The body's behaviour: limits, kinematics, layers, moves, face, modes."""
