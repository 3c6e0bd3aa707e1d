"""The engagement model among the meters: what is shown, in which order, and in how much room."""

from __future__ import annotations

import itertools
import re

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.console import engagement_scene, scenes
from woz_tui.console.drawing.cells import Row, length
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, Glyphs, PaintFrame
from woz_tui.console.engagement.sign_bars import distance_bar, queue_bar
from woz_tui.console.link.message_feed import Loss
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import LONG_US, SLOW_US, state_row
from woz_tui.console.widgets.meters import meter_rows
from woz_tui.protocol import messages as m

NOW, SECOND = scenes.NOW, scenes.SECOND
LOW, MIDDLE, HIGH = PaintFrame(39, 6, NOW), PaintFrame(50, 11, NOW), PaintFrame(50, 30, NOW)


def console_state(*messages: m.Message) -> ConsoleState:
    state = ConsoleState()
    state.apply([scenes.welcome(state=[*scenes.healthy(), *messages])], 0)
    return state


def text(rows: list[Row]) -> str:
    return "\n".join("".join(piece for piece, _ in row) for row in rows)


def meters(*messages: m.Message, frame: PaintFrame = HIGH) -> str:
    return text(meter_rows(console_state(*messages), frame))


def looks(*messages: m.Message, frame: PaintFrame = HIGH) -> dict[str, str]:
    """Each piece's look, by its text without blanks."""
    rows = meter_rows(console_state(*messages), frame)
    return {piece.strip(): look for row in rows for piece, look in row}


def sign(**other: object) -> m.SignShown:
    sign_shown = engagement_scene.signs()["gaze"]
    return msgspec.structs.replace(sign_shown, **other)


# -- what and where ---------------------------------------------------------------------------


@pytest.mark.parametrize("frame", [LOW, MIDDLE, HIGH], ids=["6", "11", "30"])
def test_the_state_stands_first_and_the_order_is_fixed(frame: PaintFrame) -> None:
    shown = meters(engagement_scene.waits(), *scenes.sensors(), frame=frame).splitlines()
    assert "waits for your answer, 3.2 s" in shown[0]
    wanted = ("waits", "person", "near", "0.84 m personal", "loudness")
    places = [next(y for y, line in enumerate(shown) if word in line) for word in wanted]
    assert places == sorted(places)


def test_nothing_moves_when_the_visitor_goes() -> None:
    gone = engagement_scene.engagement_shown(
        "Wait",
        visitor="",
        engaged=False,
        trail=["Wait"],
        signs={
            name: msgspec.structs.replace(sign_shown, verdict=0, count=0, name="")
            for name, sign_shown in engagement_scene.signs().items()
        },
    )
    for frame in (LOW, MIDDLE, HIGH):
        here = meters(engagement_scene.waits(), *scenes.sensors(), frame=frame).splitlines()
        away = meters(gone, *scenes.sensors(), frame=frame).splitlines()
        assert len(here) == len(away)
        assert away[0].startswith(" ○ nobody there")
        for word in ("person", "near", "distance", "loudness"):
            assert [word in line for line in here] == [word in line for line in away]


NARROW = PaintFrame(33, 6, NOW)


@pytest.mark.parametrize("frame", [NARROW, LOW, MIDDLE, HIGH], ids=["33", "39", "50", "high"])
def test_all_meters_of_a_block_begin_and_end_in_one_column(frame: PaintFrame) -> None:
    shown = meters(engagement_scene.waits(), *scenes.sensors(), frame=frame).splitlines()
    tracks = [
        [found.span() for found in re.finditer("[━┈─│●]{5,}", line)]
        for line in shown
        if any(word in line for word in ("person", "near", "distance", "loudness"))
    ]
    assert len(tracks) == 4
    assert len({each[0] for each in tracks}) == 1, tracks
    assert len({each[1] for each in tracks if len(each) > 1}) <= 1, tracks


def test_names_of_meters_are_cut_only_where_there_is_no_room() -> None:
    readings = [
        scenes.reading(NOW, name, 1.0, unit=unit)
        for name, unit in (
            ("reachy.distance", "m"),
            ("pepper.distance", "m"),
            ("temperature", "C"),
            ("ros.battery", ""),
        )
    ]
    shown = meters(*readings, frame=HIGH)
    for name in ("reachy dist", "pepper dist", "temperature", "ros.battery"):
        assert f" {name} " in shown
    tracks = [
        found.span() for line in shown.splitlines() for found in re.finditer("[┈│●]{5,}", line)
    ]
    assert len(tracks) == 2 and len(set(tracks)) == 1
    assert "reac… dist" not in meters(*readings, frame=PaintFrame(28, 9, NOW))


