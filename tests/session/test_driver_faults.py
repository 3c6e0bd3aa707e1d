"""Errors of a driver's own tasks, timers, callbacks and threads, and statements of wrong types."""

from __future__ import annotations

import asyncio
import gc
import logging
import sys
import threading
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from tests.drivers.published_messages import PublishedMessages
from tests.fakes.virtual_time import run_virtual
from tests.session.rig import NoSettings, ScriptedDriver, SessionRig
from woz_tui.drivers.contract import (
    Health,
    HealthStatement,
    ModeStatement,
    SensorStatement,
)
from woz_tui.protocol import messages as m
from woz_tui.session.driver_faults import THROWN_AWAY, tell_faults
from woz_tui.session.redactor import PerceptionFilter, Redactor
from woz_tui.testing.recording_context import RecordingContext

WRONG: Any = 5


LIBRARY = """\
class Handle:
    def __del__(self):
        raise OSError("no such handle")
"""


class Port:
    """Cannot be closed."""

    def __del__(self) -> None:
        raise OSError("no such port")


class Flawed(ScriptedDriver):
    """Fails where its name says, in code that it runs by itself."""

    async def open(self) -> None:
        await super().open()
        loop = asyncio.get_running_loop()
        match self.name:
            case "task":
                self.reader = loop.create_task(self.read())
            case "timer":
                loop.call_later(0.1, self.tick)
            case "reads":
                loop.call_later(1, self.context.reading, "distance", 1.0)
            case "thread":
                thread = threading.Thread(target=self.work)
                thread.start()
                thread.join()
            case "garbage":
                loop.create_task(self.wait_for_nothing())  # noqa: RUF006 - that is the point
                loop.call_later(1, gc.collect)
            case "awaited":
                self.reader = loop.create_task(self.read())
                self.waiter = loop.create_task(self.wait())

    async def read(self) -> None:
        await asyncio.sleep(2)
        raise OSError("the port is gone")

    async def wait_for_nothing(self) -> None:
        await asyncio.get_running_loop().create_future()

    async def wait(self) -> None:
        try:
            await self.reader
        except OSError:
            self.context.health(Health.LOST, "the cable is out")

    def tick(self) -> None:
        asyncio.get_running_loop().call_later(0.1, self.tick)
        raise ValueError("no number: 'x'")

    def work(self) -> None:
        raise KeyError("knob")

    def lose_hand(self, client: str) -> None:
        if self.name == "hand":
            raise ZeroDivisionError("no hand")
        self.calls.append(("lose_hand", {"client": client}))


def on_stage(
    tmp_path: Path,
    driver: str,
    scenario: Callable[[SessionRig], Awaitable[None]],
    seconds: float = 0.0,
) -> list[m.DriverFaulted]:
    rig = SessionRig(tmp_path, (driver, "robot"), catalogue={"puppet": Flawed})
    return rig.run(scenario, seconds).of(m.DriverFaulted)


async def nothing(rig: SessionRig) -> None:
    pass


@pytest.mark.parametrize(
    ("driver", "says", "place"),
    [
        ("task", "OSError: the port is gone", "in read"),
        ("thread", "KeyError: 'knob'", "in work"),
        ("garbage", THROWN_AWAY, "in wait_for_nothing"),
        ("awaited", "", ""),
    ],
)
def test_what_dies_in_a_driver_s_own_code_is_its_fault_unless_it_looks_itself(
    tmp_path: Path, driver: str, says: str, place: str
) -> None:
    told = on_stage(tmp_path, driver, nothing, 60)
    assert len(told) == (driver != "awaited")
    for each in told:
        assert each.driver == driver
        assert each.detail.startswith(f"{says} (test_driver_faults.py:")
        assert each.detail.endswith(f"{place})")
        assert "host.log" in each.remedy


def test_what_is_found_with_garbage_of_nobody_known_is_a_notice_and_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    library: dict[str, Any] = {}
    exec(compile(LIBRARY, "library.py", "exec"), library)

    async def go() -> SessionRig:
        hook, sys.unraisablehook = sys.unraisablehook, sys.__unraisablehook__
        rig = SessionRig(tmp_path)
        await rig.session.open()
        for _ in range(10):
            library["Handle"]()
        await asyncio.sleep(1)
        await rig.session.close("test")
        assert sys.unraisablehook is sys.__unraisablehook__, "left as it was"
        sys.unraisablehook = hook
        return rig

    rig = run_virtual(go())
    told = [line for line in rig.lines if isinstance(line, m.Notice) and "library" in line.text]
    assert [(each.level, each.text.partition(": ")[2]) for each in told] == [
        ("warning", "OSError: no such handle (library.py:3 in __del__)"),
        ("warning", "OSError: no such handle (library.py:3 in __del__, 10 times)"),
    ]
    assert all("host.log" in each.remedy for each in told)
    assert capsys.readouterr().err.count("Traceback") == 1, "where host.log is written to"


def test_an_error_of_nobody_is_told_by_one_of_several_drivers() -> None:
    library: dict[str, Any] = {}
    exec(compile(LIBRARY, "library.py", "exec"), library)
    contexts = [RecordingContext() for _ in range(3)]

    async def go() -> None:
        hooks = sys.unraisablehook, threading.excepthook
        sys.unraisablehook = sys.__unraisablehook__
        tell_faults(
            {
                name: ScriptedDriver(name, NoSettings(), context)
                for name, context in zip(("head", "base", "arm"), contexts, strict=True)
            }
        )
        library["Handle"]()
        await asyncio.sleep(1)
        sys.unraisablehook, threading.excepthook = hooks

    run_virtual(go())
    (told,) = [notice for context in contexts for notice in context.notices]
    assert "OSError: no such handle" in told[1]


