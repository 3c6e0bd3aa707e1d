from __future__ import annotations

from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import engagement_scene, scenes
from woz_tui.console.drawing.cells import Row, length
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, PaintFrame
from woz_tui.console.drawing.number_text import decibels, seconds, time_left
from woz_tui.console.link.message_feed import Loss, LostPart
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.bottom_rows import BarInfo, News, bar_rows
from woz_tui.console.widgets.event_list import event_rows, listed_events
from woz_tui.console.widgets.meters import meter_rows
from woz_tui.console.widgets.status_rows import StatusInfo, status_rows
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.sensing.sample_values import zone
from woz_tui.system.text_cleaning import elapsed

NOW = scenes.NOW
FRAME = PaintFrame(50, 30, NOW)


def console_state(*messages: m.Message, first: list[m.Message] | None = None) -> ConsoleState:
    picture = ConsoleState()
    picture.apply([scenes.welcome(state=first), *messages], 0)
    return picture


def text(rows: list[Row]) -> str:
    return "\n".join("".join(piece for piece, _ in row) for row in rows)


def meters(*messages: m.Message, frame: PaintFrame = FRAME) -> str:
    return text(meter_rows(console_state(*messages), frame))


@pytest.mark.parametrize(
    ("metres", "name"),
    [(0.3, "intimate"), (0.44, "intimate"), (0.9, "personal"), (2.0, "social"), (4.0, "public")],
)
def test_halls_zones(metres: float, name: str) -> None:
    assert zone(metres) == name
    assert f"{metres:.2f} m {name}" in meters(scenes.reading(NOW, "distance", metres))


def test_the_spot_moves_with_the_distance() -> None:
    def at(metres: float) -> int:
        return meters(scenes.reading(NOW, "distance", metres)).index("●")

    assert at(0.2) < at(1.0) < at(3.0) <= at(4.7) == at(40.0)


def test_what_was_understood_of_speech_is_shown_where_there_is_no_model() -> None:
    assert "speech" not in meters(m.SensorChanged(sensor="speech", state="ready", t=NOW))
    reading = scenes.reading(NOW, "speech", None, text="where is the", driver="furhat")
    assert "where is the" in meters(reading)


def test_old_values_look_old() -> None:
    reading = scenes.reading(NOW - 4_000_000, "distance", 1.0)
    (row,) = meter_rows(console_state(reading), FRAME)
    assert "~4 s old" in text([row])
    assert "stale" in {look for _, look in row}


@pytest.mark.parametrize(("age_s", "old"), [(5, False), (29, False), (31, True)])
def test_a_sensor_that_is_seldom_by_nature_looks_old_after_three_of_its_periods(
    age_s: int, old: bool
) -> None:
    sensor_changed = m.SensorChanged(sensor="battery", state="ok", every_s=10.0, t=NOW - 60_000_000)
    reading = scenes.reading(NOW - age_s * 1_000_000, "battery", 80.0, unit="%")
    (row,) = meter_rows(console_state(sensor_changed, reading), FRAME)
    assert ("old" in text([row])) is old


def test_each_robots_distance_has_a_ruler() -> None:
    shown = meters(
        scenes.reading(NOW, "left.distance", 0.3), scenes.reading(NOW, "right.distance", 2.0)
    ).splitlines()

    assert len(shown) == 2
    assert "left dist" in shown[0]
    assert "0.30 m intimate" in shown[0]
    assert "2.00 m social" in shown[1]


def test_what_belongs_to_a_distance_stands_below_it() -> None:
    nao = [
        scenes.reading(NOW, "distance", 1.5),
        scenes.reading(NOW, "distance.left", 1.5, unit="m"),
        scenes.reading(NOW, "distance.right", 2.5, unit="m"),
    ]
    meter, below = meters(*nao).splitlines()[:2]
    assert "1.50 m" in meter and "●" in meter
    assert "left 1.50 m" in below and "right 2.50 m" in below


def test_how_well_a_distance_comes_in_is_for_the_log() -> None:
    shown = meters(
        scenes.reading(NOW, "distance", 1.5),
        scenes.reading(NOW, "distance.rate", 12.9, unit="Hz"),
        scenes.reading(NOW, "distance.bad", 0.0),
    )
    assert "1.50 m" in shown
    assert "rate" not in shown and "bad" not in shown


def test_a_missing_distance_is_no_distance() -> None:
    assert "nothing seen" in meters(scenes.reading(NOW, "distance", None))