def test_how_long_a_state_lasts_is_told_whole_or_not_at_all() -> None:
    shown = engagement_scene.engagement_shown("PersonDetected", visitor="", engaged=False)
    assert meters(shown, frame=LOW).splitlines()[0].rstrip().endswith("not engaged 00:12")
    assert meters(shown, frame=NARROW).splitlines()[0].rstrip().endswith("not engaged")


def test_who_it_is_is_written_out_where_the_meter_beside_it_would_have_stood() -> None:
    named = engagement_scene.signs(
        identity=msgspec.structs.replace(engagement_scene.signs()["identity"], name="Friederike")
    )
    shown = meters(engagement_scene.engagement_shown(signs=named), frame=LOW)
    assert "● Friederike" in shown


def test_a_high_screen_has_a_row_for_everything() -> None:
    rows = [
        engagement_scene.waits(),
        *engagement_scene.way(),
        *engagement_scene.talk(),
        *scenes.sensors(),
    ]
    names = [line.split()[0] for line in meters(*rows).splitlines()]
    signs = ["person", "looks", "near", "who?"]
    block = ["▲", "now", "why", *signs, "distance", "loudness", "heard"]
    assert names[: len(block)] == block
    shown = meters(*rows)
    assert "speech has ended" in shown
    assert "2 s ago “where is the roman glass”" in shown
    assert "● yes 5 of 8" in shown
    assert "● v12 9 of 10" in shown


def test_a_session_without_a_model_shows_what_it_always_did() -> None:
    shown = meters(*scenes.sensors())
    assert [line.split()[0] for line in shown.splitlines()][:3] == [
        "distance",
        "loudness",
        "visitor",
    ]


def test_several_robots_keep_a_ruler_each_beside_the_models_own() -> None:
    shown = meters(
        engagement_scene.engagement_shown(),
        scenes.reading(NOW, "left.distance", 0.3),
        scenes.reading(NOW, "right.distance", 2.0),
    )
    assert "0.84 m personal" in shown
    assert "0.30 m intimate" in shown
    assert "2.00 m social" in shown


# -- waiting, speaking, hearing ----------------------------------------------------------------


@pytest.mark.parametrize(
    ("seconds", "glyph", "look"),
    [(0.0, "waits", "plain"), (1.9, "waits", "plain"), (2.0, "warning", "warn"),
     (4.9, "warning", "warn"), (5.0, "error", "bad"), (400.0, "error", "bad")],
)  # fmt: skip
@pytest.mark.parametrize("glyphs", [UNICODE, ASCII], ids=["unicode", "ascii"])
def test_a_wait_grows_louder_with_a_sign(
    seconds: float, glyph: str, look: str, glyphs: Glyphs
) -> None:
    state = console_state(engagement_scene.waits(seconds))
    assert state.session.model.shown is not None
    (found,) = state_row(state.engaged, state.session.model.shown, NOW, glyphs, 80)
    assert found[0].startswith(str(getattr(glyphs, glyph)))
    assert found[1] == look
    assert found[0].isascii() or glyphs is UNICODE
    assert SLOW_US < LONG_US
    assert len({glyphs.waits, glyphs.warning, glyphs.error}) == 3


@pytest.mark.parametrize(("room", "told"), [(80, "waits for the wizard's answer"), (24, "waits")])
def test_who_only_watches_reads_whose_answer_it_is(room: int, told: str) -> None:
    state = console_state(engagement_scene.waits(1.0))
    assert state.session.model.shown is not None
    shown = state.session.model.shown
    (found,) = state_row(state.engaged, shown, NOW, UNICODE, room, watches=True)
    assert told in found[0]
    assert "your" not in found[0]


def test_the_wait_goes_on_between_messages() -> None:
    state = console_state(engagement_scene.waits(1.0))
    for later, wanted in (
        (0, "1.0 s"),
        (700_000, "1.7 s"),
        (9_000_000, "10 s"),
        (274_000_000, "04:35"),
    ):
        rows = meter_rows(state, PaintFrame(50, 30, NOW + later))
        assert f"visitor v12 waits for your answer, {wanted}" in text(rows)
    assert state.moves(NOW)
    assert not console_state(engagement_scene.engagement_shown()).moves(NOW)


def test_what_was_heard_stands_beside_the_wait_where_room_is_short() -> None:
    shown = meters(engagement_scene.waits(), *engagement_scene.talk(), frame=LOW).splitlines()
    assert shown[0].startswith(" ▲ waits for your answer, 3.2 s")
    assert "“where is the roman" in shown[1]


