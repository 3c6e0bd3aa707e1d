from __future__ import annotations

import pytest

from tests.replay.logs import SECOND, START, Viewer, distance, recording_of, stamped, story
from woz_tui.console.state.view_models import ButtonState
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.replay.player import REFUSED, UNCODED, UNMOVED, ReplayStart


def viewer(**start: object) -> Viewer:
    return Viewer(recording_of(story()), ReplayStart(**start))  # type: ignore[arg-type]


def test_it_begins_with_a_welcome_of_its_own_role() -> None:
    replay_viewer = viewer()
    first = replay_viewer.messages[0]
    assert isinstance(first, r.Welcome)
    assert (first.role, first.title, first.t) == ("replay", "Museum guide", 0)
    assert replay_viewer.state.replay is not None
    assert replay_viewer.state.replay.length_us == 60 * SECOND
    assert [place.sort for place in replay_viewer.state.replay.places] == [
        *("marker", "mistake", "stop", "note", "trial", "end"),
    ]


def test_lines_come_in_order_and_when_they_are_due() -> None:
    replay_viewer = viewer()
    replay_viewer.kinds()
    replay_viewer.wait(2.9, ticks=29)
    assert replay_viewer.kinds() == ["clock", "driver.connected", "session.plan"]
    replay_viewer.wait(0.1)
    assert replay_viewer.kinds() == ["action.requested", "command.requested", "command.dispatched"]
    replay_viewer.wait(3)
    assert replay_viewer.kinds() == ["command.done", "action.done", "marker"]
    assert replay_viewer.state.now(replay_viewer.now) == 6 * SECOND


def test_the_same_comes_whatever_the_speed() -> None:
    slow, fast = viewer(speed=0.25), viewer(speed=16)
    slow.wait(240.5, ticks=900)
    fast.wait(4, ticks=40)
    assert slow.kinds() == fast.kinds()
    assert slow.visible_state == fast.visible_state
    assert slow.player.ended
    assert fast.state.ended == "wizard"


def test_samples_come_thinned_between_the_lines() -> None:
    replay_viewer = viewer()
    replay_viewer.wait(10)
    told = [each for each in replay_viewer.messages if isinstance(each, m.Reading)]
    assert [reading.t for reading in told] == [10 * SECOND]
    assert distance(replay_viewer).t == 10 * SECOND


def test_nothing_runs_on_while_it_stands_still() -> None:
    replay_viewer = viewer()
    replay_viewer.wait(9)
    running = replay_viewer.state.button_view(
        *_action(replay_viewer, "Go"), replay_viewer.state.now(replay_viewer.now)
    )
    assert running.state is ButtonState.RUNNING
    assert replay_viewer.do("pause").ok
    replay_viewer.wait(600, ticks=7)
    assert replay_viewer.state.now(replay_viewer.now) == 9 * SECOND
    assert not replay_viewer.state.is_stale(
        distance(replay_viewer), replay_viewer.state.now(replay_viewer.now)
    )
    assert replay_viewer.do("pause").ok
    replay_viewer.wait(3)
    assert replay_viewer.state.now(replay_viewer.now) == 12 * SECOND
    assert (
        replay_viewer.state.button_view(
            *_action(replay_viewer, "Go"), replay_viewer.state.now(replay_viewer.now)
        ).state
        is ButtonState.DONE
    )


def _action(replay_viewer: Viewer, name: str) -> tuple[PanelView, ActionView]:
    (panel,) = replay_viewer.state.panels
    return panel, next(action for action in panel.actions if action.name == name)


def test_the_speed_doubles_and_halves_within_its_limits() -> None:
    replay_viewer = viewer()
    for rate in (2.0, 4.0, 8.0, 16.0):
        assert replay_viewer.do("faster").ok
        assert replay_viewer.state.rate == rate
    reply = replay_viewer.do("faster")
    assert not reply.ok
    replay_viewer.wait(1)
    assert replay_viewer.player.t == 16 * SECOND
    for _ in range(6):
        assert replay_viewer.do("slower").ok
    assert not replay_viewer.do("slower").ok
    assert replay_viewer.player.rate == 0.25
    replay_viewer.wait(4)
    assert replay_viewer.player.t == 17 * SECOND


