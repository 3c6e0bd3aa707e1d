from __future__ import annotations

import msgspec
import pytest

from tests.console import scenes
from tests.console.scripted_feed import raw
from tests.replay.logs import stamped
from woz_tui.console.drawing.glyphs import ASCII, UNICODE
from woz_tui.console.link.message_feed import Incoming, Loss
from woz_tui.console.state.console_state import DONE_US, ConsoleState
from woz_tui.console.state.view_models import ButtonState
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.welcome import WelcomeSettings
from woz_tui.session.session_plan import panels_changed

NOW = scenes.NOW


def welcomed_state(*messages: Incoming, first: r.Welcome | None = None) -> ConsoleState:
    picture = ConsoleState()
    picture.apply([first or scenes.welcome()], 0)
    picture.apply(messages, 0)
    return picture


def state(picture: ConsoleState, action: str, now: int = NOW) -> ButtonState:
    for panel in picture.panels:
        for view in panel.actions:
            if view.name == action:
                return picture.button_view(panel, view, now).state
    raise AssertionError(f"no action {action}")


def requested(run: str = "a1", action: str = "Hello", t: int = NOW) -> m.ActionRequested:
    return m.ActionRequested(run=run, action=action, source="key", t=t)


def command(
    run: str = "a1", action: str = "Hello", t: int = NOW, text: str = "Hello!"
) -> m.Command:
    return m.Command(
        command=f"c-{run}",
        run=run,
        action=action,
        verb="say",
        args={"text": text},
        source="key",
        t=t,
    )


def dispatched(run: str = "a1", t: int = NOW) -> m.Dispatched:
    return m.Dispatched(command=f"c-{run}", driver="voice", latency_us=300, t=t)


def test_the_welcome_fills_the_picture() -> None:
    picture = welcomed_state()
    assert picture.plan.title == "Museum guide"
    study = picture.session.study
    assert (study.participant, study.condition, study.number) == ("P07", "warm", 3)
    assert {driver.health for driver in picture.drivers.values()} == {"connected"}
    assert picture.now(0) == NOW


def test_time_goes_on_between_messages_and_never_back_for_a_late_one() -> None:
    picture = welcomed_state()
    assert picture.now(500_000) == NOW + 500_000
    picture.apply([r.Pulse(t=NOW + 400_000)], 500_000)
    assert picture.now(500_000) == NOW + 500_000
    picture.apply([r.Pulse(t=NOW + 900_000)], 600_000)
    assert picture.now(600_000) == NOW + 900_000


def test_an_action_is_queued_then_runs_then_is_done_for_a_moment() -> None:
    picture = welcomed_state(requested())
    assert state(picture, "Hello") is ButtonState.QUEUED
    picture.apply([command(), dispatched()], 0)
    assert state(picture, "Hello") is ButtonState.RUNNING
    picture.apply([m.ActionDone(run="a1", action="Hello", t=NOW + 100)], 0)
    assert state(picture, "Hello", NOW + 100) is ButtonState.DONE
    assert state(picture, "Hello", NOW + 101 + DONE_US) is ButtonState.READY
    assert not picture.runs.active


def test_what_nobody_can_know_is_sent_and_not_done() -> None:
    before = NOW - 2 * scenes.SECOND
    picture = welcomed_state(
        *scenes.played_action("a2", "Map", before, 1),
        *scenes.played_action("a1", "Hello", NOW, None),
    )
    picture.apply([m.ActionDone(run="a1", action="Hello", evidence="timed", t=NOW + 500)], 0)
    assert state(picture, "Hello", NOW + 500) is ButtonState.SENT
    assert state(picture, "Hello", NOW + 501 + DONE_US) is ButtonState.READY
    assert {event.text: event.mark for event in picture.events} == {"Hello": "sent", "Map": "done"}
    marks = {(glyphs.sent, glyphs.done) for glyphs in (UNICODE, ASCII)}
    assert marks == {("→", "✓"), ("^", "+")}  # told apart without colours


def test_progress_tells_the_time_left_and_the_share_gone_by() -> None:
    picture = welcomed_state(
        requested(),
        command(),
        dispatched(),
        m.Progress(command="c-a1", driver="voice", expected_us=4_000_000, t=NOW),
    )
    panel, action = picture.panels[0], picture.panels[0].actions[0]
    standing = picture.button_view(panel, action, NOW + 1_000_000)
    assert standing.left_us == 3_000_000
    assert standing.share == 0.25
    late = picture.button_view(panel, action, NOW + 9_000_000)
    assert (late.left_us, late.share) == (0, 1.0)


