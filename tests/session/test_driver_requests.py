"""Drivers that ask the session, share feeds, and stir again after the stop."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import pytest

from tests.fakes.virtual_time import LoopClock
from tests.session.rig import HERE, NoSettings, ScriptedDriver, SessionRig, experiment
from woz_tui.config.experiment import DriverSpec
from woz_tui.drivers.contract import Ask, Health, Offer, PassiveDriver, Scope
from woz_tui.drivers.feeds import Feeds
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import FaceShown
from woz_tui.protocol.refusal import RequestError


class SelfMovingDriver(ScriptedDriver):
    """A puppet that moves by itself."""

    async def resume(self) -> None:
        self.calls.append(("resume", {}))
        if self.name == "broken":
            raise OSError("it cannot")


def on_stage(
    tmp_path: Path,
    scenario: Callable[[SessionRig], Awaitable[None]],
    *drivers: str,
    kind: type[ScriptedDriver] = ScriptedDriver,
) -> SessionRig:
    rig = SessionRig(tmp_path, drivers or ("robot",), catalogue={"puppet": kind})
    return rig.run(scenario, 5)


class RequestOutcome:
    """Hears how an ask ended."""

    def __init__(self) -> None:
        self.told: list[tuple[bool, str]] = []
        self.threads: set[int] = set()

    def __call__(self, carried: bool, why: str) -> None:
        self.told.append((carried, why))
        self.threads.add(threading.get_ident())


def from_a_thread(
    rig: SessionRig, ask: Ask, outcome: RequestOutcome, driver: str = "robot"
) -> None:
    """Ask as a driver's own thread does, and wait until it has asked."""
    thread = threading.Thread(target=rig.driver(driver).context.ask, args=(ask, outcome))
    thread.start()
    thread.join()


@pytest.mark.toolkit("K3")
def test_a_verb_asked_for_in_a_thread_is_a_command_like_any_other(tmp_path: Path) -> None:
    outcome = RequestOutcome()

    async def scenario(rig: SessionRig) -> None:
        from_a_thread(rig, Ask("verb", "say", {"text": "Hi"}, source="midi", key="knob 1"), outcome)

    rig = on_stage(tmp_path, scenario)
    assert ("say", {"text": "Hi"}) in rig.driver().calls
    [command] = rig.of(m.Command)
    assert (command.source, command.key) == ("midi", "knob 1")
    assert outcome.told == [(True, "")]
    assert outcome.threads == {threading.get_ident()}


def test_an_action_a_mark_and_the_stop(tmp_path: Path) -> None:
    ears = [RequestOutcome() for _ in range(4)]

    async def scenario(rig: SessionRig) -> None:
        asks = [
            Ask("action", "Map", source="midi"),
            Ask("mark", "a smile", source="midi"),
            Ask("stop", source="midi"),
            Ask("release", source="midi"),
        ]
        for ask, outcome in zip(asks, ears, strict=True):
            from_a_thread(rig, ask, outcome)
            await asyncio.sleep(2)

    rig = on_stage(tmp_path, scenario)
    requested = rig.of(m.ActionRequested)
    assert [(line.action, line.source) for line in requested] == [("Map", "midi")]
    assert [line.text for line in rig.of(m.Marker)] == ["map", "a smile"]
    assert rig.kinds(m.StopPressed, m.StopReleased) == ["StopPressed", "StopReleased"]
    assert [outcome.told for outcome in ears] == [[(True, "")]] * 4


@pytest.mark.parametrize(
    "ask",
    [
        Ask("action", "Map", source="midi"),
        Ask("verb", "play", {"move": "nod"}, source="midi", key="knob 1"),
        Ask("release", source="midi", key="button 3"),
    ],
)
def test_a_hand_on_a_panel_counts_as_old_as_the_process_stood_still(
    tmp_path: Path, ask: Ask
) -> None:
    outcome = RequestOutcome()

    async def scenario(rig: SessionRig) -> None:
        assert isinstance(rig.session.clock, LoopClock)
        await asyncio.sleep(1)
        rig.session.stop("test")
        rig.session.clock.stood_still_us += 5_000_000
        from_a_thread(rig, ask, outcome)  # it reads late what waited in its port
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert rig.session.bus.latched

    rig = on_stage(tmp_path, scenario)
    [(carried, why)] = outcome.told
    assert not carried
    assert "too late" in why
    assert {verb for verb, _ in rig.driver().calls} <= {"stop", "close"}
    logged = [
        getattr(line, "reason", "") or getattr(line, "text", "")
        for line in rig.of(m.ActionRefused, m.Refused, m.Notice)
    ]
    assert any("too late" in text for text in logged)