def test_an_open_segment_is_timed_beside_the_level() -> None:
    shown = meters(
        engagement_scene.engagement_shown("UserSpeaks"),
        engagement_scene.speaks(),
        *scenes.sensors(),
    )
    assert "-31 dB ● 3.1 s" in shown
    speech_ended = m.SpeechEnded(driver="microphone", segment=9, began=NOW - 9, ended=NOW, t=NOW)
    assert "● 3.1 s" not in meters(
        engagement_scene.engagement_shown(),
        engagement_scene.speaks(),
        speech_ended,
        *scenes.sensors(),
    )


def test_without_a_level_the_speech_is_told_by_itself() -> None:
    assert "speech 3.1 s" in meters(
        engagement_scene.engagement_shown("UserSpeaks"), engagement_scene.speaks()
    )


def test_what_was_understood_so_far_is_shown_while_it_is_said() -> None:
    before = scenes.reading(NOW - 9 * SECOND, "speech", None, text="of before", driver="microphone")
    reading = scenes.reading(NOW - SECOND, "speech", None, text="where is the", driver="microphone")
    speaks = (
        engagement_scene.engagement_shown("UserSpeaks"),
        *engagement_scene.talk(),
        engagement_scene.speaks(),
    )
    assert "where is the roman glass" in meters(*speaks, before)
    shown = meters(*speaks, before, reading)
    assert "“where is the …" in shown
    assert "roman glass" not in shown
    speech_ended = m.SpeechEnded(driver="microphone", segment=9, began=NOW - 9, ended=NOW, t=NOW)
    text = m.SpeechText(driver="microphone", segment=9, text="where is the cloakroom", t=NOW)
    assert "where is the cloakroom" in meters(*speaks, reading, speech_ended, text)


def test_what_two_texts_so_far_have_in_common_is_firm_and_the_rest_is_faint() -> None:
    so_far = [
        scenes.reading(NOW - ago * SECOND, "speech", None, text=text, driver="microphone")
        for ago, text in ((2, "where is the row"), (1, "where is the roman glass"))
    ]
    scene = (engagement_scene.engagement_shown("UserSpeaks"), engagement_scene.speaks())
    found = looks(*scene, *so_far)
    assert (found["“where is the"], found["roman glass …"]) == ("good", "faint")
    assert looks(*scene, so_far[0])["where is the row …"] == "faint", "nothing is firm yet"


def test_the_robots_own_voice_is_nowhere_on_the_screen() -> None:
    before = engagement_scene.engagement_shown("RobotReplies")
    began = m.SpeechStarted(driver="microphone", segment=9, began=NOW - 3 * SECOND, own=True, t=NOW)
    ended = m.SpeechEnded(
        driver="microphone", segment=9, began=began.began, ended=NOW, own=True, t=NOW
    )
    said = "it is from the first century"
    text = m.SpeechText(driver="microphone", segment=9, text=said, own=True, t=NOW)
    assert meters(before, began) == meters(before)
    assert meters(before, began, ended, text) == meters(before)
    overlap = msgspec.structs.replace(text, own=False, overlap=True)
    assert said in meters(before, began, ended, overlap)


def test_nobody_knows_of_speech_when_the_microphone_is_gone() -> None:
    lost = m.DriverLost(driver="microphone", detail="unplugged", t=NOW)
    state = ConsoleState()
    state.apply(
        [
            scenes.welcome(state=[engagement_scene.engagement_shown()]),
            engagement_scene.speaks(),
            lost,
        ],
        0,
    )
    assert state.engaged.speaking(NOW) is None
    assert not state.moves(NOW)


# -- honest --------------------------------------------------------------------------------------


@pytest.mark.parametrize("frame", [LOW, HIGH], ids=["low", "high"])
@pytest.mark.parametrize("glyphs", [UNICODE, ASCII], ids=["unicode", "ascii"])
def test_yes_no_none_stale_and_by_hand_are_told_apart_without_colour(
    frame: PaintFrame, glyphs: Glyphs
) -> None:
    frame = PaintFrame(frame.width, frame.height, NOW, glyphs)
    states = [
        sign(),
        sign(verdict=0, count=2),
        sign(verdict=None, count=2),
        sign(stale=True, verdict=0, count=0),
        sign(stale=True, verdict=0, count=0, raw=None),
        sign(forced=True, count=0),
        sign(forced=True, verdict=0, count=0),
    ]
    seen = [
        meters(engagement_scene.engagement_shown(signs={"gaze": one}), frame=frame)
        for one in states
    ]
    for first, second in itertools.combinations(seen, 2):
        assert first != second
    assert "by hand" in seen[5] or "hand" in seen[5]
    assert "stale" in seen[3]
    assert "no sensor" in seen[4]


