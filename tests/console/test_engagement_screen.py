"""The whole model in one picture, and what the keys do while it is shown."""

from __future__ import annotations

import msgspec
import pytest
from textual.events import Key

from tests.console import engagement_scene, scenes
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.config.engagement_words import STATES
from woz_tui.config.performers import ENGAGEMENT
from woz_tui.config.session_verbs import ENGAGEMENT_VERBS
from woz_tui.console.drawing.cells import Row, length
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, Glyphs, PaintFrame
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.engagement.full_engagement import full_rows
from woz_tui.console.engagement.state_diagram import HEIGHT, LINES, PLACES, WIDTH, diagram, line_of
from woz_tui.console.screens.engagement import EngagementDialog
from woz_tui.console.screens.engagement_questions import ForceDialog, IdentityDialog, VisitorDialog
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.state.engagement_text import short_state
from woz_tui.console.state.wizard_overrides import KEYS, OVERRIDES
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.welcome import ModelLimits
from woz_tui.sensing.state_machine import EDGES, State

NOW = scenes.NOW
WHOLE = PaintFrame(96, 28, NOW)
HAND = ("equals_sign", "tab")


def text(rows: list[Row]) -> str:
    return "\n".join("".join(piece for piece, _ in row) for row in rows)


def screen_text(*state: m.Message, frame: PaintFrame = WHOLE, **more: object) -> str:
    picture = ConsoleState()
    settings = engagement_scene.model_description(**more)
    picture.apply([engagement_scene.welcome(*state, settings=settings)], 0)
    assert picture.session.model.shown is not None
    rows = full_rows(picture, picture.session.model.shown, frame)
    assert len(rows) <= frame.height
    assert {length(row) for row in rows} == {frame.width}
    return text(rows)


def verbs(pilot: ConsolePilot) -> list[tuple[str, dict[str, m.Json]]]:
    """What was asked of the model: verbs that it has, with arguments that they take."""
    found = [asked for asked in pilot.feed.asked if isinstance(asked, r.AskVerb)]
    for ask_verb in found:
        assert ask_verb.on == ENGAGEMENT
        taken = {argument.name: argument for argument in ENGAGEMENT_VERBS[ask_verb.verb].arguments}
        assert set(ask_verb.args) <= set(taken)
        for name, value in ask_verb.args.items():
            choices = taken[name].choices
            assert not choices or value in choices
    return [(ask_verb.verb, ask_verb.args) for ask_verb in found]


def requested_actions(pilot: ConsolePilot) -> list[str]:
    return [asked.action for asked in pilot.feed.asked if isinstance(asked, r.AskAction)]


# -- the picture ----------------------------------------------------------------------------------


@pytest.mark.parametrize("glyphs", [UNICODE, ASCII], ids=["unicode", "ascii"])
def test_every_edge_of_the_table_has_a_line(glyphs: Glyphs) -> None:
    assert set(PLACES) == set(STATES)
    pairs = {frozenset(pair) for pair in LINES}
    edges = {
        frozenset((edge.source.value, edge.target.value))
        for edge in EDGES
        if edge.target is not State.STOP and not edge.unnamed
    }
    assert pairs == edges
    for edge in EDGES:
        if edge.target is not State.STOP and not edge.unnamed:
            rows = diagram(edge.target, [(edge.source, edge.target)], glyphs)
            assert (len(rows), {length(row) for row in rows}) == (HEIGHT, {WIDTH})
            assert f"[{short_state(edge.target)}]" in text(rows)
            taken = sum(len(piece) for row in rows for piece, look in row if look == "run")
            assert taken == len(line_of(edge.source, edge.target)) > 0
            for state in map(short_state, set(STATES) - {edge.target.value}):
                assert f" {state} " in f" {text(rows)} ".replace("\n", " ").replace("─", " ")


@pytest.mark.parametrize("glyphs", [UNICODE, ASCII], ids=["unicode", "ascii"])
def test_a_way_that_the_drawing_has_no_line_for_shows_both_states(glyphs: Glyphs) -> None:
    rows = diagram("Wait", [("RobotThinks", "Wait")], glyphs)
    assert "[nobody]" in text(rows)
    looks = {piece.strip(): look for row in rows for piece, look in row}
    assert looks["waits for answer"] == "plain"