def test_the_second_step_counts_from_its_own_beginning() -> None:
    picture = welcomed_state(
        requested(),
        command(),
        dispatched(),
        m.Progress(command="c-a1", driver="voice", expected_us=1_000_000, t=NOW),
        m.Done(command="c-a1", sent={}, latency_us=1, duration_us=1, t=NOW + 1_000_000),
        msgspec.structs.replace(command(t=NOW + 1_000_000), command="second"),
        m.Dispatched(command="second", driver="head", latency_us=1, t=NOW + 1_000_000),
        m.Progress(command="second", driver="head", expected_us=2_000_000, t=NOW + 1_000_000),
    )
    run = picture.runs.get("a1")
    assert run is not None
    assert run.timing(NOW + 2_000_000) == (1_000_000, 0.5)


def test_a_failure_stays_until_it_is_seen() -> None:
    picture = welcomed_state(
        requested(),
        command(),
        m.Failed(
            command="c-a1", driver="voice", reason="no sound card", remedy="plug it in", t=NOW
        ),
        m.ActionFailed(run="a1", action="Hello", reason="voice: no sound card", t=NOW),
    )
    later = NOW + 3_600_000_000
    assert state(picture, "Hello", later) is ButtonState.FAILED
    (failure,) = picture.runs.unseen()
    assert (failure.reason, failure.remedy) == ("voice: no sound card", "plug it in")
    picture.runs.seen.add("a1")
    assert state(picture, "Hello", later) is ButtonState.READY
    assert picture.runs.unseen() == []


def test_what_was_seen_stays_seen_when_the_line_comes_back() -> None:
    failed = scenes.played_action("a1", "Hello", NOW, 1, how="failed", reason="broken")
    picture = welcomed_state(first=scenes.welcome(recent=failed))
    assert len(picture.runs.unseen()) == 1
    picture.runs.seen.add("a1")
    picture.lose(Loss("closed"))
    picture.apply([scenes.welcome(recent=failed)], 0)
    assert picture.runs.unseen() == []
    assert picture.lost is None


def test_failures_of_a_robot_process_that_was_started_again_are_new() -> None:
    failed = scenes.played_action("a1", "Hello", NOW, 1, how="failed", reason="broken")
    picture = welcomed_state(first=scenes.welcome(recent=failed))
    picture.runs.seen.add("a1")
    picture.lose(Loss("closed"))
    again = msgspec.structs.replace(scenes.start(), clock={"wall": "an hour later"})
    picture.apply([scenes.welcome([again, *scenes.healthy()[1:]], failed)], 0)
    assert [failure.run for failure in picture.runs.unseen()] == ["a1"]


def test_a_failure_has_one_time_in_consoles_that_came_before_and_after_its_press() -> None:
    *pressed, failed = scenes.played_action(
        "a9", "Bow", NOW - 30 * scenes.SECOND, 25.0, how="failed", reason="overloaded"
    )
    first, later = ConsoleState(), ConsoleState()
    first.apply([scenes.welcome(), *pressed, failed], 0)
    later.apply([scenes.welcome([*scenes.healthy(), *pressed], []), failed], 0)
    for state in (first, later):
        (event,) = [event for event in state.events if event.mark == "failed"]
        (failure,) = state.runs.unseen()
        assert event.t == failure.t == NOW - 30 * scenes.SECOND
        assert event.took_us == 25 * scenes.SECOND


def test_a_failure_that_worked_later_gives_the_button_back_but_is_not_forgotten() -> None:
    picture = welcomed_state(
        *scenes.played_action("a1", "Hello", NOW - 90_000_000, 1, how="failed", reason="broken"),
        *scenes.played_action("a2", "Hello", NOW - 80_000_000, 1),
    )
    assert state(picture, "Hello") is ButtonState.READY
    assert len(picture.runs.unseen()) == 1


def test_refused_and_stopped_show_for_a_while() -> None:
    picture = welcomed_state(
        *scenes.played_action("a1", "Hello", NOW, 0, how="refused", reason="stale"),
        *scenes.played_action("a2", "Map", NOW, 0, how="stopped"),
    )
    assert state(picture, "Hello") is ButtonState.REFUSED
    assert state(picture, "Map") is ButtonState.STOPPED
    assert state(picture, "Hello", NOW + 60_000_000) is ButtonState.READY


