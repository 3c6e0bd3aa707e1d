"""`python -m woz_tui` is `woz`."""

from woz_tui.cli import program

program()
