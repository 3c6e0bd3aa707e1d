"""Whether there is a library of the Lab Streaming Layer here."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator

from woz_tui.drivers.contract import Finding
from woz_tui.features.lsl.library import LslMissingError, load, version
from woz_tui.machine.feature_checks import FeatureChecks


def _examine() -> Iterator[Finding]:
    there = importlib.util.find_spec("pylsl") is not None
    try:
        yield Finding("ok", "lsl", version(load()))
    except LslMissingError as error:
        yield Finding("warning" if there else "info", "lsl", error.what, error.remedy)


CHECKS = FeatureChecks(_examine)
