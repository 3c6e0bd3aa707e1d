"""libqi, NAOqi's own library: it examines ours, wherever the package `qi` has wheels.

Where it has, the development tools bring it along: a test that lacks it there fails.
"""

from __future__ import annotations

import platform
import sys

import pytest

HERE = platform.machine() == "x86_64" and sys.version_info < (3, 13)
needed = pytest.mark.skipif(not HERE, reason="the package qi has no wheels for this machine")
#: What serves a simulated robot: its own server, and libqi's.
SERVERS = ["own", pytest.param("qi", marks=needed)]