def test_locked_panels_and_lost_drivers() -> None:
    picture = welcomed_state(
        m.PanelLocked(panel="Gestures", locked=True, t=NOW),
        m.DriverLost(driver="voice", detail="unplugged", t=NOW),
    )
    assert state(picture, "Nod") is ButtonState.LOCKED
    assert state(picture, "Hello") is ButtonState.UNREACHABLE
    assert state(picture, "Happy") is ButtonState.READY
    picture.apply(
        [m.PanelLocked(panel="Gestures", locked=False), m.DriverConnected(driver="voice")], 0
    )
    assert state(picture, "Nod") is ButtonState.READY
    assert state(picture, "Hello") is ButtonState.READY


def test_a_grey_button_knows_what_the_gate_says() -> None:
    """The same words as the robot process has for a press."""

    def notes(*messages: Incoming) -> list[str]:
        picture = welcomed_state(*messages)
        return [picture.button_view(panel, panel.actions[0], NOW).note for panel in picture.panels]

    titles = [panel.title for panel in welcomed_state().panels]
    assert notes(*[m.PanelLocked(panel=title, locked=False) for title in titles]) == [""] * len(
        titles
    )
    assert notes(*[m.PanelLocked(panel=title, locked=True) for title in titles]) == [
        f"the panel {title!r} is locked" for title in titles
    ]


def test_a_verb_of_two_drivers_is_reachable_while_one_is_left() -> None:
    first = msgspec.structs.replace(
        scenes.welcome(), verbs={"left": ["say"], "right": ["say"]}, drivers=["left", "right"]
    )
    picture = welcomed_state(m.DriverLost(driver="left"), first=first)
    assert state(picture, "Hello") is ButtonState.READY
    picture.apply([m.DriverLost(driver="right")], 0)
    assert state(picture, "Hello") is ButtonState.UNREACHABLE


def test_what_a_driver_cannot_do_now_is_grey_like_what_a_lost_one_cannot() -> None:
    """A servo without torque is connected, and takes no pose."""
    picture = welcomed_state(
        m.VerbsUnable(driver="voice", unable=["say"], why="the amplifier is off")
    )
    panel = next(view for view in picture.panels if any(a.name == "Hello" for a in view.actions))
    hello = next(action for action in panel.actions if action.name == "Hello")
    button_view = picture.button_view(panel, hello, NOW)
    assert (button_view.state, button_view.note) == (ButtonState.UNREACHABLE, "voice")
    picture.apply([m.VerbsUnable(driver="voice")], 0)
    assert state(picture, "Hello") is ButtonState.READY


def stop_state(picture: ConsoleState) -> object:
    """Since when, by whom, who confirmed and who did not; None: it is not latched."""
    stop = picture.session.stop
    return stop and (stop.begin, stop.source, stop.confirmed, stop.missing, stop.settled)


def test_the_stop_from_press_to_release() -> None:
    picture = welcomed_state(m.StopPressed(source="key", t=NOW))
    assert stop_state(picture) == (NOW, "key", (), (), False)
    picture.apply([m.StopConfirmed(confirmed=["head"], missing=["face"], elapsed_us=9, t=NOW)], 0)
    assert stop_state(picture) == (NOW, "key", ("head",), ("face",), True)
    picture.apply([m.StopConfirmed(confirmed=["face"], missing=[], elapsed_us=9, t=NOW)], 0)
    assert stop_state(picture) == (NOW, "key", ("head",), ("face",), True)
    picture.apply([m.StopReleased(source="key", t=NOW)], 0)
    assert picture.session.stop is None


def test_a_stop_of_driving_alone_is_an_event_and_latches_nothing() -> None:
    picture = welcomed_state(m.StopPressed(source="console-lost", scope="drive", t=NOW))
    assert picture.session.stop is None
    assert picture.events[-1].text == "Driving stopped"
    picture.apply([m.StopPressed(source="key", t=NOW)], 0)
    picture.apply([m.StopPressed(source="console-lost", scope="drive", t=NOW + 1)], 0)
    assert stop_state(picture) == (NOW, "key", (), (), False)


