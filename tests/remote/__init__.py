"""Sessions over a network."""
