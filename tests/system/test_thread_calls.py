"""Calls of threads are made in the event loop, whatever one of them raises."""

from __future__ import annotations

import asyncio
import threading
from typing import Any

from woz_tui.system.thread_calls import ThreadCalls


async def test_a_call_that_raises_holds_up_none_behind_it() -> None:
    calls, made, raised = ThreadCalls("arm"), asyncio.Event(), []

    def handle(_: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        raised.append(type(context["exception"]))

    asyncio.get_running_loop().set_exception_handler(handle)

    def talk() -> None:
        calls.make(lambda: 1 // 0, keep=True)
        calls.make(made.set, keep=True)

    thread = threading.Thread(target=talk)
    thread.start()
    thread.join()  # the loop waits, so both are made later
    await asyncio.wait_for(made.wait(), 10)
    assert raised == [ZeroDivisionError]
