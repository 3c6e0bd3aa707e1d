"""The client, at a real session behind a real socket."""

from __future__ import annotations

import asyncio
import itertools
import threading
import traceback
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import pytest

from tests.host.rig import ServedSession, served_session
from tests.session.test_until_arrived import SlowGazeDriver
from woz_tui import client as woz_client
from woz_tui.client import (
    WozClient,
    WozConnectionError,
    WozError,
    WozFailedError,
    WozRefusedError,
    WozStoppedError,
    WozSupersededError,
    blocking,
    connect,
)
from woz_tui.config.experiment import DriverSpec
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

#: Nothing here takes nearly as long.
PATIENCE_S = 40.0


@pytest.fixture
async def host(tmp_path: Path) -> AsyncIterator[ServedSession]:
    async with served_session(tmp_path) as served_host:
        yield served_host


async def test_saying_returns_when_it_has_been_said(host: ServedSession) -> None:
    async with connect(host.path, name="stimulus") as woz:
        done = await woz.say("Hello {participant}")
        assert done.sent == {"text": "Hello P07"}
        assert host.driver().calls == [("say", {"text": "Hello P07"})]
    [attached] = host.of(m.ConsoleAttached)
    assert (attached.role, attached.name) == ("program", "stimulus")


async def test_any_verb_is_a_method_with_its_main_argument_first(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        assert (await woz.play("nod")).sent == {"move": "nod"}
        assert (await woz.play(move="shake", driver="robot")).sent == {"move": "shake"}
        with pytest.raises(AttributeError, match="no verb 'somersault'"):
            await woz.somersault()
        with pytest.raises(WozRefusedError, match="move"):
            await woz.play("nod", "shake")
        with pytest.raises(WozError, match="fly") as unknown:
            await woz.fly()
        assert "play" in unknown.value.hint
        assert not hasattr(woz, "fly")


async def test_a_sentence_cuts_another_one_short(host: ServedSession) -> None:
    """As the page for programs says: `when_busy="replace"`."""
    async with connect(host.path) as woz:
        first = await woz.begin("say", text="A sentence that takes a while to be said")
        await woz.say("Stop", when_busy="replace", driver="robot")
        for _ in range(2):
            with pytest.raises(WozSupersededError) as replaced:
                await first
        assert len(traceback.extract_tb(replaced.value.__traceback__)) < 5


async def test_an_error_that_is_raised_again_does_not_grow(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        stream = woz.messages()
        await woz.close()
        lengths = set()
        for _ in range(50):
            for call in (woz.mark("x"), anext(stream)):
                with pytest.raises(WozConnectionError) as lost:
                    await call
                lengths.add(len(traceback.extract_tb(lost.value.__traceback__)))
    assert max(lengths) < 8


async def test_actions_are_pressed_by_name_or_key(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        assert (await woz.press("Hello")).action == "Hello"
        assert (await woz.press("w")).action == "Welcome"


@pytest.mark.parametrize(
    ("verb", "args", "reason"),
    [
        ("say", {}, "needs 'text'"),
        ("say", {"text": "x", "pitch": 3}, "no argument 'pitch'"),
        ("somersault", {}, "offers 'somersault'"),
        ("say", {"text": "{nobody}"}, "has no value"),
        ("drive", {"x": 1.0}, "no wizard"),
    ],
)
async def test_what_is_refused_raises_why(
    host: ServedSession, verb: str, args: dict[str, Any], reason: str
) -> None:
    async with connect(host.path) as woz:
        with pytest.raises(WozRefusedError, match=reason):
            await woz.perform(verb, args)
        await woz.say("It goes on")


async def test_a_failure_raises_what_failed_and_what_to_do(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        with pytest.raises(WozFailedError) as failed:
            await woz.play("fail")
        assert (failed.value.reason, failed.value.hint) == ("it fell over", "pick it up")
        with pytest.raises(WozFailedError, match="fell over"):
            await woz.press("Fall")


async def test_a_drive_stop_that_is_confirmed_meanwhile_is_no_answer_to_a_stop(
    host: ServedSession,
) -> None:
    def lost(message: m.Message) -> None:
        if isinstance(message, m.StopPressed):
            nobody = m.StopConfirmed(confirmed=[], missing=[], elapsed_us=0, scope="drive")
            host.session.hub.publish(nobody)

    host.session.hub.listen(lost)
    async with connect(host.path) as woz:
        assert (await woz.stop()).confirmed == ["robot"]


async def test_the_stop_raises_in_whoever_waits_and_is_confirmed_to_who_pressed(
    host: ServedSession,
) -> None:
    async with connect(host.path) as woz, connect(host.path) as other:
        run = await woz.begin("say", text="a long sentence")
        action = await woz.begin_action("Map")
        assert (await other.stop()).confirmed == ["robot"]
        for stopped in (run, action):
            with pytest.raises(WozStoppedError):
                await stopped
        with pytest.raises(WozRefusedError, match="stop is pressed") as refused:
            await woz.say("Hello")
        assert refused.value.code == "gate.stopped", "a program does not go by the sentence"
        await other.release()
        await woz.say("Hello")


async def test_what_is_replaced_says_so(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        run = await woz.begin("play", move="nod")
        newer = await woz.begin("play", move="shake", when_busy="replace")
        with pytest.raises(WozSupersededError):
            await run
        assert isinstance(await newer, m.Done)


async def test_giving_up_waiting_cuts_it_short(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        waiting = asyncio.create_task(woz.say("a long sentence"))
        await host.published(lambda line: isinstance(line, m.Dispatched))
        waiting.cancel()
        stopped = await host.published(lambda line: isinstance(line, m.Stopped))
        assert isinstance(stopped, m.Stopped)
        with pytest.raises(asyncio.CancelledError):
            await waiting


async def test_giving_up_in_the_moment_of_the_reply_cuts_it_short_too(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        stream = woz.messages(m.Command)
        beginning = asyncio.create_task(woz.begin("say", text="a long sentence"))
        await anext(stream)  # it comes right before the reply
        beginning.cancel()
        assert isinstance(await host.published(lambda line: isinstance(line, m.End)), m.Stopped)
        with pytest.raises(asyncio.CancelledError):
            await beginning


async def test_what_was_begun_can_be_cancelled(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        run = await woz.begin("say", text="a long sentence")
        await run.cancel()
        with pytest.raises(WozStoppedError):
            await run


async def test_messages_come_as_they_are_and_end_with_the_session(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        marks, everything = woz.messages(m.Marker), woz.messages()
        await woz.mark("onset")
        await woz.note("the phone rang")
        host.host.end("test")
        await host.session.close("test", rest=False)
        await host.host.close()
        assert [line.text async for line in marks] == ["onset"]
        kinds = [type(line) async for line in everything]
        assert kinds[0] is m.Marker
        assert kinds[-1] is m.SessionEnd


async def test_messages_can_begin_with_what_holds(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        stream = woz.messages(m.DriverConnected, held=True)
        assert (await anext(stream)).driver == "robot"


async def test_a_lost_connection_ends_every_wait(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        run, stream = await woz.begin("say", text="a long sentence"), woz.messages(m.Note)
        await host.host.close()
        with pytest.raises(WozConnectionError):
            await run
        with pytest.raises(WozConnectionError):
            await anext(stream)
        with pytest.raises(WozConnectionError):
            await woz.say("Hello")


async def test_who_leaves_reads_that_it_has_left(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        run = await woz.begin("say", text="a long sentence")
    with pytest.raises(WozConnectionError, match="connection was closed"):
        await run


async def test_where_no_session_is_it_says_so(tmp_path: Path) -> None:
    with pytest.raises(WozConnectionError, match="no session answers"):
        async with connect(tmp_path / "nobody"):
            pass


async def test_a_marker_has_the_moment_of_its_call(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        assert woz.clock_uncertainty == 0.0
        before = round(woz.now() * 1e6)
        woz.mark_soon("onset")
        after = round(woz.now() * 1e6)
        marker = await host.published(lambda line: isinstance(line, m.Marker))
        assert isinstance(marker, m.Marker)
        assert before <= marker.at <= after <= marker.t


async def test_a_marker_of_the_future_is_refused(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        with pytest.raises(WozRefusedError, match="moment"):
            await woz.request(r.AskMarker(text="x", at=round(woz.now() * 1e6) + 60_000_000))


async def test_a_gaze_returns_when_the_head_is_there(tmp_path: Path) -> None:
    made: Any = None
    async with served_session(tmp_path, catalogue={"puppet": SlowGazeDriver}) as host:
        spec: DriverSpec = host.session.experiment.drivers[0]
        made = SlowGazeDriver.offer(None).verbs
        host.session.bus.offer(spec.name, made)
        async with connect(host.path) as woz:
            looking = asyncio.create_task(woz.gaze(yaw=20.0))
            arrived = await host.published(lambda line: isinstance(line, m.MotionArrived))
            done = await looking
            assert isinstance(arrived, m.MotionArrived)
            assert arrived.command == done.command
            with pytest.raises(WozFailedError, match="neck is stuck"):
                await woz.gaze(yaw=-20.0)
            looking = asyncio.create_task(woz.gaze(yaw=100.0))
            await host.published(
                lambda line: isinstance(line, m.Done) and line.sent["yaw"] == 100.0
            )
            host.session.stop("key")
            with pytest.raises(WozStoppedError):
                await looking


async def test_it_begins_at_its_moment_or_is_refused(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        at = woz.now() + 3.0
        await woz.say("Now", at=at)
        [dispatched] = host.of(m.Dispatched)
        assert dispatched.t >= at * 1e6
        with pytest.raises(WozRefusedError, match="too late"):
            await woz.press("Hello", at=at)


async def test_what_is_foretold_comes_typed(host: ServedSession) -> None:
    async with connect(host.path) as woz:
        foretold = await woz.predict("say", text="Hello")
        assert foretold.duration_us is None
        assert [command.verb for command in foretold.commands] == ["say"]
        assert len((await woz.predict_action("Welcome")).commands) == 2


# -- without asyncio -------------------------------------------------------------------------------


async def blocked(program: Any) -> None:
    """Runs `program` in a thread, as a program without asyncio."""
    await asyncio.wait_for(asyncio.to_thread(program), PATIENCE_S)


async def test_a_marker_that_goes_nowhere_is_no_secret(host: ServedSession) -> None:
    begun, left = threading.Event(), threading.Event()

    def program() -> None:
        with blocking.connect(host.path) as woz:
            begun.set()
            with pytest.raises(WozConnectionError):
                while not left.wait(0.01):
                    woz.mark_soon("flip")
        for call in (woz.mark_soon, woz.say):
            with pytest.raises(WozConnectionError):
                call("too late")

    running = asyncio.create_task(blocked(program))
    try:
        await asyncio.to_thread(begun.wait)
        await host.session.close("test", rest=False)
        await host.host.close()
        await asyncio.wait([running], timeout=PATIENCE_S / 2)
    finally:
        left.set()
    await running


async def test_a_program_without_asyncio_has_the_same(host: ServedSession) -> None:
    def program() -> None:
        with blocking.connect(host.path) as woz:
            marks = woz.messages(m.Marker)
            woz.say("Hello")
            woz.play("nod")
            woz.press("Hello")
            woz.mark("onset")
            woz.mark_soon("flip")
            texts = [line.text for line in itertools.islice(marks, 2)]
            assert texts == ["onset", "flip"]
            with pytest.raises(WozRefusedError, match="needs 'text'"):
                woz.perform("say")
            run = woz.begin("say", text="a long sentence")
            assert run.end is None
            with pytest.raises(WozStoppedError):
                run.cancel()
                run.wait()
            assert isinstance(woz.begin_action("Hello").wait(), m.ActionDone)
            assert woz.stop().confirmed == ["robot"]

    await blocked(program)
    assert [verb for verb, _ in host.driver().calls] == [
        *("say", "play", "say", "say", "say", "stop")
    ]


async def test_leaving_ends_its_thread(host: ServedSession) -> None:
    def program() -> None:
        before = set(threading.enumerate())
        with blocking.connect(host.path) as woz:
            assert woz.welcome.title == "Made by hand"
            assert "Hello" in {action.name for panel in woz.panels for action in panel.actions}
            assert woz.clock_uncertainty == 0.0
            assert set(threading.enumerate()) > before
        assert set(threading.enumerate()) <= before
        with pytest.raises(WozConnectionError):
            blocking.connect(host.path.with_name("nobody")).__enter__()
        assert set(threading.enumerate()) <= before

    await blocked(program)


def test_every_coroutine_of_the_client_has_its_twin() -> None:
    own = {"open", "close"}
    for name, method in vars(WozClient).items():
        if asyncio.iscoroutinefunction(method) and not name.startswith("_"):
            assert name in own or hasattr(blocking.BlockingWozClient, name), name
    assert {*woz_client.__all__} >= {"connect", "WozClient", "WozError"}
