"""Simulated robots that speak their makers' protocols: programs and fakes for tests at once."""
