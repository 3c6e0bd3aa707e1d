"""Behaviour Markup Language."""