def test_readings_age_and_come_back() -> None:
    course: list[m.Message] = [
        scenes.reading(NOW, "distance", 1.5, driver="range", unit="m"),
        m.SensorChanged(sensor="distance", state="stale"),
        scenes.reading(NOW + 1, "distance", 1.4, driver="range"),
        m.DriverLost(driver="range"),
    ]
    first, stale, again, lost = stamped(
        ((NOW + at) / scenes.SECOND, each) for at, each in enumerate(course)
    )
    picture = welcomed_state(first)

    def is_stale(now: int) -> bool:
        sensor = picture.sensor("distance")
        assert sensor is not None
        return picture.is_stale(sensor, now)

    assert not is_stale(NOW + 1_000_000)
    assert is_stale(NOW + 5_000_000)
    picture.apply([stale], 0)
    assert is_stale(NOW)
    picture.apply([again], 0)
    assert not is_stale(NOW + 1)
    picture.apply([lost], 0)
    assert is_stale(NOW)


def test_sensors_that_go_and_come_with_their_driver_are_no_events_of_their_own() -> None:
    picture = welcomed_state(
        scenes.reading(NOW, "distance", 1.5, driver="range"), m.DriverConnected(driver="range", t=1)
    )

    def turns(state: str, at: int) -> list[str]:
        was = "stale" if state == "ok" else "ok"
        before = [*picture.events]
        picture.apply([m.SensorChanged(sensor="distance", state=state, was=was, t=at)], 0)
        return [event.text for event in picture.events if event not in before]

    assert turns("stale", NOW) == ["distance stale"], "its driver is there"
    assert turns("ok", NOW + 1) == ["distance ok"]
    picture.apply([m.DriverLost(driver="range", t=NOW + 2)], 0)
    assert turns("stale", NOW + 3) == []
    assert turns("ok", NOW + 3) == [], "a moment before its driver"
    picture.apply([m.DriverConnected(driver="range", t=NOW + 4)], 0)
    assert turns("ok", NOW + 5) == []
    assert turns("stale", NOW + 6) == ["distance stale"]
    assert turns("ok", NOW + 4_000_000) == ["distance ok"], "long after its driver"


@pytest.mark.parametrize("health", [m.DriverLost, m.DriverConnecting])
def test_why_sensors_fell_silent_takes_the_place_of_their_lines(
    health: type[m.DriverLost | m.DriverConnecting],
) -> None:
    """A robot freezes: its sensors are late before it is known. Or another one is taken."""
    picture = welcomed_state(
        scenes.reading(NOW, "battery", 0.5, driver="pepper"),
        scenes.reading(NOW, "noise", 0.5, driver="usb"),
        m.DriverConnected(driver="pepper", t=1),
        m.DriverConnected(driver="usb", t=1),
    )
    for sensor in ("battery", "noise", "touch.x"):  # nobody has touched it: whose is it?
        picture.apply([m.SensorChanged(sensor=sensor, state="stale", was="ok", t=NOW)], 0)
    assert [event.text for event in picture.events][-3:] == [
        "battery stale",
        "noise stale",
        "touch.x stale",
    ]
    picture.apply([health(driver="pepper", t=NOW + 1_100_000)], 0)
    texts = [event.text for event in picture.events]
    assert "battery stale" not in texts
    assert "touch.x stale" not in texts
    assert "noise stale" in texts, "another driver's"
    before = len(picture.events)
    sensor_changed = m.SensorChanged(sensor="touch.x", state="ok", was="stale", t=NOW + 2_000_000)
    picture.apply([sensor_changed], 0)
    assert len(picture.events) == before, "it comes back with the robot"


def test_a_sensor_of_a_robot_that_is_still_connecting_has_no_line() -> None:
    picture = welcomed_state(m.DriverConnecting(driver="ros", t=NOW - 2_000_000))
    before = [event.text for event in picture.events]
    silent = m.SensorChanged(sensor="distance", state="stale", was="", t=NOW)
    back = m.SensorChanged(sensor="distance", state="ok", was="stale", t=NOW + 500_000)
    picture.apply([silent, m.DriverConnected(driver="ros", t=NOW + 400_000), back], 0)
    assert [event.text for event in picture.events] == [*before, "ros connected"]


def test_a_silence_long_before_a_loss_keeps_its_line() -> None:
    picture = welcomed_state(
        scenes.reading(NOW, "battery", 0.5, driver="pepper"),
        m.DriverConnected(driver="pepper", t=1),
    )
    picture.apply([m.SensorChanged(sensor="battery", state="stale", was="ok", t=NOW)], 0)
    picture.apply([m.DriverLost(driver="pepper", t=NOW + 10_000_000)], 0)
    assert "battery stale" in [event.text for event in picture.events]


def test_a_mistake_stands_at_its_run() -> None:
    picture = welcomed_state(
        *scenes.played_action("a1", "Hello", NOW, 1), *scenes.played_action("a2", "Map", NOW, 1)
    )
    picture.apply([m.Mistake(run="a2", action="Map", t=NOW)], 0)
    assert [event.run for event in picture.events if event.mistake] == ["a2"]


