"""Settings for all tests."""

from __future__ import annotations

import os

from hypothesis import HealthCheck, settings

# Machines are shared and slow: how long an example took says nothing about the code.
settings.register_profile(
    "shared", deadline=None, suppress_health_check=[HealthCheck.too_slow], print_blob=True
)
# The same examples in every run, so that a change is judged by what it changed.
settings.register_profile("repeatable", settings.get_profile("shared"), derandomize=True)
# `make fuzz`: other examples each time, and many more.
settings.register_profile("fuzz", settings.get_profile("shared"), max_examples=1000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))
