"""The log of a session: written so that nothing acknowledged is lost, read back whole."""