def test_the_last_edge_has_an_arrow_to_where_it_went() -> None:
    there = text(diagram("RobotThinks", [("UserSpeaks", "RobotThinks")], UNICODE))
    assert "visitor speaks ━→[waits for answer]" in there
    up = text(diagram("EngagedWithKnown", [("UserSpeaks", "EngagedWithKnown")], UNICODE))
    assert "↑" in up
    down = text(diagram("UserSpeaks", [("EngagedWithKnown", "UserSpeaks")], ASCII))
    assert "v" in down.splitlines()[3]


def test_a_state_that_nobody_knows_is_drawn_without_a_place() -> None:
    rows = diagram("Dancing", [("Dancing", "Wait"), ("a", "b")], UNICODE)
    assert "[" not in text(rows)


def test_everything_is_in_the_picture() -> None:
    """E4: raw values are shown beside the filtered ones; E5: changes with time, outcome, reason."""
    gaze = m.SignShown(raw=0.0, verdict=0, count=2, needed=4, places=8, filter="fifo")
    shown = screen_text(
        engagement_scene.waits(signs=engagement_scene.signs(gaze=gaze), engaged=False),
        m.VisitorChanged(visitor="v12", what="learnt", about={"age_group": "adult"}, t=NOW),
        thinking=10.0,
    )
    for part in (
        "▲ visitor v12 waits for your answer, 3.2 s",
        "visitor v12 (adult)  attention SemiEngaged",
        "  3 of 10 s to answer",
        "presence  yes             fifo",
        "distance  0.84 m personal median",
        "○ no      2 of 8, needs 4",
        "● v12     9 of 10, needs 5",
        "not engaged: presence yes AND gaze no (2 of 8, needs 4) AND near yes   near: up to 1.30 m",
        "12:29 “where is the roman",
        "12:27   waits for answer  speech has ended",
        "12:00 ✎ engaged, known    introduced",
    ):
        assert part in shown, part


@pytest.mark.parametrize(
    ("width", "height"), [(56, 14), (76, 19), (96, 28), (108, 28), (30, 8), (160, 50)]
)
@pytest.mark.parametrize("glyphs", [UNICODE, ASCII], ids=["unicode", "ascii"])
def test_every_room_has_the_state_the_signs_and_the_condition(
    width: int, height: int, glyphs: Glyphs
) -> None:
    shown = screen_text(frame=PaintFrame(width, height, NOW, glyphs))
    for part in ("waits for", "presence", "gaze"):
        assert part in shown
    assert "engaged: presence yes" in shown or height < 10


def test_limits_are_told_where_the_host_tells_them() -> None:
    assert "12 of 60 s to speak" in screen_text(engagement_scene.engagement_shown("UserSpeaks"))
    assert "12 of 60 s for the handshake" in screen_text(
        engagement_scene.engagement_shown("Handshake")
    )
    assert " s to answer" not in screen_text(thinking=None)
    picture = ConsoleState()
    picture.apply([engagement_scene.welcome(settings={"engagement": {}})], 0)
    assert picture.session.model.shown is not None
    assert " of " in text(full_rows(picture, picture.session.model.shown, PaintFrame(96, 28, NOW)))


def test_a_state_that_its_visitor_has_left_says_when_it_ends() -> None:
    gone = msgspec.structs.replace(engagement_scene.signs()["presence"], verdict=0)
    engagement_shown = engagement_scene.engagement_shown(
        "RobotThinks", signs=engagement_scene.signs(presence=gone)
    )
    assert "ends 10 s after the visitor left" in screen_text(engagement_shown, absent=10.0)
    assert "after the visitor left" not in screen_text(engagement_shown)
    assert "after the visitor left" not in screen_text(
        engagement_scene.engagement_shown("RobotThinks"), absent=10.0
    )


