"""Programs that several devices start: their command lines, their ends, those that stay loaded."""
