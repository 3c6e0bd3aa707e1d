"""`python -m woz_tui` is `woz`: neither imports modules of the folder in which it is called."""

import sys

if not sys.flags.safe_path:
    del sys.path[0]

from woz_tui.cli import program

program()