def test_a_turn_says_when_it_ends_as_its_visitor_turned_away() -> None:
    def away(state: str) -> m.EngagementShown:
        return msgspec.structs.replace(engagement_scene.engagement_shown(state), engaged=False)

    ends = "ends 10 s after they turned away"
    assert ends in screen_text(away("RobotThinks"), unengaged=10.0)
    assert ends not in screen_text(away("RobotThinks"))
    assert ends not in screen_text(away("Handshake"), unengaged=10.0)
    assert ends not in screen_text(engagement_scene.engagement_shown("RobotThinks"), unengaged=10.0)


def test_by_hand_and_stale_are_said_in_words() -> None:
    found = engagement_scene.signs()
    hand = msgspec.structs.replace(found["presence"], raw=None, forced=True)
    old = msgspec.structs.replace(found["distance"], stale=True, verdict=0)
    shown = screen_text(
        engagement_scene.engagement_shown(signs={**found, "presence": hand, "distance": old})
    )
    assert "✎ by hand" in shown
    assert "~ stale" in shown
    assert "near stale" in shown


def test_a_sign_that_nobody_senses_says_so_in_full() -> None:
    never = msgspec.structs.replace(
        engagement_scene.signs()["gaze"], stale=True, raw=None, verdict=0
    )
    shown = screen_text(engagement_scene.engagement_shown(signs=engagement_scene.signs(gaze=never)))
    assert "~ no sensor" in shown


def test_a_model_that_the_file_gives_up_is_gone_from_the_screen() -> None:
    picture = ConsoleState()
    picture.apply([engagement_scene.welcome(settings=engagement_scene.model_description())], 0)
    panels_changed = r.PanelsChanged(
        title="t", panels=[], script=[], verbs={}, conditions=[], keyboard="us",
        engagement=ModelLimits(attempts=3),
    )  # fmt: skip
    picture.apply([panels_changed], 0)
    assert picture.session.model.shown is not None
    picture.apply([msgspec.structs.replace(panels_changed, engagement=ModelLimits())], 0)
    assert picture.session.model.shown is None


# -- keys -----------------------------------------------------------------------------------------


async def test_keys_play_until_tab_takes_the_model_into_the_hand() -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        await pilot.press("equals_sign")
        assert isinstance(pilot.console.dialog, EngagementDialog)
        assert "Keys play the robot." in pilot.drawn()
        await pilot.press("g", "1")
        assert requested_actions(pilot) == ["Coin hoard", "Nod"]
        assert verbs(pilot) == []
        await pilot.press("tab", "g", "1", "space")
        assert verbs(pilot) == [("toggle", {"sign": "gaze"})]
        assert requested_actions(pilot) == ["Coin hoard", "Nod", "Nod"], "other keys play on"
        assert any(isinstance(asked, AskScript) for asked in pilot.feed.asked)
        assert "BY HAND" in pilot.drawn()
        assert "these play nothing meanwhile: p Pause, g Coin hoard" in pilot.drawn()
        await pilot.press("tab", "g")
        assert requested_actions(pilot)[-1] == "Coin hoard"
        assert len(verbs(pilot)) == 1


async def test_the_reading_thread_leaves_the_hands_keys_to_the_screen() -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        keyboard = pilot.console.keyboard
        await pilot.press(*HAND)
        assert not keyboard.arrive("g")
        assert keyboard.arrive("1")
        assert not keyboard.arrive("f")
        handled = keyboard.leave_to_screen("f")
        assert not keyboard.arrive("1"), "it may belong into the dialog that f opens"
        handled()
        assert keyboard.arrive("1")
        await pilot.press("tab")
        assert keyboard.arrive("g")
        assert verbs(pilot) == []


async def test_a_key_right_behind_tab_is_the_hands() -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        await pilot.press("equals_sign")
        handled = pilot.console.keyboard.leave_to_screen("tab")
        assert not pilot.console.keyboard.arrive("g"), "the screen has not seen tab yet"
        handled()


async def test_a_stale_key_of_the_hand_does_nothing() -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        await pilot.press(*HAND)
        assert pilot.console.keyboard.arrive("p", stale=True)
        await pilot.settle()
        assert verbs(pilot) == []
        assert "p ignored: it came too late" in pilot.text("StopBar")