def test_events_get_their_outcome_and_their_time() -> None:
    picture = welcomed_state(*scenes.played_action("a1", "Hello", NOW, 2))
    event = picture.events[-1]
    assert (event.text, event.mark, event.took_us) == ("Hello", "done", 2_000_000)


def test_a_typed_utterance_is_an_event_of_its_own_and_its_failure_is_kept() -> None:
    typed = m.Command(command="c9", verb="say", args={"text": "Good"}, source="key", t=NOW)
    picture = welcomed_state(typed)
    assert picture.events[-1].text == "“Good”"
    picture.apply([m.Failed(command="c9", driver="voice", reason="no voice", t=NOW)], 0)
    assert picture.events[-1].mark == "failed"
    assert [failure.reason for failure in picture.runs.unseen()] == ["voice: no voice"]
    assert not picture.runs.active


def test_state_is_taken_without_a_line_recent_with_one() -> None:
    first = scenes.welcome(
        state=[*scenes.healthy(), *scenes.played_action("a5", "Map", NOW, None)],
        recent=[m.Note(text="late", t=NOW)],
    )
    picture = welcomed_state(first=first)
    assert [event.text for event in picture.events] == ["late"]
    assert state(picture, "Map") is ButtonState.RUNNING


def test_unknown_and_broken_lines_in_a_welcome_are_passed_over() -> None:
    first = msgspec.structs.replace(
        scenes.welcome(),
        recent=[
            msgspec.Raw(b'{"kind":"from.the.future","x":1}'),
            msgspec.Raw(b'{"kind":"note"}'),
            *raw([m.Note(text="fine", t=NOW)]),
        ],
    )
    assert [event.text for event in welcomed_state(first=first).events] == ["fine"]


def test_a_reload_replaces_panels_and_keeps_what_runs() -> None:
    picture = welcomed_state(requested(), command(), dispatched())
    edition = picture.edition
    shorter = r.PanelsChanged(
        title="Guide 2",
        panels=[scenes.panels()[0]],
        script=["Hello"],
        verbs={},
        conditions=[],
        keyboard="de",
    )
    picture.apply([shorter], 0)
    assert picture.edition > edition
    assert (picture.plan.title, len(picture.panels)) == ("Guide 2", 1)
    assert state(picture, "Hello") is ButtonState.RUNNING


def test_a_reload_brings_every_setting_that_it_can_change() -> None:
    """A setting of `WelcomeSettings` has to be carried, or named here as one of the robot's."""
    of_the_robot = {"joints", "outlines", "lanes", "moves", "replay"}
    assert of_the_robot == {*WelcomeSettings.__struct_fields__} - {*r.PANEL_SETTINGS}
    settings = WelcomeSettings(
        stale_after=3.0, dead_man=9.0, abandon_after=60.0, sensors=["loudness"]
    )
    welcome = msgspec.structs.replace(scenes.welcome(), settings=settings)
    plan = m.SessionPlan(
        title="Guide",
        panels=scenes.panels(),
        script=[],
        verbs={},
        variables=["room"],
        conditions=[],
        keyboard="us",
        drivers=[],
        settings=settings,
    )
    picture = ConsoleState()
    picture.apply([welcome, panels_changed(plan)], 0)
    assert picture.settings == settings
    assert picture.plan.variables == ["room"]


def test_utterances_are_filled_with_what_holds_now() -> None:
    welcome = scenes.welcome(settings={"values": {"room": "the hall", "participant": "P00"}})
    picture = ConsoleState()
    picture.apply([welcome, m.SessionChanged(participant="P09", trial=3, t=NOW)], 0)

    assert picture.filled("{participant}, {trial}: {room} {nobody}") == "P09, 3: the hall {nobody}"


def test_a_reload_brings_the_variables_new_values() -> None:
    picture = ConsoleState()
    picture.apply([scenes.welcome()], 0)
    assert picture.filled("Look at {exhibit}") == "Look at {exhibit}"
    plan = {"title": "T", "panels": [], "script": [], "verbs": {}, "conditions": []}
    told = plan | {"keyboard": "us", "values": {"exhibit": "the whale"}}
    changed = msgspec.convert(told | {"kind": "panels"}, r.PanelsChanged)
    picture.apply([changed], 0)
    assert picture.filled("Look at {exhibit}") == "Look at the whale"
