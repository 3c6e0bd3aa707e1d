"""A driver at another computer is used as one here; what the network does to it."""

from __future__ import annotations

import asyncio
import contextlib
import os
import random
import signal
import subprocess
import sys
import threading
from collections.abc import AsyncIterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import pytest
from woz_drivers.simulated import SimulatedRobot

from tests.fakes.ports import free_port
from tests.network.other_computer import (
    PLACE,
    SILENCE_S,
    Arm,
    ArmSettings,
    OtherComputer,
    Pair,
    pair,
    remote_driver,
)
from tests.remote.network import Cable
from woz_tui.drivers import bundled_media
from woz_tui.drivers.contract import (
    Ask,
    DeviceLostError,
    DriverContext,
    DriverError,
    Forecast,
    Health,
    Offer,
    RejectedError,
    Scope,
    StopReport,
    Verb,
)
from woz_tui.network import driver_line, driver_messages, driver_server, zenoh_line
from woz_tui.network import remote_driver as remote_side
from woz_tui.network.child_line import ChildLine
from woz_tui.network.driver_line import to_key
from woz_tui.network.driver_router import DriverRouter
from woz_tui.network.driver_server import OfferedDriver, ServedDriver
from woz_tui.network.remote_driver import RemoteDriver
from woz_tui.network.served_context import ServedContext
from woz_tui.testing import Device, DriverTests, PlainJob, RecordingContext, until

ROOT = Path(__file__).parents[2]
LIFT = PlainJob("lift", {"kg": 2.0})


#: Of the product. The contract gives a stop 4 s: see `patient_contract`.
STOP_S, LATE_S = remote_side.STOP_S, remote_side.LATE_S

pytestmark = pytest.mark.usefixtures("patient_network")


# -- the contract ----------------------------------------------------------------------------------


class RemoteRobot(RemoteDriver):
    """The simulated robot at another computer, as the tests of the contract make drivers."""

    Settings = SimulatedRobot.Settings
    offer = staticmethod(SimulatedRobot.offer)
    remarks = staticmethod(SimulatedRobot.remarks)
    port = 0

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        router = DriverRouter(f"tcp://127.0.0.1:{self.port}", [PLACE], silence_s=SILENCE_S)
        super().__init__(
            *("arm", settings, context),
            local=SimulatedRobot,
            kind="arm",
            router=router,
            place=PLACE,
        )


