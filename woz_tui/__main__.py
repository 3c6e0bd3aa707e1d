"""`python -m woz_tui` is `woz`."""

import sys

from woz_tui.cli import main

sys.exit(main())
