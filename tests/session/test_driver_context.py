"""What a driver's threads say while the event loop has no time for it."""

from __future__ import annotations

import asyncio
import logging
import threading
from pathlib import Path

import pytest

from tests.drivers.heard import Heard, until
from woz_tui.drivers.contract import Health
from woz_tui.protocol.messages import BodyChanged, DriverLost, SpeechStarted
from woz_tui.system.clock import ManualClock
from woz_tui.system.thread_calls import A_TURN, CAPACITY


async def test_a_flood_of_readings_takes_no_state_with_it(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    heard = Heard(tmp_path)

    def talk() -> None:
        for number in range(3 * CAPACITY):
            heard.context.reading("angle", float(number), unit="deg")
        heard.context.health(Health.LOST, "the cable is out", "put it in")
        heard.context.tell(SpeechStarted(driver="", segment=1, began=5))
        heard.context.show(BodyChanged(values={"mode": "normal"}))

    turns = 0
    thread = threading.Thread(target=talk)
    thread.start()
    thread.join()  # the loop waits, so nothing is published meanwhile
    while not heard.all(BodyChanged):
        before = len(heard.messages)
        await asyncio.sleep(0)
        assert len(heard.messages) - before <= A_TURN, "others have their turns too"
        turns += 1
    assert turns >= CAPACITY // A_TURN
    assert heard.values("angle") == [float(number) for number in range(CAPACITY)]
    assert [(began.driver, began.segment) for began in heard.all(SpeechStarted)] == [("it", 1)]
    assert [lost.detail for lost in heard.all(DriverLost)] == ["the cable is out"]
    with caplog.at_level(logging.WARNING):
        await until(lambda: f"{2 * CAPACITY} were dropped" in caplog.text)


async def test_a_driver_tells_times_of_its_clock_on_the_axis_of_the_log(tmp_path: Path) -> None:
    clock = ManualClock()
    clock.advance(100.0)  # a clock's zero is arbitrary; the session begins now
    heard = Heard(tmp_path, clock)
    clock.advance(1.5)
    began = heard.context.t(clock.now_us())
    heard.context.tell(SpeechStarted(driver="", segment=1, began=began))
    (told,) = heard.all(SpeechStarted)
    assert told.began == told.t == 1_500_000