ASKED: dict[str, tuple[str, dict[str, m.Json]]] = {
    "p": ("toggle", {"sign": "presence"}),
    "g": ("toggle", {"sign": "gaze"}),
    "d": ("toggle", {"sign": "distance"}),
    "s": ("sense", {"sign": "all", "value": "sensor"}),
    "h": ("engagement", {"run": "hold"}),
    "n": ("engagement", {"run": "step"}),
    "o": ("engagement", {"run": "off"}),
    "k": ("handshake", {"what": "ok"}),
    "x": ("handshake", {"what": "fail"}),
}


async def test_each_key_of_the_hand_asks_the_model() -> None:
    """E7: the wizard can force every sign."""
    async with piloted_console(engagement_scene.welcome()) as pilot:
        await pilot.press(*HAND, *ASKED)
        assert verbs(pilot) == list(ASKED.values())
        asked = pilot.feed.last(r.AskVerb)
        assert isinstance(asked, r.AskVerb)
        assert (asked.source, asked.key) == ("key", "x")
        assert {order.key for order in OVERRIDES} == KEYS == {*ASKED, "i", "f", "v"}


async def test_hold_and_off_are_their_own_way_back() -> None:
    for run, key in (("hold", "h"), ("off", "o")):
        async with piloted_console(
            engagement_scene.welcome(engagement_scene.engagement_shown(run=run))
        ) as pilot:
            await pilot.press(*HAND, key)
            assert verbs(pilot) == [("engagement", {"run": "run"})]


async def test_a_state_is_forced_from_the_list() -> None:
    """E7: the wizard can force every transition."""
    async with piloted_console(engagement_scene.welcome()) as pilot:
        await pilot.press(*HAND, "f")
        assert isinstance(pilot.console.dialog, ForceDialog)
        assert "robot answers     done" in pilot.drawn()
        await pilot.press("down", "enter", "f", "down", "down", "enter")
        assert verbs(pilot) == [("force", {"to": "error"}), ("force", {"to": "Wait"})]
        assert isinstance(pilot.console.dialog, EngagementDialog)


async def test_an_outcome_becomes_its_state_if_the_model_has_moved_on() -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        await pilot.press(*HAND, "f")
        await pilot.tell(engagement_scene.engagement_shown("EngagedWithKnown"))
        await pilot.press("enter")
        assert verbs(pilot) == [("force", {"to": "RobotReplies"})]


async def test_an_identity_is_typed() -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        await pilot.tell(m.VisitorChanged(visitor="v7", what="learnt", t=NOW))
        await pilot.press(*HAND, "i")
        assert isinstance(pilot.console.dialog, IdentityDialog)
        assert "known: v7" in pilot.drawn()
        await pilot.type("v9")
        await pilot.press("enter", "i", "enter")
        assert verbs(pilot) == [
            ("sense", {"sign": "identity", "value": "v9"}),
            ("sense", {"sign": "identity", "value": "Unknown"}),
        ]


@pytest.mark.parametrize("size", [(60, 20), (80, 24)])
async def test_a_visitor_is_named(size: tuple[int, int]) -> None:
    async with piloted_console(
        engagement_scene.welcome(engagement_scene.engagement_shown(visitor="")), size=size
    ) as pilot:
        await pilot.press(*HAND, "v")
        dialog = pilot.console.dialog
        assert isinstance(dialog, VisitorDialog)
        assert dialog.query_one(".dialog").region.bottom <= size[1]
        await pilot.press("enter")
        assert "A visitor needs a code." in pilot.drawn() or size == (60, 20)
        await pilot.type("v31")
        await pilot.press("tab")
        await pilot.type("child")
        await pilot.press("enter")
        assert verbs(pilot) == [("visitor", {"code": "v31", "age_group": "child"})]
        assert isinstance(pilot.console.dialog, EngagementDialog)


async def test_a_name_that_is_taken_keeps_the_dialog_open_with_the_reason() -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        pilot.feed.answers[r.AskVerb] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="v12 is somebody else", hint="take another code"
        )
        await pilot.press(*HAND, "v", "enter")
        assert isinstance(pilot.console.dialog, VisitorDialog)
        assert "v12 is somebody else: take another code" in pilot.drawn()