def test_loudness_shows_level_threshold_and_voice() -> None:
    loud: list[m.Message] = [
        scenes.reading(NOW, "loudness", 0.1),
        scenes.reading(NOW, "loudness.threshold", 0.01),
        m.SensorChanged(sensor="loudness", state="speaking", t=NOW),
    ]
    shown = meters(*loud)
    assert "-20 dB ● voice" in shown
    assert "│" in shown
    quiet = meters(scenes.reading(NOW, "loudness", 0.0))
    assert "-60 dB" in quiet
    assert "voice" not in quiet


def test_verdicts_have_signs() -> None:
    shown = meters(
        scenes.reading(NOW, "presence", 1.0),
        scenes.reading(NOW, "gaze", 0.0),
        scenes.reading(NOW, "identity", None, text="visitor 3"),
    )
    assert "● person" in shown
    assert "○ looks" in shown
    assert "visitor 3" in shown
    assert "~ person" in meters(scenes.reading(NOW - 9_000_000, "presence", 1.0))


@pytest.mark.parametrize(
    ("sensor", "value", "mark"),
    [
        *(("presence", 2.0, "● person"), ("presence", 0.3, "● person")),
        *(("presence", 0.0, "○ person"), ("gaze", 2.0, "● looks"), ("gaze", 0.3, "○ looks")),
        *(("presence", -1.0, "○ person"), ("presence", None, "○ person")),
    ],
)
def test_counts_of_people_are_marked_as_the_model_reads_them(
    sensor: str, value: float | None, mark: str
) -> None:
    assert mark in meters(scenes.reading(NOW, sensor, value))


def test_engagement_gives_its_reason() -> None:
    shown = meters(*[e for e in scenes.history() if isinstance(e, m.EngagementChanged)])
    assert "visitor, engaged" in shown
    assert "visitor 12 looks at the robot" in shown


def test_joints_show_where_they_are_and_where_they_go() -> None:
    shown = meters(*scenes.pose())
    assert "14° → 30°" in shown
    assert "◆" in shown
    assert "◇" in shown
    assert "-6° →" not in shown


def test_a_joint_that_is_no_angle_has_its_own_unit() -> None:
    lifted = scenes.reading(NOW, "joint.lift", 8.0, driver="reachy", unit="mm")
    assert "8 mm" in meters(lifted)


def test_joints_fold_where_there_is_no_room() -> None:
    shown = meters(*scenes.sensors(), frame=PaintFrame(40, 5, NOW))
    assert "yaw 14°" in shown
    assert len(shown.splitlines()) <= 5


def test_two_heads_keep_their_full_names() -> None:
    shown = meters(
        scenes.reading(NOW, "joint.left.yaw", 1.0), scenes.reading(NOW, "joint.right.yaw", 2.0)
    )
    assert "left.yaw" in shown
    assert "right.yaw" in shown
    robots = meters(
        scenes.reading(NOW, "left.joint.yaw", 1.0),
        scenes.reading(NOW, "left.setpoint.yaw", 9.0),
        scenes.reading(NOW, "right.joint.yaw", 2.0),
    )
    assert [line.split()[0] for line in robots.splitlines()] == ["left.yaw", "right.yaw"]
    assert "1° → 9°" in robots


def test_unknown_sensors_get_a_line() -> None:
    shown = meters(scenes.reading(NOW, "temperature", 41.5, unit="C"))
    assert " temperature 42 C " in shown
    assert "no sensor" in meters()
    assert "tick" not in meters(scenes.reading(NOW, "joy.tick", 0.4, unit="ms"))
    assert "speech" not in meters(scenes.reading(NOW, "mic.speech", None))


def test_the_order_is_fixed_whatever_speaks_first() -> None:
    readings = [
        scenes.reading(NOW, "base.y", -0.001, unit="m"),
        scenes.reading(NOW, "base.x", 0.388, unit="m"),
        scenes.reading(NOW, "direction", -23.6, unit="deg"),
        scenes.reading(NOW, "battery", 77, unit="%"),
        *scenes.sensors(),
    ]
    shown = meters(*readings)
    assert shown == meters(*reversed(readings))
    names = [line.split()[0] for line in shown.splitlines()]
    joints, others = ["pitch", "roll", "yaw"], ["battery", "base", "direction"]
    assert names == ["distance", "loudness", "visitor", *joints, *others]
    assert "base      x 0.39 m  y 0.00 m" in shown
    assert "direction -24°" in shown