def test_the_stop_of_a_panel_and_what_a_body_asks_for_by_itself_are_never_too_old(
    tmp_path: Path,
) -> None:
    ears = [RequestOutcome(), RequestOutcome()]

    async def scenario(rig: SessionRig) -> None:
        assert isinstance(rig.session.clock, LoopClock)
        rig.session.clock.stood_still_us += 5_000_000
        from_a_thread(rig, Ask("verb", "say", {"text": "Hi"}), ears[0])
        await asyncio.sleep(1.5)
        rig.session.clock.stood_still_us += 5_000_000
        from_a_thread(rig, Ask("stop", source="midi", key="button 1"), ears[1])
        await asyncio.sleep(1)
        assert rig.session.bus.latched

    on_stage(tmp_path, scenario)
    assert [outcome.told for outcome in ears] == [[(True, "")]] * 2


@pytest.mark.parametrize(
    ("ask", "why"),
    [
        (Ask("verb", "fly"), "no driver offers 'fly'"),
        (Ask("verb", "say", on="nobody"), "no driver 'nobody' offers 'say'"),
        (Ask("action", "Helo"), "there is no action 'Helo'"),
        (Ask("action", "Never"), "'Never' is locked"),
        (Ask("applause"), "a driver cannot ask for 'applause'"),
        (Ask("release"), "the stop is not pressed"),
    ],
)
def test_what_cannot_be_done_is_told_to_who_asked(tmp_path: Path, ask: Ask, why: str) -> None:
    outcome = RequestOutcome()

    async def scenario(rig: SessionRig) -> None:
        from_a_thread(rig, ask, outcome)

    on_stage(tmp_path, scenario)
    assert outcome.told == [(False, why)]


def test_an_ask_that_makes_no_sense_at_all_is_answered(tmp_path: Path) -> None:
    """A driver of a stranger may put anything into an ask; whoever asked waits for an answer."""
    odd: Any = 5
    outcome, after = RequestOutcome(), RequestOutcome()

    async def scenario(rig: SessionRig) -> None:
        from_a_thread(rig, Ask("verb", "say", odd), outcome)
        await asyncio.sleep(1)
        from_a_thread(rig, Ask("verb", "say", {"text": "Hi"}), after)

    on_stage(tmp_path, scenario)
    [(carried, why)] = outcome.told
    assert not carried
    assert "TypeError" in why
    assert after.told == [(True, "")]


def test_the_stop_ends_what_was_asked_for_and_tells_so(tmp_path: Path) -> None:
    outcome = RequestOutcome()

    async def scenario(rig: SessionRig) -> None:
        from_a_thread(rig, Ask("verb", "say", {"text": "Hi"}), outcome)
        await asyncio.sleep(0.3)
        rig.session.stop("key")

    on_stage(tmp_path, scenario)
    [(carried, why)] = outcome.told
    assert not carried
    assert "stop" in why


@pytest.mark.toolkit("U1")
def test_two_robots_keep_to_themselves(tmp_path: Path) -> None:
    robots = ("joy.body", "joy.panel", "grim.body", "grim.panel")

    async def scenario(rig: SessionRig) -> None:
        for robot in ("joy", "grim"):
            text = {"text": f"I am {robot}"}
            ask = Ask("verb", "say", text, on="body", source="midi")
            from_a_thread(rig, ask, RequestOutcome(), f"{robot}.panel")
            await asyncio.sleep(2)

    rig = on_stage(tmp_path, scenario, *robots)
    assert ("say", {"text": "I am joy"}) in rig.driver("joy.body").calls
    assert ("say", {"text": "I am grim"}) in rig.driver("grim.body").calls
    said = [driver for driver in robots for call in rig.driver(driver).calls if call[0] == "say"]
    assert said == ["joy.body", "grim.body"]


# -- the stop's release ---------------------------------------------------------------------------


