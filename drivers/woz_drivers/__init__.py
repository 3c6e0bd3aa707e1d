"""Drivers that come with woz-tui."""