def test_joints_keep_the_files_order_and_go_from_limit_to_limit() -> None:
    picture = ConsoleState()
    first = scenes.welcome(
        settings={"joints": {"tilt": [-30, 40], "pan": [-90, 90], "bad": [3, 3]}}
    )
    readings = [
        scenes.reading(NOW, f"joint.{name}", value, unit="deg")
        for name, value in (("arm", 0.0), ("pan", 40.0), ("tilt", 40.0))
    ]
    picture.apply([first, *readings], 0)
    rows = meter_rows(picture, FRAME)
    assert [text([row]).split()[0] for row in rows] == ["tilt", "pan", "arm"]
    tilt, pan, arm = (text([row]) for row in rows)
    assert tilt.index("◆") > pan.index("◆") > arm.index("◆")
    assert tilt.index("│") < arm.index("◆")


def test_quiet_is_quiet_and_a_clipping_microphone_warns() -> None:
    looks = {
        look
        for _, look in meter_rows(console_state(scenes.reading(NOW, "loudness", 0.1)), FRAME)[0]
    }
    assert not looks & {"good", "run"}
    (row,) = meter_rows(
        console_state(
            scenes.reading(NOW, "loudness", 0.9),
            m.SensorChanged(sensor="loudness", state="clipping", t=NOW),
        ),
        FRAME,
    )
    assert row[-1][1] == "warn"


@given(
    st.sampled_from(["distance", "loudness", "presence", "joint.a", "setpoint.a", "odd"]),
    st.one_of(st.none(), st.floats(allow_nan=False, allow_infinity=False)),
    st.integers(10, 120),
    st.integers(1, 30),
)
def test_meters_keep_to_their_frame(
    name: str, value: float | None, width: int, height: int
) -> None:
    picture = console_state(scenes.reading(NOW, name, value))
    rows = meter_rows(picture, PaintFrame(width, height, NOW))
    assert len(rows) <= height
    assert all(length(row) == width for row in rows)


# -- status, events, script, stop bar ------------------------------------------------------------


def status(picture: ConsoleState, width: int = 80, line: StatusInfo | None = None) -> str:
    rows = status_rows(picture, PaintFrame(width, 2, NOW), line or StatusInfo())
    assert all(length(row) == width for row in rows)
    return text(rows)


def test_the_status_line_says_who_what_and_how_it_is() -> None:
    shown = status(console_state(), 120, StatusInfo(True, 23_000))
    for part in ("Museum guide", "12:31", "P07", "warm", "trial 3", "session S01", "● Recording"):
        assert part in shown
    assert "connection 23 ms" in shown
    assert "● head" in shown


def test_of_many_robots_each_is_named_and_who_is_lost_stands_first() -> None:
    names = ("pepper.pepper", "nao.nao", "reachy.reachy", "furhat.furhat", "ros.turtlebot")
    health = [m.DriverConnected(driver=name, t=NOW - 9) for name in names]
    state = ConsoleState()
    state.apply([msgspec.structs.replace(scenes.welcome(health), drivers=[*names])], 0)
    row = status(state).splitlines()[1]
    for robot in ("pepper", "nao", "reachy", "furhat", "ros"):
        assert f"● {robot} " in row
    state.apply([m.DriverLost(driver="ros.turtlebot", detail="gone", t=NOW)], 0)
    assert "ros lost" in status(state, 60).splitlines()[1]
    assert "reachy.reachy" in status(state, 120).splitlines()[1]


def test_a_narrow_status_line_leaves_whole_parts_out() -> None:
    shown = status(console_state(), 60)
    assert "P07" in shown
    assert "…" not in shown.splitlines()[0]


@pytest.mark.parametrize(
    ("level", "lag", "shown"),
    [
        ("ok", 4_000, "● Recording"),
        ("warn", 300_000, "▲ Recording 300 ms late"),
        ("alarm", 1_500_000, "RECORDING 1500 ms LATE"),
        ("failed", 0, "NOT RECORDED"),
    ],
)
def test_the_recorders_levels(level: str, lag: int, shown: str) -> None:
    assert shown in status(console_state(m.RecorderState(level=level, lag_us=lag, path="x", t=NOW)))


def test_going_on_without_a_record_stands_in_the_place_of_recording() -> None:
    state = m.RecorderState(level="failed", lag_us=0, path="x", waived=True, t=NOW)
    for width in (60, 80, 120):
        shown = status(console_state(state), width).splitlines()[0]
        assert "WITHOUT A RECORD" in shown
        assert "NOT RECORDED" not in shown


