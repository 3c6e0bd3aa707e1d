"""Draws robots: the face's lights, the links from the side and from above, knobs."""
