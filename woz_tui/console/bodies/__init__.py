"""Robots as they look: the face's lights, the links seen from the side and from above, knobs."""
