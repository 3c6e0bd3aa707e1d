"""Which pages are open here, with their addresses and codes."""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.drivers.contract import Finding
from woz_tui.features.page.control import open_pages, order
from woz_tui.machine.feature_checks import FeatureChecks


def _examine() -> Iterator[Finding]:
    for path in open_pages():
        told = order(path)
        for line in told[:-1] if told else ():
            session = path.name.partition(".")[0]
            yield Finding("ok", f"page of {session}", " ".join(line.split()))


CHECKS = FeatureChecks(_examine)