async def test_a_handshake_without_a_name_asks_for_one() -> None:
    nobody = m.SignShown(raw_name="Unknown", name="Unknown", places=10)
    state = engagement_scene.engagement_shown(
        "Handshake", visitor="", signs=engagement_scene.signs(identity=nobody)
    )
    async with piloted_console(engagement_scene.welcome(state)) as pilot:
        await pilot.press(*HAND, "k")
        assert isinstance(pilot.console.dialog, VisitorDialog)
        assert verbs(pilot) == []


@pytest.mark.parametrize("keys", [(), ("tab",), ("tab", "f"), ("tab", "v"), ("tab", "i")])
async def test_the_stop_reaches_the_robot_and_closes_everything(keys: tuple[str, ...]) -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        await pilot.press("equals_sign", *keys, "escape")
        await pilot.until(lambda: pilot.console.dialog is None)
        assert pilot.feed.last(r.AskStop) is not None
        assert pilot.console.keyboard.kept == frozenset()
        await pilot.press("g")
        assert requested_actions(pilot) == ["Coin hoard"]


async def test_the_hand_lets_go_when_the_screen_is_closed() -> None:
    async with piloted_console(engagement_scene.welcome()) as pilot:
        for closing in ("ctrl+q", "equals_sign", "semicolon"):
            await pilot.press(*HAND, closing)
            assert pilot.console.keyboard.kept <= {"tab", "shift+tab"}
            assert not isinstance(pilot.console.dialog, EngagementDialog)
        await pilot.press("ctrl+q", "equals_sign", "p")
        assert requested_actions(pilot) == ["Pause"], "opened again it plays"


async def test_without_a_model_it_says_how_a_session_gets_one() -> None:
    async with piloted_console() as pilot:
        await pilot.press(*HAND, "g")
        assert "no engagement model" in pilot.drawn()
        assert "engagement: {}" in pilot.drawn()
        assert requested_actions(pilot) == ["Coin hoard"], "there is nothing to take into the hand"


async def test_the_time_in_the_state_goes_on_while_it_is_open() -> None:
    async with piloted_console(
        engagement_scene.welcome(engagement_scene.engagement_shown())
    ) as pilot:
        await pilot.press("equals_sign")
        assert "your answer 00:12" in pilot.drawn()
        await pilot.pass_time(5)
        assert "your answer 00:17" in pilot.drawn()


@pytest.mark.parametrize(
    ("size", "glyphs"),
    [((60, 20), UNICODE), ((80, 24), ASCII), ((100, 36), UNICODE), ((160, 50), ASCII)],
)
async def test_it_fits_every_screen_with_hostile_names(
    size: tuple[int, int], glyphs: Glyphs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    nasty = "\x1b[2J日本\u202e" + "x" * 200
    sign_shown = msgspec.structs.replace(
        engagement_scene.signs()["identity"], name=nasty, raw_name=nasty
    )
    state = engagement_scene.waits(
        visitor=nasty, signs=engagement_scene.signs(identity=sign_shown), attention=nasty
    )
    first = engagement_scene.welcome(
        state, engagement_scene.engagement_changed("Wait", nasty, nasty, nasty, 1.0)
    )
    async with piloted_console(first, size=size, look=Appearance(glyphs, "woz-16")) as pilot:
        await pilot.press(*HAND)
        shown = pilot.drawn()
        assert "\x1b" not in shown
        assert "\u202e" not in shown
        assert "waits for" in shown
        assert "presence" in shown
        pilot.console.post_message(Key("escape", "\x1b"))
        await pilot.until(lambda: pilot.console.dialog is None)


@pytest.mark.parametrize(("raw", "said"), [(2.0, "yes"), (0.3, "yes"), (0.0, "no")])
def test_any_number_of_people_is_shown_as_somebody(raw: float, said: str) -> None:
    sign = m.SignShown(raw=raw, verdict=0, count=0, needed=4, places=8, filter="fifo")
    page = screen_text(
        engagement_scene.engagement_shown(signs=engagement_scene.signs(presence=sign))
    )
    (row,) = (line.split() for line in page.splitlines() if line.startswith("presence"))
    assert row[1] == said
