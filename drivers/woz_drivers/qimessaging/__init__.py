"""The qi messaging protocol, NAOqi's wire, in Python alone."""