@pytest.mark.toolkit("M3", "U4")
def test_the_release_lets_drivers_stir_again_and_one_that_fails_is_named(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.stop("key")
        await asyncio.sleep(1)
        rig.session.release("key", known=["broken"])

    rig = on_stage(tmp_path, scenario, "robot", "broken", kind=SelfMovingDriver)
    calls = [name for name, _ in rig.driver().calls]
    assert calls.index("stop") < calls.index("resume")
    notices = [line.text for line in rig.of(m.Notice)]
    assert "broken: resume failed: it cannot" in notices


def test_who_does_not_know_who_may_still_move_does_not_release_the_stop(tmp_path: Path) -> None:
    ears = [RequestOutcome(), RequestOutcome(), RequestOutcome()]

    async def scenario(rig: SessionRig) -> None:
        session, release = rig.session, Ask("release", source="midi")
        session.stop("key")
        from_a_thread(rig, release, ears[0])  # before anybody has confirmed
        await asyncio.sleep(2)
        from_a_thread(rig, release, ears[1])
        await asyncio.sleep(1)
        assert session.bus.latched
        with pytest.raises(RequestError, match="not confirmed by broken, which"):
            session.release("key", known=["robot"])
        session.release("key", known=["broken"])
        session.stop("key")
        await asyncio.sleep(2)
        rig.driver("broken").context.health(Health.CONNECTED)  # is stopped again, and confirms
        await asyncio.sleep(2)
        from_a_thread(rig, release, ears[2])
        await asyncio.sleep(1)

    on_stage(tmp_path, scenario, "robot", "broken")
    (early,), (alone,), (all_confirmed,) = (outcome.told for outcome in ears)
    assert "by robot, broken, which may still move" in early[1]
    assert "by broken, which may still move" in alone[1]
    assert all_confirmed == (True, "")


class UnpluggedSonar(PassiveDriver):
    """Is unplugged, and cannot take a stop."""

    Settings = NoSettings
    summary = "for tests"
    heard: ClassVar[list[str]] = []

    async def open(self) -> None:
        self.context.health(Health.LOST, "unplugged")

    async def stop(self, scope: Scope) -> None:
        self.heard.append(scope.value)
        raise OSError("no such device")


def test_what_neither_moves_nor_sounds_need_not_confirm_a_stop(tmp_path: Path) -> None:
    UnpluggedSonar.heard.clear()
    outcome = RequestOutcome()

    async def scenario(rig: SessionRig) -> None:
        rig.session.stop("key")
        await asyncio.sleep(2)
        from_a_thread(rig, Ask("release", source="midi"), outcome)

    made = experiment(tmp_path)
    sonar = DriverSpec("sonar", "sonar", NoSettings(), Offer(), HERE)
    catalogue = {"puppet": ScriptedDriver, "sonar": UnpluggedSonar}
    made = replace(made, drivers=(*made.drivers, sonar))
    rig = SessionRig(tmp_path, catalogue=catalogue, made=made).run(scenario, 1)
    (stop_confirmed,) = rig.of(m.StopConfirmed)
    assert (stop_confirmed.confirmed, stop_confirmed.missing, stop_confirmed.unreached) == (
        ["robot"],
        [],
        [],
    )
    assert UnpluggedSonar.heard == ["all"]
    assert outcome.told == [(True, "")]


def test_a_driver_that_does_not_move_by_itself_needs_no_resume(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.stop("key")
        await asyncio.sleep(1)
        rig.session.release("key")

    rig = on_stage(tmp_path, scenario)
    assert "resume" not in [name for name, _ in rig.driver().calls]


# -- feeds and what is shown ----------------------------------------------------------------------


@pytest.mark.toolkit("U1")
def test_drivers_of_one_robot_share_feeds_and_those_of_two_do_not(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        context = {name: rig.driver(name).context for name in rig.session.drivers}
        feed = context["joy.servos"].feed("setpoints", of="body")
        assert feed.latest().serial == 0
        context["joy.body"].feed("setpoints").put({"pan": 10.0})
        context["grim.body"].feed("setpoints").put({"pan": -10.0})
        assert (feed.latest().serial, feed.latest().value) == (1, {"pan": 10.0})
        assert context["joy.body"].feed("face").latest().value is None

    on_stage(tmp_path, scenario, "joy.body", "joy.servos", "grim.body")


def test_many_threads_may_write_a_feed_and_every_value_is_counted() -> None:
    feed = Feeds().feed("body", "setpoints")

    def write() -> None:
        for number in range(500):
            feed.put(number)

    writers = [threading.Thread(target=write) for _ in range(4)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert feed.latest().serial == 2000


@pytest.mark.toolkit("F1")
def test_what_a_driver_shows_bears_its_name_and_stands_in_the_welcome(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        context = rig.driver().context
        face = FaceShown(width=8, rows="00 ff", emotion="happy", intensity=1.0)
        context.show(face)
        context.show(m.ControlsMoved(values={"pitch": 1}))
        context.show(m.ControlsMoved(values={"tempo": 2}, waiting=["tempo"]))
        context.show(m.BodyChanged(values={"mode": "normal"}))

    rig = on_stage(tmp_path, scenario)
    held = {type(each): each for each in rig.session.state.messages() if isinstance(each, m.Shown)}
    face, controls = held[FaceShown], held[m.ControlsMoved]
    assert isinstance(face, FaceShown)
    assert isinstance(controls, m.ControlsMoved)
    assert (face.driver, face.rows) == ("robot", "00 ff")
    assert (controls.values, controls.waiting) == ({"pitch": 1, "tempo": 2}, ["tempo"])
    assert m.BodyChanged in held