def test_a_step_goes_to_the_next_line_that_says_something() -> None:
    replay_viewer = viewer(paused=True)
    steps = []
    while (reply := replay_viewer.do("step")).ok:
        assert isinstance(reply.data, dict)
        steps.append(reply.data["kind"])
        assert replay_viewer.state.now(replay_viewer.now) == reply.data["t"]
    lines = [
        m for m in story() if m.__struct_config__.tag not in ("sample", "clock", "session.plan")
    ]
    assert steps == [line.__struct_config__.tag for line in lines][1:]
    assert "no more lines" in reply.reason
    assert replay_viewer.state.ended == "wizard"


def test_a_step_shows_one_line_only_also_where_several_have_one_time() -> None:
    replay_viewer = viewer(paused=True, at_us=2_900_000)
    replay_viewer.kinds()
    replay_viewer.do("step")
    assert replay_viewer.kinds() == ["action.requested"]
    replay_viewer.do("step")
    assert replay_viewer.kinds() == ["command.requested"]
    assert replay_viewer.player.paused


def test_going_on_after_a_step_leaves_nothing_out() -> None:
    replay_viewer = viewer(at_us=2_900_000)
    replay_viewer.do("step")
    replay_viewer.kinds()
    replay_viewer.do("pause")
    replay_viewer.wait(0)
    assert replay_viewer.kinds() == ["command.requested", "command.dispatched"]


def test_a_step_stands_still_there() -> None:
    replay_viewer = viewer(at_us=2_900_000)
    replay_viewer.do("step")
    replay_viewer.wait(600)
    assert (replay_viewer.player.t, replay_viewer.player.paused) == (3 * SECOND, True)


def test_what_is_asked_is_done_at_the_moment_at_which_it_is_asked() -> None:
    """What has become due since the last look at the time comes before the reply."""
    replay_viewer = viewer()
    replay_viewer.now = 6 * SECOND
    replay_viewer.kinds()
    replay_viewer.do("pause")
    assert replay_viewer.kinds()[-1] == "marker"
    assert replay_viewer.player.t == 6 * SECOND


def test_samples_and_lines_come_in_the_order_of_their_numbers() -> None:
    messages = stamped(
        [
            (0, START),
            (1, m.reading("distance", 1.0)),
            (2, m.Marker(text="between")),
            (3, m.reading("loudness", 0.1)),
            (4, m.reading("distance", 2.0)),
            (5, m.Marker(text="after")),
            (6, m.reading("presence", 1.0)),
            (9, m.Marker()),
        ]
    )
    replay_viewer = Viewer(recording_of(messages))
    replay_viewer.messages = []
    replay_viewer.wait(7)
    told = [each for each in replay_viewer.messages if isinstance(each, m.Message)]
    assert [each.seq for each in told] == [2, 3, 4, 5, 6]


def test_seeking_begins_anew_with_everything_that_held() -> None:
    replay_viewer = viewer()
    replay_viewer.go(16)
    assert replay_viewer.state.session.stop is not None
    assert replay_viewer.state.session.stop.confirmed == ("robot",)
    assert [event.run for event in replay_viewer.state.events if event.mistake] == ["a2"]
    assert replay_viewer.do("seek", by_s=-7.0).ok
    assert replay_viewer.visible_state["stop"] is None
    assert list(replay_viewer.state.runs.active) == ["a2"]
    assert replay_viewer.do("seek", by_s=-600.0).ok
    assert replay_viewer.player.t == 0
    assert replay_viewer.do("seek", by_s=600.0).ok
    assert replay_viewer.player.ended


@pytest.mark.parametrize(
    ("to", "seconds"),
    [
        ("0:06", 6),
        ("0:00:06.5", 6.5),
        ("6", 6),
        ("smile", 6),
        ("SMI", 6),
        ("start", 0),
        ("end", 60),
    ],
)
def test_one_goes_to_times_and_to_what_marks_say(to: str, seconds: float) -> None:
    replay_viewer = viewer(at_us=30 * SECOND)
    assert replay_viewer.do("go", to=to).ok
    assert replay_viewer.player.t == seconds * SECOND


@pytest.mark.parametrize(
    ("to", "reason"), [("2:00", "01:00 long"), ("grimace", "no 'grimace'"), (" ", "there is no")]
)
def test_a_place_that_is_not_there_is_said(to: str, reason: str) -> None:
    replay_viewer = viewer(at_us=30 * SECOND)
    reply = replay_viewer.do("go", to=to)
    assert not reply.ok
    assert reason in reply.reason
    assert replay_viewer.player.t == 30 * SECOND