def test_a_slow_and_a_stalled_line_are_told() -> None:
    assert "▲ connection 200 ms" in status(console_state(), line=StatusInfo(True, 200_000))
    assert "TERMINAL STALLED" in status(console_state(), line=StatusInfo(False, None))


def test_lost_drivers_failures_and_missing_participants_are_told() -> None:
    picture = console_state(
        m.DriverLost(driver="face", t=NOW),
        *scenes.played_action("a1", "Bow", NOW, 0, how="failed"),
        first=[scenes.start("", "")],
    )
    shown = status(picture, 100)
    assert "✗ face lost" in shown
    assert "✗ 1 failed: enter" in shown
    assert "no participant" in shown
    assert "no condition" in shown


def test_unseen_failures_stay_on_the_list() -> None:
    picture = console_state(*scenes.played_action("bad", "Bow", NOW - 60_000_000, 1, how="failed"))
    for number in range(30):
        picture.apply(scenes.played_action(f"r{number}", "Nod", NOW - 30_000_000, 1), 0)
    shown = listed_events(picture, 6)
    assert len(shown) == 6
    assert shown[0].run == "r29"
    assert shown[-1].run == "bad"
    picture.runs.seen.add("bad")
    assert "bad" not in {event.run for event in listed_events(picture, 6)}


def test_events_say_when_what_and_how_it_ended() -> None:
    frame = PaintFrame(60, 14, NOW)
    rows = event_rows(console_state(*scenes.history(), *scenes.speaking()), frame)
    shown = text(rows)
    assert all(length(row) == 60 for row in rows)
    assert "12:22 ✓ Nod" in shown
    assert "✗ Bow  head: servo 2 (pitch) overloaded" in shown
    assert "2.1 s left" in shown
    assert "queued" in shown
    assert "mistake" in shown


def test_a_robot_that_is_back_is_told_as_its_loss_was() -> None:
    lost = m.DriverLost(driver="nao", detail="it does not answer", t=NOW - 5_000_000, seq=1)
    back = m.DriverConnected(driver="nao", detail="simulated", t=NOW - 2_900_000, seq=2)
    many = [m.Note(text=f"note {number}", t=NOW - 2_000_000, seq=3 + number) for number in range(6)]
    lines = text(event_rows(console_state(lost, back, *many), PaintFrame(60, 8, NOW))).splitlines()
    assert any("nao lost" in line for line in lines)
    assert any("✓ nao connected  after 2.1 s" in line for line in lines)


def bar(picture: ConsoleState, asked_us: int | None = None, frame: PaintFrame | None = None) -> str:
    hints = (("Esc", "stop"), ("/", "say"))
    rows = bar_rows(
        picture,
        frame or PaintFrame(80, 2, NOW),
        BarInfo(News(), hints, ("Space", ""), "^R", asked_us, failures="f9"),
    )
    assert len(rows) == 2
    assert all(length(row) == (frame or FRAME_BAR).width for row in rows)
    return text(rows)


FRAME_BAR = PaintFrame(80, 2, NOW)


def test_the_stop_bar_names_who_confirmed_and_who_did_not() -> None:
    picture = console_state(m.StopPressed(source="key", t=NOW))
    assert "STOPPED by key" in bar(picture)
    assert "waiting for the drivers" in bar(picture)
    picture.apply(
        [m.StopConfirmed(confirmed=["head", "voice"], missing=["face"], elapsed_us=500_000)], 0
    )
    shown = bar(picture)
    assert "NOT CONFIRMED: face" in shown
    assert "confirmed: head, voice" in shown
    assert "^R releases (asks first)" in shown


def test_a_stop_that_is_not_answered_or_not_delivered_says_so() -> None:
    picture = console_state()
    assert "STOP SENT" in bar(picture, asked_us=NOW - 400_000)
    assert "400 ms" in bar(picture, asked_us=NOW - 400_000)
    picture.lose(Loss("the robot process closed the connection"))
    assert "robot process is gone" in bar(picture)
    assert "STOP NOT DELIVERED" in bar(picture, asked_us=NOW)


