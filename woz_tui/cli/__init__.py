"""The command `woz`."""
