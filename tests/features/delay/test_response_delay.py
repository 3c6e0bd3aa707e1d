"""What answers a cue too soon is held until its moment; all else is not."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tests.fakes.virtual_time import LoopClock, run_virtual
from tests.host.rig import served_session
from tests.session.rig import SessionRig, experiment, with_section
from woz_tui.bus.hub import Hub
from woz_tui.config.experiment import Experiment
from woz_tui.drivers.contract import Ask, Verb
from woz_tui.features.delay.kinds import ActionHeld, ShapingChanged
from woz_tui.features.delay.response_delay import ResponseDelay, may_wait
from woz_tui.features.delay.section import SHAPING, ResponseShaping
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.system.clock import ManualClock

KEY = RequestOrigin("key", "h")
SECOND = 1_000_000


def shaped(rig: SessionRig, floor_us: int = 800_000, jitter_us: int = 0) -> None:
    shaping = ResponseShaping(floor_us / SECOND, jitter_us / SECOND, ("speech", "marker"))
    rig.session.adopt(replace(rig.session.experiment, sections={SHAPING: shaping}), [])


def visitor_stops(rig: SessionRig) -> int:
    """The visitor has just stopped; when."""
    now = rig.session.hub.now()
    rig.session.hub.publish(m.SpeechEnded(driver="ears", segment=1, began=0, ended=now))
    return now


def at(rig: SessionRig, kind: type[m.Message]) -> list[int]:
    return [line.t for line in rig.of(kind)]


@pytest.fixture
def play(tmp_path: Path) -> Callable[[Callable[[SessionRig], Awaitable[None]]], SessionRig]:
    """Runs a scene on a shaped session in virtual time; the stage afterwards."""

    def run(scene: Callable[[SessionRig], Awaitable[None]]) -> SessionRig:
        async def shaped_scene(rig: SessionRig) -> None:
            shaped(rig)
            await scene(rig)

        return SessionRig(tmp_path).run(shaped_scene)

    return run


Play = Callable[[Callable[[SessionRig], Awaitable[None]]], SessionRig]


def test_the_end_of_the_robots_own_voice_is_no_cue(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        now = rig.session.hub.now()
        own = m.SpeechEnded(driver="ears", segment=1, began=0, ended=now, own=True)
        rig.session.hub.publish(own)
        rig.session.play("Hello", KEY)
        await asyncio.sleep(0.1)
        assert rig.of(ActionHeld) == []
        assert [verb for verb, _ in rig.driver().calls] == ["say"]

    play(scene)


def test_an_answer_that_comes_too_soon_begins_at_the_floor(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        ended = visitor_stops(rig)
        await asyncio.sleep(0.2)
        rig.session.play("Hello", KEY)
        assert rig.driver().calls == []
        await asyncio.sleep(3)
        (action_held,) = (line for line in rig.of(ActionHeld))
        assert (action_held.sort, action_held.cued, action_held.until) == (
            "speech",
            ended,
            ended + 800_000,
        )
        assert at(rig, m.ActionRequested) == [action_held.t]
        assert at(rig, m.Command)[0] == pytest.approx(action_held.until, abs=100)
        assert isinstance(rig.lines[-1], m.ActionDone | m.Checkpoint | m.ClockTie)

    assert play(scene).driver().calls[0] == ("say", {"text": "Hello P07"})


def test_a_newcomer_is_told_what_is_held(play: Play) -> None:
    def standing(rig: SessionRig) -> list[str]:
        state = rig.session.state.messages()
        return [type(line).__name__ for line in state if isinstance(line, ActionHeld)]

    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        rig.session.play("Hello", KEY)
        rig.session.send("say", {"text": "typed"}, "", KEY)  # nothing to be seen before it begins
        assert standing(rig) == ["ActionHeld"]
        await asyncio.sleep(4)
        assert standing(rig) == []

    play(scene)


def test_an_answer_that_comes_late_enough_begins_at_once(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        await asyncio.sleep(0.9)
        rig.session.play("Hello", KEY)
        await asyncio.sleep(0.001)
        assert rig.driver().calls == [("say", {"text": "Hello P07"})]

    assert play(scene).kinds(ActionHeld) == []


def test_without_a_cue_nothing_is_held(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        rig.session.hub.publish(m.Marker(text="preflight: 3 checks", source="preflight"))
        rig.session.play("Hello", KEY)

    assert play(scene).kinds(ActionHeld) == []


def test_the_order_of_the_presses_is_the_order_of_the_acts(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        rig.session.play("Welcome", KEY)
        rig.session.send("say", {"text": "typed"}, "", KEY)
        visitor_stops(rig)
        rig.session.play("Hello", KEY)
        await asyncio.sleep(6)

    said = [args["text"] for verb, args in play(scene).driver().calls if verb == "say"]
    assert said == ["Welcome", "typed", "Hello P07"]


@pytest.mark.parametrize("source", ["preflight", "action"])
def test_a_marker_that_no_human_has_put_is_no_cue(play: Play, source: str) -> None:
    async def scene(rig: SessionRig) -> None:
        rig.session.hub.publish(m.Marker(text="look", source=source))
        rig.session.play("Hello", KEY)

    assert play(scene).kinds(ActionHeld) == []


def test_a_marker_delays_from_the_moment_that_its_program_measured(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        hub = rig.session.hub
        hub.publish(ShapingChanged(floor_us=SECOND, jitter_us=0, cues=["marker"]))
        await asyncio.sleep(2)
        flip = hub.now() - SECOND // 2
        hub.publish(m.Marker(text="onset", source="program", at=flip))
        rig.session.play("Hello", KEY)
        [action_held] = (line for line in rig.of(ActionHeld))
        assert (action_held.cued, action_held.until) == (flip, flip + SECOND)

    play(scene)


def test_a_marker_of_an_earlier_moment_shortens_no_delay(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        hub = rig.session.hub
        hub.publish(ShapingChanged(floor_us=SECOND, jitter_us=0, cues=["speech", "marker"]))
        await asyncio.sleep(3)
        now = visitor_stops(rig)
        hub.publish(m.Marker(text="onset", source="program", at=now - 2 * SECOND))
        rig.session.play("Hello", KEY)
        [action_held] = (line for line in rig.of(ActionHeld))
        assert (action_held.sort, action_held.until) == ("speech", now + SECOND)

    play(scene)


@pytest.mark.parametrize("listed", [True, False])
def test_what_the_model_sees_is_a_cue_if_the_file_says_so(play: Play, listed: bool) -> None:
    async def scene(rig: SessionRig) -> None:
        cues = ["engagement"] if listed else ["marker"]
        rig.session.hub.publish(ShapingChanged(floor_us=SECOND, jitter_us=0, cues=cues))
        rig.session.hub.publish(
            m.EngagementChanged(
                was="UserSpeaks", now="RobotThinks", outcome="spoken", why="", verdicts={}
            )
        )
        rig.session.play("Hello", KEY)

    assert play(scene).kinds(ActionHeld) == ["ActionHeld"] * listed


def test_a_cue_of_before_counts_no_more_when_the_settings_change(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        shaped(rig, 500_000)
        rig.session.play("Hello", KEY)

    assert play(scene).kinds(ActionHeld) == []


@pytest.mark.parametrize("how", [{"stream": True}, {"brief": True}, {"drives": True}])
def test_what_streams_is_brief_or_drives_is_no_answer(how: dict[str, bool]) -> None:
    assert may_wait(Verb("look", ""))
    assert not may_wait(Verb("look", "", **how))  # type: ignore[arg-type]


def test_waiting_for_the_moment_is_no_waiting_for_the_robot(play: Play) -> None:
    """The time limit of a command counts from when it is sent."""

    async def scene(rig: SessionRig) -> None:
        rig.session.runner.deadline = 2.0
        shaped(rig, 20 * SECOND)
        visitor_stops(rig)
        rig.session.send("say", {"text": "typed"}, "", KEY)
        rig.session.play("Hello", KEY)
        await asyncio.sleep(30)

    said = [args["text"] for verb, args in play(scene).driver().calls if verb == "say"]
    assert said == ["typed", "Hello P07"]


@pytest.mark.parametrize("source", ["engagement", "replay"])
def test_what_no_hand_asked_for_is_not_held(play: Play, source: str) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        rig.session.play("Hello", RequestOrigin(source))

    assert play(scene).kinds(ActionHeld) == []


@pytest.mark.parametrize("action", ["Go", "Cold"])
def test_driving_and_notes_to_oneself_are_not_held(play: Play, action: str) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        rig.session.play(action, KEY)

    assert play(scene).kinds(ActionHeld) == []


def test_a_stop_ends_what_is_held(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        run = rig.session.play("Hello", KEY)
        command = rig.session.send("say", {"text": "typed"}, "", KEY)
        rig.session.stop("key")
        await asyncio.sleep(1)
        rig.session.release("key")
        await asyncio.sleep(3)
        assert [line.reason for line in rig.of(m.ActionStopped) if line.run == run] == [
            "stop pressed"
        ]
        assert [line.reason for line in rig.of(m.Refused) if line.command == command] == [
            "stop pressed"
        ]

    assert not [call for call in play(scene).driver().calls if call[0] == "say"]


def test_what_is_held_can_be_cut_short(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        rig.session.cancel(rig.session.play("Hello", KEY))
        rig.session.cancel(rig.session.send("say", {"text": "typed"}, "", KEY))
        rig.session.play("Welcome", KEY)
        await asyncio.sleep(3)

    said = [args["text"] for verb, args in play(scene).driver().calls if verb == "say"]
    assert said == ["Welcome"]


def test_every_request_has_its_end_when_the_session_ends_meanwhile(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        rig.session.play("Hello", KEY)
        rig.session.send("say", {"text": "typed"}, "", KEY)

    rig = play(scene)
    assert rig.kinds(m.ActionEnd) == ["ActionStopped"]
    assert rig.kinds(m.Command, m.End) == ["Command", "Refused"]


def test_a_driver_hears_that_what_it_asked_for_never_began(play: Play) -> None:
    told: list[tuple[bool, str]] = []

    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        context = rig.driver().context
        context.ask(Ask("verb", "say", {"text": "held"}), lambda *how: told.append(how))
        await asyncio.sleep(0.1)
        assert rig.kinds(ActionHeld) == ["ActionHeld"]
        rig.session.stop("key")

    play(scene)
    assert told == [(False, "stop pressed")]


def said(
    tmp_path: Path, before: ResponseShaping | None, after: ResponseShaping | None
) -> list[tuple[int, int, list[str]]]:
    """What a session says that begins with one section, and whose file then has the other."""

    def shaped_by(shaping: ResponseShaping | None) -> Experiment:
        return replace(experiment(tmp_path), sections={SHAPING: shaping})

    async def scene(rig: SessionRig) -> None:
        rig.session.adopt(shaped_by(before), [])
        rig.session.adopt(shaped_by(after), [])

    told = SessionRig(tmp_path, made=shaped_by(before)).run(scene).of(ShapingChanged)
    return [(line.floor_us, line.jitter_us, line.cues) for line in told]


def test_the_delay_is_said_at_the_beginning_and_when_it_changes(tmp_path: Path) -> None:
    delayed = (800_000, 400_000, ["speech"])
    assert said(tmp_path, ResponseShaping(0.8, 0.4), None) == [delayed, (0, 0, [])]
    assert said(tmp_path, None, ResponseShaping(0.8, 0.4)) == [delayed]
    assert said(tmp_path, None, None) == []


def test_what_is_held_when_its_section_goes_begins_in_its_turn(tmp_path: Path) -> None:
    plain = with_section(experiment(tmp_path), SHAPING, None)

    async def scenario(rig: SessionRig) -> None:
        rig.session.hub.publish(m.Marker(text="now"))
        rig.session.play("Hello", KEY)
        rig.session.adopt(plain, [])
        rig.session.play("Welcome", KEY)
        await asyncio.sleep(0.4)
        assert rig.driver().calls == []
        await asyncio.sleep(4)

    made = with_section(plain, SHAPING, ResponseShaping(0.8, 0.0, ("marker",)))
    rig = SessionRig(tmp_path, made=made).run(scenario)
    said = [args["text"] for verb, args in rig.driver().calls if verb == "say"]
    assert said == ["Hello P07", "Welcome"]


async def test_a_newcomer_is_told_the_delay(tmp_path: Path) -> None:
    made = replace(experiment(tmp_path), sections={SHAPING: ResponseShaping(0.8, 0.4)})
    async with served_session(tmp_path, made=made) as host:
        for role, told in (
            ("watcher", {"floor": 0.8, "jitter": 0.4, "cues": ["speech"]}),
            ("participant", None),
        ):
            welcome = await (await host.connect()).hello(role)
            assert welcome["settings"]["study"]["shaping"] == told
            kinds = [line["kind"] for line in welcome["state"]]
            assert ("shaping.changed" in kinds) == (told is not None)


class _Silent:
    def record(self, message: m.Message, line: bytes) -> None: ...


def delay_on(hub: Hub, seed: int = 7) -> ResponseDelay:
    delay = ResponseDelay(hub, seed)
    hub.listen(delay.hear, *ResponseDelay.HEARS)
    return delay


@given(
    st.integers(0, 5 * SECOND),
    st.integers(0, 5 * SECOND),
    st.lists(st.tuples(st.integers(0, 3 * SECOND), st.booleans()), max_size=30),
)
@example(0, 5 * SECOND, [(0, True), (0, False)] * 10)
def test_nothing_begins_before_the_floor_and_nothing_waits_longer_than_floor_and_jitter(
    floor: int, jitter: int, course: list[tuple[int, bool]]
) -> None:
    begun: list[int] = []
    asked: list[int] = []
    announced: dict[str, int] = {}
    wrong: list[object] = []

    def see(line: m.Message) -> None:
        if isinstance(line, ActionHeld):
            announced[line.run] = line.until

    async def scene() -> None:
        hub = Hub(LoopClock(asyncio.get_running_loop()), _Silent().record)
        hub.listen(see)
        # What fails in a timer would else be told to nobody.
        asyncio.get_running_loop().set_exception_handler(lambda loop, told: wrong.append(told))
        shaper = delay_on(hub)
        hub.publish(ShapingChanged(floor_us=floor, jitter_us=jitter, cues=["marker"]))
        last = -(10**9)
        for number, (pause, is_cue) in enumerate(course):
            await asyncio.sleep(pause / 1_000_000)
            if is_cue:
                hub.publish(m.Marker(text="go"))
                last = hub.now()
                continue
            asked.append(number)
            now, cue = hub.now(), last

            def begin(number: int = number, now: int = now, cue: int = cue) -> None:
                begun.append(number)
                assert hub.now() >= cue + floor
                assert hub.now() == pytest.approx(announced[f"r{number}"], abs=100)
                assert hub.now() <= max(now, cue + floor + jitter) + floor + jitter + 100

            if not shaper.hold(f"r{number}", "x", "key", begin):
                assert now >= last + floor
                begun.append(number)
        await asyncio.sleep(60)

    run_virtual(scene())
    assert wrong == []
    assert begun == asked


def held_by(scene: Callable[[Hub, ResponseDelay], Awaitable[None]]) -> None:
    """Runs a scene on a shaper alone, whose cues are markers."""

    async def whole() -> None:
        hub = Hub(LoopClock(asyncio.get_running_loop()), _Silent().record)
        await scene(hub, delay_on(hub))
        await asyncio.sleep(60)

    run_virtual(whole())


def cued(hub: Hub, floor: float) -> None:
    floor_us = round(floor * SECOND)
    hub.publish(ShapingChanged(floor_us=floor_us, jitter_us=0, cues=["marker"]))
    hub.publish(m.Marker(text="go"))


def test_what_was_dropped_keeps_nothing_waiting() -> None:
    begun: list[int] = []

    async def scene(hub: Hub, shaper: ResponseDelay) -> None:
        cued(hub, 30)
        assert shaper.hold("r1", "x", "key", lambda: begun.append(-1))
        shaper.drop("r1")
        cued(hub, 2)
        assert shaper.hold("r2", "x", "key", lambda: begun.append(hub.now()))

    held_by(scene)
    assert begun == [pytest.approx(2 * SECOND, abs=100)]


def test_nothing_waits_behind_what_was_held_and_has_been_replaced(play: Play) -> None:
    async def scene(rig: SessionRig) -> None:
        visitor_stops(rig)
        rig.session.play("Map", KEY)
        rig.session.cancel(rig.session.play("Welcome", KEY))
        shaped(rig, 0)
        rig.session.play("Hello", KEY)
        await asyncio.sleep(0.001)
        assert rig.driver().calls == [("say", {"text": "Hello P07"})]

    assert play(scene).kinds(m.ActionSuperseded) == ["ActionSuperseded"]


def test_nothing_passes_what_is_held_where_the_file_holds_nothing_any_more() -> None:
    begun: list[str] = []

    async def scene(hub: Hub, shaper: ResponseDelay) -> None:
        cued(hub, 2)
        assert shaper.hold("r1", "x", "key", lambda: begun.append("r1"))
        hub.publish(ShapingChanged(floor_us=0, jitter_us=0, cues=[]))
        assert shaper.hold("r2", "x", "key", lambda: begun.append("r2"))

    held_by(scene)
    assert begun == ["r1", "r2"]


def test_nothing_passes_what_is_held_and_whose_moment_has_just_come() -> None:
    begun: list[str] = []

    async def whole() -> None:
        clock = ManualClock()
        hub = Hub(clock, _Silent().record)
        shaper = delay_on(hub)
        cued(hub, 2)
        assert shaper.hold("r1", "x", "key", lambda: begun.append("r1"))
        clock.advance(2.1)  # the loop has had no turn yet
        assert shaper.hold("r2", "x", "key", lambda: begun.append("r2"))
        await asyncio.sleep(60)
        assert not shaper.hold("r3", "x", "key", lambda: begun.append("r3"))

    run_virtual(whole())
    assert begun == ["r1", "r2"]


def test_one_that_cannot_begin_does_not_keep_those_behind_it() -> None:
    begun: list[int] = []

    def broken() -> None:
        raise ValueError("it cannot")

    async def scene(hub: Hub, shaper: ResponseDelay) -> None:
        asyncio.get_running_loop().set_exception_handler(lambda loop, context: None)
        cued(hub, 2)
        assert shaper.hold("r1", "x", "key", broken)
        assert shaper.hold("r2", "x", "key", lambda: begun.append(hub.now()))

    held_by(scene)
    assert begun == [pytest.approx(2 * SECOND, abs=100)]


def test_the_same_seed_gives_the_same_moments() -> None:
    def moments(seed: int) -> list[int]:
        found: list[int] = []

        async def scene() -> None:
            hub = Hub(LoopClock(asyncio.get_running_loop()), _Silent().record)
            hub.listen(
                lambda line: found.append(line.until) if isinstance(line, ActionHeld) else None
            )
            shaper = delay_on(hub, seed)
            hub.publish(ShapingChanged(floor_us=SECOND, jitter_us=SECOND, cues=["marker"]))
            for number in range(5):
                hub.publish(m.Marker(text="go"))
                shaper.hold(f"r{number}", "x", "key", lambda: None)
                await asyncio.sleep(5)

        run_virtual(scene())
        return found

    assert moments(3) == moments(3) != moments(4)
    assert all(a < b for a, b in itertools.pairwise(moments(3)))