@pytest.mark.parametrize("missing", [(), ("voice",)])
def test_a_stop_that_was_confirmed_before_the_line_was_lost_stays_confirmed(
    missing: tuple[str, ...],
) -> None:
    picture = console_state(m.StopPressed(source="key", t=NOW))
    lost = Loss("cut", LostPart.LINE)
    picture.lose(lost)
    assert "STOP NOT CONFIRMED" in bar(picture)
    assert "own switch" in bar(picture)
    stop_confirmed = m.StopConfirmed(confirmed=["head"], missing=[*missing], elapsed_us=9)
    picture.apply([stop_confirmed], 0)
    shown = bar(picture)
    assert "STOPPED by key" in shown
    assert "the line to the robot is lost" in shown
    assert ("confirmed: head" if missing else "confirmed by all") in shown
    assert "goes on to its end" not in shown
    assert ("NOT CONFIRMED: voice" in shown) is bool(missing)
    assert ("f9 shows what can be done (cut)" in shown) is (not missing)
    assert "releases" not in shown
    assert "STOP NOT DELIVERED" in bar(picture, asked_us=NOW)


def test_a_narrow_bar_of_a_stop_still_says_that_the_robot_is_away() -> None:
    picture = console_state(m.StopPressed(source="key", t=NOW))
    missing = ["a driver of a long name", "another one", "the third"]
    picture.apply([m.StopConfirmed(confirmed=["head"], missing=missing, elapsed_us=9)], 0)
    picture.lose(Loss("cut", LostPart.LINE))
    shown = bar(picture, frame=PaintFrame(44, 2, NOW))
    assert "LINE LOST" in shown
    assert "NOT CONFIRMED" in shown
    assert "^R" not in shown, "no key is sent"


def test_the_bar_in_ascii_and_very_narrow() -> None:
    picture = console_state(m.StopPressed(source="key", t=NOW))
    assert bar(picture, frame=PaintFrame(80, 2, NOW, ASCII)).isascii()
    rows = bar_rows(picture, PaintFrame(12, 2, NOW, UNICODE), BarInfo(release="^R"))
    assert all(length(row) == 12 for row in rows)


@pytest.mark.parametrize(
    ("us", "shown"), [(0, "00:00"), (61_000_000, "01:01"), (3_661_000_000, "1:01:01")]
)
def test_elapsed(us: int, shown: str) -> None:
    assert elapsed(us) == shown


def test_figures() -> None:
    assert seconds(2_140_000) == "2.1 s"
    assert seconds(123_000_000) == "123 s"
    assert [time_left(us) for us in (7_440_000, 99_900_000, 99_960_000, 371_300_000)] == [
        "7.4",
        "99.9",
        "1:40",
        "6:11",
    ]


def test_a_tablet_that_nobody_has_touched_is_not_old() -> None:
    names = ("touch.x", "touch.y")
    nobody = [scenes.reading(NOW - 60_000_000, name, None) for name in names]
    assert "touch     nothing yet" in meters(*nobody)
    once = [scenes.reading(NOW - 60_000_000, name, 0.5) for name in names]
    assert "x ~0.5" in meters(*once)


def test_what_a_robot_feels_is_told_in_words() -> None:
    felt = {"bumper.left": 0.0, "bumper.right": 1.0, "left.fallen": 1.0, "button": 0.0}
    shown = meters(*(scenes.reading(NOW, name, value) for name, value in felt.items()))
    words = [line.split() for line in shown.splitlines()]
    assert ["bumper", "left", "free", "right", "pressed"] in words
    assert ["left.fallen", "yes"] in words
    assert ["button", "free"] in words


@pytest.mark.parametrize(
    ("value", "unit", "shown"), [(0.874, "", "87 %"), (77, "%", "77 %"), (12.6, "V", "12.6 V")]
)
def test_a_batterys_charge_is_told_in_percent(value: float, unit: str, shown: str) -> None:
    assert shown in meters(scenes.reading(NOW, "battery", value, unit=unit))
    assert decibels(1.0) == 0.0
    assert decibels(0.0) == decibels(float("nan")) == -60.0


@pytest.mark.toolkit("U1")
def test_each_robot_has_its_own_loudness_and_visitor() -> None:
    shown = meters(
        scenes.reading(NOW, "left.loudness", 0.1),
        scenes.reading(NOW, "left.loudness.threshold", 0.01),
        scenes.reading(NOW, "right.loudness", 0.001),
        scenes.reading(NOW, "left.presence", 1.0),
        scenes.reading(NOW, "right.presence", 0.0),
    ).splitlines()

    assert [line.split() for line in shown[2:]] == [
        ["left.visitor", "●", "person"],
        ["right.visitor", "○", "person"],
    ]
    assert "left loud" in shown[0]
    assert "-20 dB" in shown[0]
    assert "│" in shown[0]
    assert "-60 dB" in shown[1]
    assert "threshold" not in "".join(shown)


