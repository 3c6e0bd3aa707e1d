"""Dialogs and full screens of the console."""
