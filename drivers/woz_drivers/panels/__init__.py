"""Panels of controls, MIDI and hands: what a control does, and the request that it becomes."""
