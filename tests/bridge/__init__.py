"""Topics of a robot's own software, over a broker."""
