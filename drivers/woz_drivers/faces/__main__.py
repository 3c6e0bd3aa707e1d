"""`python -m woz_drivers.faces [FOLDER]` fetches the networks."""

from __future__ import annotations

import sys

from woz_drivers.faces.models import main

sys.exit(main())