@pytest.mark.real_clock
@pytest.mark.safety
class TestServedRobot(DriverTests):
    driver = RemoteRobot
    settings = SimulatedRobot.Settings()

    @pytest.fixture(autouse=True)
    def _port(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(RemoteRobot, "port", free_port())

    @contextlib.asynccontextmanager
    async def device(self) -> AsyncIterator[Device]:
        cable = Cable(RemoteRobot.port, 0.25)
        await cable.lay()
        words = [sys.executable, "-m", "tests.network.other_program", str(cable.own_port)]
        say = PlainJob("say", {"text": "a long sentence " * 50})
        with subprocess.Popen(words, cwd=ROOT) as process:  # noqa: ASYNC220 - for a moment only
            try:
                yield Device(self.settings, cable.cut, cable.lay, say)
            finally:
                process.kill()
                await cable.cut()


# -- use -------------------------------------------------------------------------------------------


async def test_a_file_that_comes_with_woz_tui_is_the_other_computers_own(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        shown = await two.remote.perform(PlainJob("show", {"file": "woz:waiting.gif"}))
    size = (bundled_media.FOLDER / "waiting.gif").stat().st_size
    assert shown == {"file": "woz:waiting.gif", "bytes": size}


async def test_a_command_gives_what_the_driver_gives(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        assert await two.remote.perform(PlainJob("wave")) == {"waved": 1}
        with pytest.raises(RejectedError) as raised:
            await two.remote.perform(PlainJob("lift", {"kg": 13.0}))
        assert (raised.value.what, raised.value.remedy) == ("too heavy", "take less")
        with pytest.raises(RejectedError):
            await two.remote.perform(PlainJob("lift", {"kg": "much"}))
        with pytest.raises(DriverError, match="ZeroDivisionError: no weight"):
            await two.remote.perform(PlainJob("lift", {"kg": 14.0}))
        job = replace(LIFT, expected=[])
        lifting = asyncio.create_task(two.remote.perform(job))
        await until(lambda: bool(job.expected))
        assert job.expected == [20.0]
        lifting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await lifting
        assert not two.arm.under_way
        assert [verb for verb, _ in two.arm.calls] == ["wave", "lift", "lift", "lift"]


async def test_marks_and_arrivals_come_across_and_a_command_is_predicted(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        job = PlainJob("wave")
        await two.remote.perform(job)
        assert (job.marks, job.arrivals) == ([("stroke", "up")], [])
        assert job.evidences == ["reported"]
        two.arm.waving.evidence("measured")
        two.arm.arrive("")
        await until(lambda: job.arrivals == [""])
        assert job.evidences == ["reported", "measured"]
        assert await two.remote.predict("lift", {"kg": 1.0}) == Forecast(
            1.5, ((0.5, "stroke", "lift"),)
        )


async def test_the_session_gets_everything_that_the_driver_tells(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        thread = threading.Thread(target=two.arm.tells)  # from any thread
        thread.start()
        await asyncio.to_thread(thread.join)
        context = two.context
        await until(lambda: bool(context.shown))
        assert (context.latest("load"), context.of("load")[0].unit) == (2.5, "kg")
        assert context.states == [("load", "ok", "")]
        assert context.modes == ["demo"]
        assert context.notices == [("warning", "warm", "wait")]
        assert context.shown[0].values == {"lift": 3}  # type: ignore[attr-defined]
        ended: list[tuple[bool, str]] = []
        context.outcome = (False, "not now")
        two.arm.ask_session(Ask("action", "Hello"), ended)
        await until(lambda: bool(ended))
        assert context.asks == [Ask("action", "Hello")]
        assert ended == [(False, "not now")]


async def test_what_is_called_aside_is_called_there(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        await two.remote.prepare_say([{"text": "Hello"}, {"text": "Bye"}])
        await two.remote.rest()
        await two.remote.resume()
        assert two.arm.others == ["prepare Hello Bye", "rest", "resume"]
        assert await asyncio.to_thread(two.remote.reread, ArmSettings(), dry_run=True) == [
            "heavier"
        ]
        arm = two.arm
        await two.remote.close()
        assert arm.others[-1] == "close"


async def test_times_are_the_sessions(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        clock = two.arm.context.clock
        before = two.context.clock.now_us()
        here = two.arm.context.t(clock.now_us())
        # Both are processes of one machine, so the clocks are one; what remains is the measuring.
        assert abs(here - before) < 2_000_000


# -- the stop --------------------------------------------------------------------------------------


async def test_a_stop_is_confirmed_by_the_driver_itself(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        lifting = asyncio.create_task(two.remote.perform(LIFT))
        await until(lambda: bool(two.arm.under_way))
        two.arm.report = StopReport(("lift",), ("hand",))
        assert await two.remote.stop(Scope.ALL) == StopReport(("lift",), ("hand",))
        assert not two.arm.under_way
        assert two.arm.others == ["stop all"]
        await asyncio.gather(lifting, return_exceptions=True)


async def test_only_driving_ends_when_nobody_watches(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        tasks = [asyncio.create_task(two.remote.perform(job)) for job in (LIFT, PlainJob("roll"))]
        await until(lambda: two.arm.under_way == {"lift", "roll"})
        await two.remote.stop(Scope.DRIVE)
        await until(lambda: two.arm.under_way == {"lift"})
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def test_a_driver_that_does_not_stop_is_no_lost_one(tmp_path: Path) -> None:
    """The other computer has the stop, so it counts as not confirmed and not as unreached."""
    async with pair(tmp_path) as two:
        two.arm.stopping.clear()
        stopping = asyncio.create_task(two.remote.stop(Scope.ALL))
        await until(lambda: any(taken.done() for taken, _ in two.remote._stops.values()))
        assert not stopping.done()
        two.arm.stopping.set()
        assert await stopping is None


@pytest.mark.real_clock
@pytest.mark.safety
async def test_a_stop_that_does_not_arrive_is_unreached(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with pair(tmp_path) as two:
        monkeypatch.setattr(remote_side, "STOP_S", STOP_S)
        two.cable.flowing.clear()
        with pytest.raises(DeviceLostError, match="confirm"):  # and not because it is silent
            await two.remote.stop(Scope.ALL)


async def test_a_command_that_the_stop_has_overtaken_does_not_begin(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        two.cable.flowing.clear()
        lifting = asyncio.create_task(two.remote.perform(LIFT))
        await until(lambda: two.cable.held_back > 0)
        stopping = asyncio.create_task(two.remote.stop(Scope.ALL))
        await asyncio.sleep(0)
        lifting.cancel()
        two.cable.flowing.set()
        await asyncio.gather(stopping, lifting, return_exceptions=True)
        await two.remote.perform(PlainJob("wave"))
        assert "lift" not in two.arm.under_way


async def test_a_full_line_has_room_for_the_stop(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        line = await two.router.join(PLACE)
        assert isinstance(line, ChildLine)
        os.kill(line.pid, signal.SIGSTOP)  # it takes nothing meanwhile
        while line.send("woz/nobody", b""):
            pass
        stopping = asyncio.create_task(two.remote.stop(Scope.ALL))
        await asyncio.sleep(0)
        os.kill(line.pid, signal.SIGCONT)
        assert await stopping is None
        assert two.arm.others == ["stop all"]
        await two.router.leave()


async def test_a_driver_that_talks_without_end_does_not_hold_up_its_stop(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        quiet = threading.Event()

        def talk() -> None:
            while not quiet.is_set():
                two.arm.context.reading("load", 1.0, unit="kg")

        thread = threading.Thread(target=talk)
        thread.start()
        try:
            await until(lambda: len(two.context.of("load")) > 0)
            with contextlib.suppress(DeviceLostError):  # the line may be too full for the rest
                await two.remote.stop(Scope.ALL)
            await until(lambda: "stop all" in two.arm.others)
        finally:
            quiet.set()
            await asyncio.to_thread(thread.join)


# -- the network -----------------------------------------------------------------------------------


async def test_a_cut_ends_everything_on_both_sides_and_is_repaired(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        two.arm.tells()
        await until(lambda: bool(two.context.states))
        lifting = asyncio.create_task(two.remote.perform(LIFT))
        await until(lambda: bool(two.arm.under_way))
        await two.cable.cut()
        with pytest.raises(DeviceLostError):
            await lifting
        what, _ = await two.healthy(Health.LOST)
        assert PLACE in what
        assert two.context.states[-1][:2] == ("load", "stale")
        await until(lambda: two.arm.others == ["stop all"])
        assert not two.arm.under_way
        with pytest.raises(DeviceLostError):
            await two.remote.perform(LIFT)
        arm = two.arm
        await two.cable.lay()
        await two.healthy(Health.CONNECTED)
        assert two.arm is arm  # the hardware was held
        await until(lambda: two.context.states[-1][:2] == ("load", "ok"))
        await until(lambda: arm.others[-1] == "resume")
        assert await two.remote.perform(PlainJob("wave")) == {"waved": 1}


async def test_after_a_stop_nothing_moves_by_itself_when_the_line_is_back(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        await two.remote.stop(Scope.ALL)
        await two.cable.cut()
        await two.healthy(Health.LOST)
        await two.cable.lay()
        await two.healthy(Health.CONNECTED)
        await two.remote.rest()
        assert "resume" not in two.arm.others


@pytest.mark.real_clock
@pytest.mark.safety
async def test_a_frozen_network_stops_the_driver_and_delivers_nothing_late(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        lifting = asyncio.create_task(two.remote.perform(LIFT))
        await until(lambda: bool(two.arm.under_way))
        two.cable.flowing.clear()
        rolling = asyncio.create_task(two.remote.perform(PlainJob("roll")))
        await until(lambda: not two.arm.under_way, 4 * SILENCE_S)
        for each in (lifting, rolling):
            with pytest.raises(DeviceLostError):
                await each
        two.cable.flowing.set()
        await two.healthy(Health.CONNECTED)
        await two.remote.perform(PlainJob("wave"))
        assert "roll" not in {verb for verb, _ in two.arm.calls}


@pytest.mark.real_clock
@pytest.mark.safety
async def test_a_slow_network_refuses_what_comes_late_and_lets_the_stop_through(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with pair(tmp_path) as two:
        monkeypatch.setattr(remote_side, "STOP_S", STOP_S)
        monkeypatch.setattr(remote_side, "LATE_S", LATE_S)
        two.cable.delay = LATE_S + 0.1
        with pytest.raises(DriverError, match="too late"):
            await two.remote.perform(LIFT)
        assert not two.arm.calls
        with pytest.raises(DeviceLostError):  # it comes after its time, and does come
            await two.remote.stop(Scope.ALL)
        await until(lambda: "stop all" in two.arm.others)


async def test_what_was_lost_on_the_way_ends_the_conversation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A full line drops; neither side goes on as if nothing had been there."""
    async with pair(tmp_path) as two:
        lifting = asyncio.create_task(two.remote.perform(LIFT))
        await until(lambda: bool(two.arm.under_way))
        with monkeypatch.context() as full:
            full.setattr(zenoh_line, "CAPACITY", 0)
            two.arm.context.notice("info", "nobody gets this")
        with pytest.raises(DeviceLostError):
            await lifting
        await until(lambda: not two.arm.under_way)
        await two.healthy(Health.CONNECTED)


async def test_our_own_conversation_that_the_other_side_still_has_is_nobody_elses(
    tmp_path: Path,
) -> None:
    """A `Here` was on its way when the session lost something."""
    async with pair(tmp_path) as two:
        here = driver_messages.Here(driver_messages.LINK, "1", two.remote._epoch, "arm")
        instance = two.remote._bound
        two.remote._lose("something was lost")
        two.remote._receive(
            driver_messages.encode(driver_messages.FrameFromDriver(instance, 0, 0, here))
        )
        await two.healthy(Health.CONNECTED)
        assert Health.FAULTED not in [health for health, *_ in two.context.healths]


@pytest.mark.parametrize("released", [True, False], ids=["released", "pressed"])
async def test_what_the_wizard_does_while_the_line_comes_back_is_not_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, released: bool
) -> None:
    """Between the session's greeting and the first ping, which says that it has the driver."""
    lost: list[bytes] = []
    unheard = asyncio.Event()
    receive = RemoteDriver._receive

    def pings_get_lost(remote: RemoteDriver, data: bytes) -> None:
        ping = isinstance(driver_messages.from_driver.decode(data).body, driver_messages.Ping)
        if ping and unheard.is_set():
            lost.append(data)
        else:
            receive(remote, data)

    monkeypatch.setattr(RemoteDriver, "_receive", pings_get_lost)
    async with pair(tmp_path) as two:
        if released:
            await two.remote.stop(Scope.ALL)
        unheard.set()
        await two.cable.cut()
        await two.healthy(Health.LOST)
        lost.clear()
        await two.cable.lay()
        await until(lambda: bool(lost), 20)
        if released:
            await two.remote.resume()
        else:
            await two.remote.stop(Scope.ALL)
        two.arm.others.clear()
        unheard.clear()
        await two.healthy(Health.CONNECTED)
        await two.remote.perform(PlainJob("wave"))
        assert two.arm.others == ["resume"] * released


async def test_a_release_that_a_stop_has_overtaken_is_none(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        send = two.remote._send
        send(driver_messages.Stop(1002, Scope.ALL.value), urgent=True)
        await until(lambda: "stop all" in two.arm.others)
        for number, what in ((1000, "resume"), (1001, "rest"), (1003, "resume")):
            send(driver_messages.Invoke(number, what))
        await until(lambda: "resume" in two.arm.others)
        assert two.arm.others == ["stop all", "resume"]


# -- letting go ------------------------------------------------------------------------------------


class SlowArm(Arm):
    """Takes its time to let go of the hardware."""

    #: Of all of them, in their order.
    lives: ClassVar[list[str]] = []

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.lives.append("made")
        self.may_close = asyncio.Event()

    async def close(self) -> None:
        self.lives.append("closing")
        await self.may_close.wait()
        self.lives.append("closed")


@contextlib.asynccontextmanager
async def slow_pair(
    folder: Path, beside: Sequence[OfferedDriver] = ()
) -> AsyncIterator[tuple[Pair, SlowArm]]:
    """Both sides, and the driver there."""
    SlowArm.lives.clear()
    async with pair(folder, SlowArm, beside=beside) as two:
        arm = two.arm
        assert isinstance(arm, SlowArm)
        try:
            yield two, arm
        finally:
            arm.may_close.set()
            if isinstance(two.arm, SlowArm):
                two.arm.may_close.set()


async def test_a_line_that_is_cut_meanwhile_cuts_nothing_short(tmp_path: Path) -> None:
    async with slow_pair(tmp_path) as (two, arm):
        closing = asyncio.create_task(two.remote.close())
        await until(lambda: "closing" in arm.lives)
        await two.cable.cut()
        await closing
        await until(lambda: any("is stopped" in line for line in two.other.lines))
        ending = asyncio.create_task(two.other.end())  # ctrl+c waits for it
        await asyncio.sleep(0)
        arm.may_close.set()
        await ending
        assert arm.lives == ["made", "closing", "closed"]


async def test_a_conversation_that_was_lost_at_the_same_moment_is_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nobody there hears any more that the session closes; its hardware is stopped and held."""
    monkeypatch.setattr(remote_side, "CLOSE_S", 2.0)
    async with pair(tmp_path) as two:
        assert isinstance(two.arm.context, ServedContext)
        served = two.arm.context._line
        assert isinstance(served, ServedDriver)
        served.lose("something that the session sent was lost")
        await two.remote.close()
        assert two.arm.others == ["stop all"]


async def test_who_takes_too_long_is_told_and_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_side, "CLOSE_S", 2.0)
    async with slow_pair(tmp_path) as (two, arm):
        with pytest.raises(DriverError, match="let go"):
            await two.remote.close()
        await until(lambda: any("has ended" in line for line in two.other.lines))
        arm.may_close.set()
        await until(lambda: arm.lives == ["made", "closing", "closed"])


async def test_another_session_waits_until_the_hardware_is_free(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with slow_pair(tmp_path) as (two, arm):
        monkeypatch.setattr(remote_side, "SESSION", "another")
        two.remote._lose("the session began anew")
        await until(lambda: "closing" in arm.lives)
        for _ in range(2):  # it greets again and again
            before, two.remote._greeted_us = two.remote._epoch, 0
            await until(lambda: two.remote._epoch != before)  # noqa: B023
        await asyncio.sleep(0.2)
        arm.may_close.set()
        await two.healthy(Health.CONNECTED)
        await until(lambda: arm.lives == ["made", "closing", "closed", "made"])
        assert Health.FAULTED not in [health for health, *_ in two.context.healths]


class QuickArm(Arm):
    """Lets go of the hardware at once."""

    #: How many were made.
    made: ClassVar[list[str]] = []

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context)
        self.made.append(name)


async def test_a_program_that_ends_opens_no_hardware_again(tmp_path: Path) -> None:
    """One of its drivers takes longer than the other to let go, and the session greets again."""
    QuickArm.made.clear()
    beside = OfferedDriver("hand", "arm", QuickArm, ArmSettings())
    async with slow_pair(tmp_path, [beside]) as (two, arm):
        context = RecordingContext(tmp_path)
        hand = remote_driver(context, two.router, QuickArm, name="hand")
        await hand.open()
        try:
            await two.healthy(Health.CONNECTED, context)
            bound = hand._epoch
            ending = asyncio.create_task(two.other.end())  # ctrl+c
            await until(lambda: "closing" in arm.lives)
            await until(lambda: hand._epoch not in (0, bound))
            await asyncio.sleep(0.2)
            arm.may_close.set()
            await ending
            assert QuickArm.made == ["hand"]
            assert arm.lives == ["made", "closing", "closed"]
        finally:
            arm.may_close.set()
            await hand.close()


async def test_two_greetings_at_once_do_not_wait_for_each_other(tmp_path: Path) -> None:
    async with slow_pair(tmp_path) as (two, arm):
        assert isinstance(arm.context, ServedContext)
        served = arm.context._line
        assert isinstance(served, ServedDriver)
        await two.cable.cut()
        await until(lambda: any("is stopped" in line for line in two.other.lines))
        hello = driver_messages.DriverHello(
            link=driver_messages.LINK,
            version="1",
            session="another",
            name="arm",
            type="arm",
            settings=remote_side.setting_hashes(ArmSettings()),
            offer=remote_side.offer_hash(SlowArm, ArmSettings()),
            media="",
        )
        for epoch in (1, 2):
            frame = driver_messages.FrameToDriver(served._instance, epoch, 0, hello)
            served._receive(driver_messages.encode(frame))
        await until(lambda: "closing" in arm.lives)
        arm.may_close.set()
        await until(lambda: served._epoch == 2, 10)


# -- who may ---------------------------------------------------------------------------------------


async def test_other_settings_are_refused_by_name(tmp_path: Path) -> None:
    served = ArmSettings(speed=2.0)
    async with pair(tmp_path, served=served, connected=False) as two:
        what, remedy = await two.healthy(Health.FAULTED)
        assert "speed" in what
        assert "port" not in what
        assert "copy" in remedy
        with pytest.raises(DeviceLostError):
            await two.remote.perform(LIFT)


class LaterArm(Arm):
    """What a later version offers."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return replace(
            super().offer(settings), verbs=(*super().offer(settings).verbs, Verb("throw", "throw"))
        )


async def test_another_version_of_the_driver_is_refused(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        other = remote_driver(RecordingContext(), two.router, LaterArm)
        await two.remote.close()
        await other.open()
        try:
            context = other.context
            assert isinstance(context, RecordingContext)
            assert "version" in (await two.healthy(Health.FAULTED, context))[0]
        finally:
            await other.close()


async def test_another_form_of_the_messages_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(driver_server, "LINK", driver_messages.LINK + 1)
    async with pair(tmp_path, connected=False) as two:
        what, _ = await two.healthy(Health.FAULTED)
        assert "woz-tui" in what
        with pytest.raises(DeviceLostError):
            await two.remote.perform(LIFT)


async def test_two_drivers_cannot_have_the_same_hardware(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        second, context = two.second()
        await second.open()
        try:
            assert "is used by arm" in (await two.healthy(Health.FAULTED, context))[0]
            assert await two.remote.perform(PlainJob("wave")) == {"waved": 1}
            await two.remote.close()
            await two.healthy(Health.CONNECTED, context)
        finally:
            await second.close()


async def test_a_second_session_on_this_computer_is_refused_by_name(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        context = RecordingContext()
        second = remote_driver(context, DriverRouter(two.router.listen, [PLACE]))
        await second.open()
        try:
            what, remedy = await two.healthy(Health.FAULTED, context)
            assert two.router.listen in what
            assert "listen" in remedy
        finally:
            await second.close()


async def test_two_computers_of_one_name_are_told_and_only_one_is_used(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        first = two.arm
        other = OtherComputer(Arm, ArmSettings(), tmp_path)
        await other.start(f"tcp://127.0.0.1:{two.cable.own_port}")
        try:
            await until(lambda: bool(two.context.notices))
            assert PLACE in two.context.notices[0][1]
            await two.remote.perform(PlainJob("wave"))
            assert two.arm is first
            assert first.calls
        finally:
            await other.end()


async def test_the_other_program_is_restarted_during_a_command(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        lifting = asyncio.create_task(two.remote.perform(LIFT))
        await until(lambda: bool(two.arm.under_way))
        first = two.arm
        await two.other.end()
        with pytest.raises(DeviceLostError):
            await lifting
        assert first.others == ["stop all", "close"]
        await two.other.start(f"tcp://127.0.0.1:{two.cable.own_port}")
        await two.healthy(Health.CONNECTED)
        assert two.arm is not first
        assert not two.arm.calls


class OpeningArm(Arm):
    """Remembers when it was opened, too."""

    async def open(self) -> None:
        self.others.append("open")
        await super().open()


async def test_the_other_program_is_restarted_while_the_stop_is_pressed(tmp_path: Path) -> None:
    """Whatever moves by itself waits for the release; some drivers take no stop before `open`."""
    async with pair(tmp_path, OpeningArm) as two:
        assert two.arm.others == ["open"]
        await two.remote.stop(Scope.ALL)
        await two.other.end()
        await two.healthy(Health.LOST)
        await two.other.start(f"tcp://127.0.0.1:{two.cable.own_port}")
        await two.healthy(Health.CONNECTED)
        await until(lambda: len(two.arm.others) > 2)
        assert two.arm.others == ["stop all", "open", "stop all"]
        await two.remote.resume()
        assert two.arm.others[3:] == ["resume"]


async def test_nonsense_on_the_line_moves_nothing(tmp_path: Path) -> None:
    dice = random.Random(7)
    async with pair(tmp_path) as two:
        line = await two.router.join(PLACE)
        valid = driver_messages.encode(
            driver_messages.FrameToDriver("x", 1, 1, driver_messages.Cancel(1))
        )
        for _ in range(500):  # as many as the line takes at once
            changed = bytearray(valid)
            changed[dice.randrange(len(changed))] = dice.randrange(256)
            line.send(to_key(PLACE, "arm"), bytes(changed))
            line.send(driver_line.from_key(PLACE, "arm"), dice.randbytes(dice.randrange(60)))
            if dice.random() < 0.05:
                await asyncio.sleep(0)
        assert await two.remote.perform(PlainJob("wave")) == {"waved": 1}
        await two.router.leave()


@pytest.mark.real_clock
@pytest.mark.safety
async def test_the_process_that_listens_is_begun_anew_when_it_is_killed(tmp_path: Path) -> None:
    async with pair(tmp_path) as two:
        lifting = asyncio.create_task(two.remote.perform(LIFT))
        await until(lambda: "lift" in two.arm.under_way)
        line = await two.router.join(PLACE)
        assert isinstance(line, ChildLine)
        line.kill()
        with pytest.raises(DeviceLostError, match=r"process that listens.*SIGKILL"):
            await lifting
        assert "SIGKILL" in (await two.healthy(Health.LOST))[0]
        await until(lambda: "stop all" in two.arm.others, 20)
        await two.healthy(Health.CONNECTED)
        assert await two.remote.perform(PlainJob("wave")) == {"waved": 1}
        await two.router.leave()


async def test_without_the_extra_the_driver_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "zenoh", None)
    context = RecordingContext()
    remote = remote_driver(context, DriverRouter("tcp://127.0.0.1:1", [PLACE]))
    await remote.open()
    try:
        await until(lambda: context.healths[-1][0] is Health.FAULTED)
        assert "woz-tui[remote-drivers]" in context.healths[-1][2]
    finally:
        await remote.close()
