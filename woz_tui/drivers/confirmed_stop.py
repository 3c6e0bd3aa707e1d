"""A stop in several parts: which of them have confirmed in time."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Collection, Mapping
from typing import Any

from woz_tui.drivers.background import forget_outcome
from woz_tui.drivers.contract import StopReport
from woz_tui.system.tasks import wait_at_most

#: The bus waits 0.5 s for a stop; what has not confirmed after so long is told as missing.
STOP_S = 0.45
#: How long more where this process has stood still beyond that; the bus then mostly has, too.
AGAIN_S = 0.05

log = logging.getLogger(__name__)

#: What has to end before a part has confirmed, by the part's name.
Ends = Mapping[str, Collection[asyncio.Future[Any]]]


def succeeded(end: asyncio.Future[Any]) -> bool:
    """Whether it is over, and was neither cancelled nor failed."""
    return end.done() and not end.cancelled() and end.exception() is None


async def confirmed_within(seconds: float, ends: Ends) -> StopReport:
    """Which parts have confirmed when all have ended, or after `seconds`. What is late goes on: a
    slow line must not keep a robot moving.
    """
    every = {end for of_part in ends.values() for end in of_part}
    for end in every:
        end.add_done_callback(forget_outcome)
    await wait_at_most(every, seconds, AGAIN_S)
    missing = {name for name, of_part in ends.items() if not all(map(succeeded, of_part))}
    for name in missing:
        failed = [str(end.exception()) for end in ends[name] if end.done() and not end.cancelled()]
        log.info("stop of %s: %s", name, ", ".join(failed) or "late")
    return StopReport(tuple(sorted(ends.keys() - missing)), tuple(sorted(missing)))
