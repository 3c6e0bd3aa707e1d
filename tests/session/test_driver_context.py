"""What a driver's threads say while the event loop has no time for it."""

from __future__ import annotations

import asyncio
import logging
import threading
from pathlib import Path

import pytest

from tests.drivers.published_messages import PublishedMessages, until
from woz_tui.drivers.contract import Health
from woz_tui.protocol.messages import BodyChanged, DriverLost, SpeechStarted
from woz_tui.system.clock import ManualClock
from woz_tui.system.thread_calls import A_TURN, CAPACITY


async def test_a_flood_of_readings_takes_no_state_with_it(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    published = PublishedMessages(tmp_path)

    def talk() -> None:
        for number in range(3 * CAPACITY):
            published.context.reading("angle", float(number), unit="deg")
        published.context.health(Health.LOST, "the cable is out", "put it in")
        published.context.tell(SpeechStarted(driver="", segment=1, began=5))
        published.context.show(BodyChanged(values={"mode": "normal"}))

    turns = 0
    thread = threading.Thread(target=talk)
    thread.start()
    thread.join()  # the loop waits, so nothing is published meanwhile
    while not published.all(BodyChanged):
        before = len(published.messages)
        await asyncio.sleep(0)
        assert len(published.messages) - before <= A_TURN, "others have their turns too"
        turns += 1
    assert turns >= CAPACITY // A_TURN
    assert published.values("angle") == [float(number) for number in range(CAPACITY)]
    assert [(began.driver, began.segment) for began in published.all(SpeechStarted)] == [("it", 1)]
    assert [lost.detail for lost in published.all(DriverLost)] == ["the cable is out"]
    with caplog.at_level(logging.WARNING):
        await until(lambda: f"{2 * CAPACITY} were dropped" in caplog.text)


async def test_a_driver_tells_times_of_its_clock_on_the_axis_of_the_log(tmp_path: Path) -> None:
    clock = ManualClock()
    clock.advance(100.0)  # a clock's zero is arbitrary; the session begins now
    published = PublishedMessages(tmp_path, clock)
    clock.advance(1.5)
    began = published.context.t(clock.now_us())
    published.context.tell(SpeechStarted(driver="", segment=1, began=began))
    (speech_started,) = published.all(SpeechStarted)
    assert speech_started.began == speech_started.t == 1_500_000