def test_what_is_found_with_garbage_while_a_line_is_written_is_told_after_it(
    tmp_path: Path,
) -> None:
    """The collector runs at any place, also where the log's lock is held."""

    def listener(line: m.Message) -> None:
        if isinstance(line, m.Note):
            Port()
            within.append(line.text)

    async def go() -> SessionRig:
        rig = SessionRig(tmp_path, catalogue={"puppet": Flawed})
        rig.session.hub.listen(listener)
        await rig.session.open()
        rig.session.note("first")
        rig.session.note("second")
        await asyncio.sleep(1)
        await rig.session.close("test")
        return rig

    within: list[str] = []
    rig = run_virtual(go())
    assert within == ["first", "second"]
    assert rig.kinds(m.Note, m.DriverFaulted) == ["Note", "Note", "DriverFaulted"]
    (told,) = [line for line in rig.lines if isinstance(line, m.DriverFaulted)]
    assert told.detail.startswith("OSError: no such port (test_driver_faults.py:")
    assert told.detail.endswith("in __del__)")


def test_an_error_that_recurs_is_counted_and_not_repeated(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.ERROR):
        told = on_stage(tmp_path, "timer", nothing, 150)
    counts = [each.detail.rpartition(" in tick")[2] for each in told]
    assert counts == [")", ", 10 times)", ", 100 times)", ", 1000 times)"]
    assert caplog.text.count("Traceback") == 1
    assert len(caplog.records) == 4


def test_a_driver_that_is_well_again_and_fails_again_says_both(tmp_path: Path) -> None:
    health: list[m.DriverHealth] = []

    async def scenario(rig: SessionRig) -> None:
        context = rig.session.drivers["robot"].context
        rig.session.hub.listen(health.append, m.DriverHealth)
        wrong: Any = "1234"
        for _ in range(2):
            for _ in range(2):
                context.reading("distance", 1.0, raw=wrong)
                context.health(Health.CONNECTED, "a puppet")  # as each second, while it fails
            await asyncio.sleep(20)
            context.health(Health.CONNECTED, "a puppet")
        context.reading("distance", 1.0, raw=wrong)
        context.health(Health.CONNECTED, "another one")

    on_stage(tmp_path, "plain", scenario)
    assert [type(each).__name__ for each in health] == [
        *("DriverFaulted", "DriverConnected"),
        *("DriverFaulted", "DriverConnected"),
        *("DriverFaulted", "DriverConnected"),
    ]


def test_a_hand_that_a_driver_fails_to_lose_is_lost_by_the_others(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.lose_hands("con1")
        assert rig.driver().calls == [("lose_hand", {"client": "con1"})]

    (driver_faulted,) = on_stage(tmp_path, "hand", scenario)
    assert (driver_faulted.driver, driver_faulted.detail[:26]) == (
        "hand",
        "ZeroDivisionError: no hand",
    )


def test_what_the_session_does_upon_a_reading_is_not_the_driver_s_fault(tmp_path: Path) -> None:
    others: list[dict[str, Any]] = []

    def listener(line: m.Message) -> None:
        if isinstance(line, m.Reading):
            asyncio.get_running_loop().call_later(1, [].__getitem__, 99)

    async def listening(rig: SessionRig) -> None:
        asyncio.get_running_loop().set_exception_handler(lambda _, told: others.append(told))
        rig.session.hub.listen(listener)
        async with rig:
            await asyncio.sleep(5)

    rig = SessionRig(tmp_path, ("reads",), catalogue={"puppet": Flawed})
    run_virtual(listening(rig))
    assert rig.kinds(m.Reading, m.DriverFaulted) == ["Reading"]
    assert [type(told["exception"]) for told in others] == [IndexError]


@pytest.mark.parametrize(
    "tell",
    [
        lambda context: context.reading("distance", "12"),
        lambda context: context.reading("distance", True),
        lambda context: context.reading("distance", 1.0, raw="1234"),
        lambda context: context.reading("distance", None, text=b"12"),
        lambda context: context.reading("distance", None, text="\udcff"),
        lambda context: context.reading(12, 1.0),
        lambda context: context.sensor("distance", 3),
        lambda context: context.sensor("distance", "ok", every="1"),
        lambda context: context.sensor(["distance"], "ok"),
        lambda context: context.mode(4),
        lambda context: context.notice("info", "x", tells=5),
        lambda context: context.notice(2, "x"),
        lambda context: context.health("connected"),
        lambda context: context.health(Health.CONNECTED, 5),
        lambda context: context.show(m.BodyChanged(values=WRONG)),
        lambda context: context.publish("hello"),
    ],
)
async def test_a_statement_of_a_wrong_type_is_a_fault_and_not_in_the_log(
    tmp_path: Path, tell: Callable[[Any], None]
) -> None:
    published = PublishedMessages(tmp_path)
    for _ in range(3):
        tell(published.context)
    (told,) = published.messages
    assert isinstance(told, m.DriverFaulted)
    assert "is not recorded" in told.detail
    assert "test_driver_faults.py" in told.detail
    for right in (SensorStatement("distance", "ok"), ModeStatement("normal")):
        published.context.publish(right)
    published.context.publish(HealthStatement(Health.CONNECTED))
    assert len(published.messages) == 4, "what is right goes on"


def test_the_words_of_an_error_may_tell_what_is_kept() -> None:
    redactor = Redactor()
    redactor.perception = PerceptionFilter(["identity"])
    driver_faulted = m.DriverFaulted(driver="it", detail="ValueError: 'Anna'", tells=("identity",))
    seen = redactor.message(driver_faulted)
    assert isinstance(seen, m.DriverFaulted)
    assert (seen.driver, "Anna" in seen.detail) == ("it", False)