def test_a_mark_of_many_names_the_next_one() -> None:
    marks = stamped([(n * 10.0, m.Marker(text="smile")) for n in range(4)])
    replay_viewer = Viewer(recording_of(marks), ReplayStart(at_us=15 * SECOND))
    for seconds in (20, 30, 0):
        replay_viewer.do("go", to="smile")
        assert replay_viewer.player.t == seconds * SECOND


def test_at_the_end_it_stands_and_goes_on_from_where_one_goes_back() -> None:
    replay_viewer = viewer()
    replay_viewer.wait(100)
    assert replay_viewer.state.replay is not None
    assert replay_viewer.state.replay.ended
    assert replay_viewer.state.rate == 0
    reply = replay_viewer.do("pause")
    assert not reply.ok
    assert "home" in reply.hint
    replay_viewer.do("seek", by_s=-5.0)
    replay_viewer.wait(1)
    assert replay_viewer.player.t == 56 * SECOND


def test_idle_stretches_are_cut_and_the_cut_is_told() -> None:
    replay_viewer = viewer(max_idle_us=4 * SECOND)
    replay_viewer.go(18)
    replay_viewer.wait(2.9)
    assert replay_viewer.player.t == pytest.approx(20.9 * SECOND)
    replay_viewer.wait(0.2)
    assert replay_viewer.player.t == 49 * SECOND  # a second before the note that ends the stretch
    assert replay_viewer.state.replay is not None
    # 3 of 4 s are shown before the cut, 1 s after it.
    assert replay_viewer.state.replay.cut_us == 28 * SECOND
    replay_viewer.wait(1.5)
    assert "comes back" in [event.text for event in replay_viewer.state.events]


def test_arrows_walk_over_a_cut_in_both_directions() -> None:
    replay_viewer = viewer(max_idle_us=4 * SECOND)
    replay_viewer.go(19)
    replay_viewer.do("seek", by_s=5.0)
    assert replay_viewer.player.t == 52 * SECOND
    replay_viewer.do("seek", by_s=-5.0)
    assert replay_viewer.player.t == 19 * SECOND


def test_samples_alone_do_not_keep_a_stretch() -> None:
    timed = [(0.0, m.Marker()), (60.0, m.Marker())]
    readings = [(n / 10, m.reading("distance", 1.0)) for n in range(1, 600)]
    replay_viewer = Viewer(
        recording_of(stamped(sorted([*timed, *readings], key=lambda pair: pair[0]))),
        ReplayStart(max_idle_us=2 * SECOND),
    )
    replay_viewer.wait(2)
    assert replay_viewer.player.t > 58 * SECOND


@pytest.mark.parametrize(
    "request_",
    [
        r.AskAction(action="Hello"),
        r.AskVerb(verb="say", args={"text": "x"}),
        AskScript(),
        r.AskMarker(),
        r.AskNote(text="x"),
        r.AskMistake(),
        r.AskSet(trial=3),
        r.AskEnd(),
        r.AskReload(),
        r.AskKeepTyped(),
        r.AskPreflight(),
    ],
)
def test_whatever_else_is_asked_is_refused(request_: r.Request) -> None:
    reply = viewer().ask(request_)
    assert not reply.ok
    assert reply.reason in (REFUSED, UNCODED)


@pytest.mark.parametrize("request_", [r.AskStop(source="key"), r.AskRelease()])
def test_there_is_nothing_to_stop(request_: r.Request) -> None:
    reply = viewer().ask(request_)
    assert (reply.ok, reply.reason) == (False, UNMOVED)


def test_what_is_missing_is_told_at_the_beginning_and_stays_known() -> None:
    replay_viewer = Viewer(recording_of(story()), notes=("3 damaged line(s) left out",))
    assert "3 damaged line(s)" in replay_viewer.state.events[-1].text
    replay_viewer.go(10)
    told = replay_viewer.state.settings.replay
    assert told
    assert told.notes == ["3 damaged line(s) left out"]


def test_an_empty_reel_is_at_its_end() -> None:
    replay_viewer = Viewer(recording_of([]))
    assert replay_viewer.player.ended
    assert not replay_viewer.do("step").ok
    assert replay_viewer.do("seek", by_s=5.0).ok
    assert not replay_viewer.do("go", to="1").ok