@pytest.mark.parametrize("name", ["", "Unknown"])
def test_a_name_that_nobody_gave_is_not_called_stale(name: str) -> None:
    never = sign(stale=True, raw=None, verdict=0, count=0, name=name)
    seen = meters(engagement_scene.engagement_shown(signs=engagement_scene.signs(identity=never)))
    assert "no sensor" in seen
    assert "stale" not in seen


def test_nobody_waits_for_a_model_that_is_off() -> None:
    waits = engagement_scene.waits()
    assert "waits" in meters(waits)
    assert "waits" not in meters(msgspec.structs.replace(waits, run="off"))


def test_who_waits_and_is_not_seen_any_more_is_said_to_be_so() -> None:
    gone = msgspec.structs.replace(engagement_scene.signs()["presence"], verdict=0, count=0)
    assert "not seen" not in meters(engagement_scene.waits())
    for frame in (LOW, MIDDLE, HIGH):
        assert "3.2 s, not seen" in meters(
            engagement_scene.waits(signs=engagement_scene.signs(presence=gone)), frame=frame
        )


def test_a_count_is_told_whole_or_not_at_all() -> None:
    nobody = msgspec.structs.replace(engagement_scene.signs()["identity"], name="Unknown", count=0)
    found = looks(engagement_scene.engagement_shown(signs=engagement_scene.signs(identity=nobody)))
    assert "○ unknown 0 of 10" in found
    narrow = PaintFrame(33, 30, NOW)
    found = looks(
        engagement_scene.engagement_shown(signs=engagement_scene.signs(identity=nobody)),
        frame=narrow,
    )
    assert "○ unknown" in found


def test_a_distance_of_nobody_is_not_stale() -> None:
    found = engagement_scene.signs()
    gone = msgspec.structs.replace(found["presence"], raw=0.0, verdict=0, count=0)
    silent = msgspec.structs.replace(found["distance"], stale=True, verdict=0, count=0)
    signs = engagement_scene.signs(presence=gone, distance=silent)
    for frame in (LOW, MIDDLE, HIGH):
        assert "stale" not in meters(
            engagement_scene.engagement_shown("Wait", signs=signs), frame=frame
        )
    assert "nobody there" in meters(engagement_scene.engagement_shown("Wait", signs=signs))
    never = msgspec.structs.replace(silent, raw=None)
    unseen = engagement_scene.engagement_shown(
        "Wait", signs=engagement_scene.signs(presence=gone, distance=never)
    )
    assert "no sensor" in meters(unseen)
    nobody = scenes.reading(NOW, "distance", None, unit="m")
    assert "no sensor" not in meters(nobody, unseen), "it has nobody to measure"


def test_a_stale_distance_looks_old() -> None:
    far = msgspec.structs.replace(engagement_scene.signs()["distance"], stale=True, verdict=0)
    found = looks(engagement_scene.engagement_shown(signs=engagement_scene.signs(distance=far)))
    assert found["~ 0.84 m stale"] == "stale"


def test_a_sign_outside_the_condition_says_so() -> None:
    assert "not used" in meters(engagement_scene.engagement_shown(uses=["presence", "distance"]))


def test_a_lost_robot_process_leaves_no_verdict_and_no_clock() -> None:
    state = console_state(engagement_scene.waits())
    state.lose(Loss("gone"))
    shown = text(meter_rows(state, HIGH))
    assert shown.startswith(" ~ visitor v12")
    assert "3.2 s" not in shown
    assert "● yes" not in shown
    assert not state.moves(NOW)


def test_held_tells_where_it_would_go_and_off_that_it_is() -> None:
    engagement_shown = engagement_scene.engagement_shown(
        "EngagedWithUnknown", run="hold", next="Handshake"
    )
    assert "■ held: next asks the name" in meters(engagement_shown)
    assert "■ held → asks the name" in meters(engagement_shown, frame=LOW)
    assert "■ held" in meters(engagement_scene.engagement_shown(run="hold"), frame=LOW)
    assert "■ off" in meters(engagement_scene.engagement_shown(run="off"))
    assert "held" not in meters(engagement_scene.engagement_shown())