def test_no_minus_before_an_angle_of_zero() -> None:
    shown = meters(scenes.reading(NOW, "joint.pan", -0.2, unit="deg"))
    assert "-0" not in shown


# -- what the file wants first ---------------------------------------------------------------------


def first_words(names: list[str], *state: m.Message) -> list[str]:
    """The first word of each row, where the file names these sensors."""
    picture = ConsoleState()
    first = scenes.welcome(settings={"sensors": names}, state=[*scenes.healthy(), *state])
    picture.apply([first], 0)
    return [text([row]).split()[0] for row in meter_rows(picture, PaintFrame(50, 30, NOW))]


def test_the_sensors_of_the_file_stand_first_and_the_others_follow() -> None:
    usual = first_words([], *scenes.sensors())
    wanted = first_words(["pose", "loudness"], *scenes.sensors())
    assert sorted(wanted) == sorted(usual)
    assert wanted.index("loudness") < wanted.index("distance")
    assert usual.index("distance") < usual.index("loudness")
    assert first_words(["gaze", "loudness", "nobody"], *scenes.sensors())[:2] == [
        "visitor",
        "loudness",
    ]


def test_the_engagement_model_stands_where_the_file_says() -> None:
    state = [engagement_scene.waits(), *scenes.sensors()]
    assert first_words(["loudness", "distance", "engagement"], *state)[:3] == [
        "loudness",
        "distance",
        "▲",
    ]
    assert first_words(["engagement"], *state) == first_words([], *state)


def test_a_reload_moves_the_sensors() -> None:
    picture = ConsoleState()
    picture.apply([scenes.welcome(state=[*scenes.healthy(), *scenes.sensors()])], 0)
    panels: dict[str, Any] = {"panels": [], "script": [], "verbs": {}, "conditions": []}
    panels |= {"title": "T", "keyboard": "us", "sensors": ["loudness"]}
    picture.apply([r.PanelsChanged(**panels)], 0)
    (first, *_) = meter_rows(picture, PaintFrame(50, 30, NOW))
    assert text([first]).split()[0] == "loudness"


# -- a planner's block -----------------------------------------------------------------------------


def _block(*more: m.Message) -> tuple[m.Message, ...]:
    """A planner's block that speaks and nods."""
    text = '<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="greeting">...</bml>'
    began = NOW - 2_000_000
    parts = {"c41": ("say", {"text": "Welcome to the museum"}), "c42": ("play", {"move": "nod"})}
    return (
        m.ConsoleAttached(console="con2", role="program", name="asap", t=began),
        m.Command(
            command="c40",
            verb="bml",
            args={"block": text},
            driver="bml",
            source="program",
            console="con2",
            t=began,
        ),
        m.Dispatched(command="c40", driver="bml", latency_us=0, t=began),
        m.Progress(command="c40", driver="bml", expected_us=9_500_000, t=began),
        *(
            message
            for command, (verb, args) in parts.items()
            for message in (
                m.Command(
                    command=command,
                    run="c40",
                    verb=verb,
                    args=dict(args),
                    driver="head",
                    source="program",
                    t=began,
                ),
                m.Dispatched(command=command, driver="head", latency_us=0, t=began),
            )
        ),
        *more,
    )


@pytest.mark.parametrize("width", [80, 120, 200])
def test_a_planners_block_says_who_what_now_how_long_and_what_cuts_it(width: int) -> None:
    shown = status(console_state(*_block()), width, StatusInfo(cut="^X")).splitlines()[1]
    for part in ("greeting", "asap", "“Welcome", "7.5 s left", "^X  cuts"):
        assert part in shown


def test_the_key_stands_there_only_while_it_would_cut_the_block() -> None:
    later = m.Command(command="c50", verb="play", args={"move": "bow"}, source="key", t=NOW)
    shown = status(console_state(*_block(later)), 80, StatusInfo(cut="^X")).splitlines()[1]
    assert "greeting" in shown
    assert "cuts" not in shown


def test_a_block_that_is_over_is_gone() -> None:
    over = m.Done(command="c40", driver="bml", sent={}, latency_us=0, duration_us=0, t=NOW)
    assert "greeting" not in status(console_state(*_block(over)), 80)