def test_a_forced_change_is_marked_beside_its_reason() -> None:
    change = engagement_scene.engagement_changed(
        "Wait", "Handshake", "forced", "by the wizard", 1.0, forced=True
    )
    assert "✎ by the wizard" in meters(engagement_scene.engagement_shown(), change)
    assert "= by the wizard" in text(
        meter_rows(
            console_state(engagement_scene.engagement_shown(), change),
            PaintFrame(50, 30, NOW, ASCII),
        )
    )


def test_only_an_unusual_attention_is_told() -> None:
    assert "SemiEngaged" not in meters(engagement_scene.engagement_shown())
    assert "FullyEngaged" in meters(engagement_scene.engagement_shown(attention="FullyEngaged"))


def test_the_attempts_of_a_handshake_are_counted() -> None:
    assert "visitor is asked for a name 00:12 attempt 2" in meters(
        engagement_scene.engagement_shown("Handshake", attempt=2)
    )


# -- bars -----------------------------------------------------------------------------------------


@given(
    st.integers(-5, 1200),
    st.integers(-5, 1200),
    st.integers(-5, 1200),
    st.integers(0, 60),
    st.sampled_from([UNICODE, ASCII]),
)
def test_a_queues_bar_keeps_its_width_and_reaches_its_tick_only_when_enough(
    count: int, needed: int, places: int, width: int, glyphs: Glyphs
) -> None:
    sign_shown = m.SignShown(count=count, needed=needed, places=places)
    row = queue_bar(sign_shown, width, glyphs)
    assert length(row) == width
    told = "".join(piece for piece, _ in row)
    if width < 3 or places <= 0:
        assert glyphs.tick not in told
        return
    before, after = told.split(glyphs.tick)
    needed, count = min(places, max(0, needed)), min(places, max(0, count))
    assert (glyphs.track not in before) is (count >= needed)
    if glyphs.bar in after:
        assert count > needed


@pytest.mark.parametrize("places", range(1, 9))
@pytest.mark.parametrize("width", [9, 14])
def test_a_short_queue_grows_with_every_place_and_ends_where_others_do(
    places: int, width: int
) -> None:
    for needed in range(1, places + 1):
        signs = (
            m.SignShown(count=count, needed=needed, places=places) for count in range(places + 1)
        )
        told = ["".join(piece for piece, _ in queue_bar(each, width, UNICODE)) for each in signs]
        fills = [each.count("━") for each in told]
        assert fills == sorted(set(fills)), (needed, told)
        assert fills[0] == 0 and fills[-1] == width - 1


@given(
    st.one_of(st.none(), st.floats()),
    st.floats(),
    st.integers(1, 60),
    st.booleans(),
)
def test_a_distance_bar_keeps_its_width(
    metres: float | None, social: float, width: int, stale: bool
) -> None:
    row = distance_bar(metres, social, width, UNICODE, stale=stale)
    assert length(row) == width


def test_the_line_is_solid_as_far_as_the_robot_talks() -> None:
    def solid(social: float) -> int:
        row = distance_bar(None, social, 40, UNICODE)
        return len("".join(piece for piece, _ in row).partition("┈")[0])

    assert solid(0.5) < solid(1.3) < solid(3.0) < solid(9.0) == 40


# -- any text, any room -------------------------------------------------------------------------

NASTY = [
    "\x1b[31mred",
    "日本語の名前です",
    "e\u0301e\u0301",
    "\u202eevil",
    "x" * 300,
    "a\nb\tc",
    "👍🏽",
]


@pytest.mark.parametrize("nasty", NASTY)
@pytest.mark.parametrize("width", [30, 39, 50, 60, 80, 100, 160])
@pytest.mark.parametrize("height", [3, 6, 11, 30])
def test_hostile_texts_are_clean_and_keep_to_the_frame(nasty: str, width: int, height: int) -> None:
    found = engagement_scene.signs()
    identity = msgspec.structs.replace(found["identity"], name=nasty, raw_name=nasty)
    messages = [
        engagement_scene.waits(
            visitor=nasty, signs={**found, "identity": identity}, trail=[nasty] * 9
        ),
        engagement_scene.engagement_changed(nasty, nasty, nasty, nasty, 1.0, forced=True),
        m.SpeechText(driver=nasty, segment=1, text=nasty, t=NOW),
        *scenes.sensors(),
    ]
    rows = meter_rows(console_state(*messages), PaintFrame(width, height, NOW))
    assert len(rows) <= height
    for row in rows:
        assert length(row) == width
        assert not any(ord(letter) < 32 or letter == "\u202e" for letter in text([row]))
