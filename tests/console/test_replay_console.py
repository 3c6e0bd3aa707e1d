from __future__ import annotations

import asyncio
import functools
import itertools
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import pytest
from textual.events import Key
from textual.keys import key_to_character
from textual.widgets import OptionList

from tests.console import engagement_scene
from tests.console.piloting import ConsolePilot
from tests.console.scripted_feed import ScriptedFeed
from tests.replay.logs import PLAN, SECOND, START, KeptSamples, recording_of, stamped, story
from woz_tui.console.drawing.glyphs import ASCII, UNICODE
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.link.message_feed import Incoming, OnLost, OnMessages
from woz_tui.console.replay.app import ReplayConsole
from woz_tui.console.replay.commands import ReplayKeyboard
from woz_tui.log.coding_file import Coding
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView
from woz_tui.replay.player import ReplayPlayer, ReplayStart
from woz_tui.replay.recording import Recording
from woz_tui.system.clock import ManualClock


class StillReplay(ScriptedFeed):
    """A replay that goes on when the test says so."""

    def __init__(self, player: ReplayPlayer, clock: ManualClock) -> None:
        super().__init__()
        self.player = player
        self.clock = clock

    def start(self, on_messages: OnMessages, on_lost: OnLost) -> None:
        super().start(on_messages, on_lost)
        self.deliver(*self.player.begin(self.clock.now_us()))

    def deliver(self, *messages: Incoming) -> None:
        """As they are: a replay is in the console's process."""
        self._elsewhere(functools.partial(self._on_messages, [*messages]))

    def ask(self, request: r.Request) -> int:
        request = msgspec.structs.replace(request, ref=len(self.asked) + 1)
        self.asked.append(request)
        self.deliver(*self.player.ask(request, self.clock.now_us()))
        return request.ref

    def tick(self) -> None:
        told = self.player.tick(self.clock.now_us())
        if told:
            self.deliver(*told)


@dataclass
class ReplayPilot(ConsolePilot):
    feed: StillReplay

    async def pass_time(self, seconds: float) -> None:
        self.clock.advance(seconds)
        await asyncio.to_thread(self.feed.tick)
        await self.settle()
        self.console.paint()
        await self.settle()

    @property
    def t(self) -> int:
        return self.feed.player.t


@asynccontextmanager
async def watching(
    start: ReplayStart | None = None,
    *,
    size: tuple[int, int] = (80, 24),
    recording: Recording | None = None,
    notes: tuple[str, ...] = (),
    coding: Coding | None = None,
    **options: Any,
) -> AsyncIterator[ReplayPilot]:
    clock = ManualClock()
    player = ReplayPlayer(
        recording or recording_of(story()), start, "recordings/x_S01.jsonl", notes, coding
    )
    feed = StillReplay(player, clock)
    console = ReplayConsole(feed, ReplayKeyboard(feed, clock), clock=clock, **options)
    async with console.run_test(size=size) as pilot:
        replay_pilot = ReplayPilot(console, feed, pilot, clock)
        await replay_pilot.settle()
        console.paint()
        await replay_pilot.settle()
        yield replay_pilot


@pytest.mark.parametrize("size", [(80, 24), (160, 50), (60, 20)])
async def test_it_says_what_it_is_and_of_which_session(size: tuple[int, int]) -> None:
    async with watching(ReplayStart(at_us=9 * SECOND), size=size) as pilot:
        status = pilot.text("StatusLines")
        for part in (" REPLAY ", "Museum", "00:09", "2026-03-01", "log complete"):
            assert part in status
        assert "Recording" not in status
        line = pilot.text("StopBar").splitlines()[-1]
        for part in ("▶", "00:09 / 01:00", "●", "10:00:09 UTC", "1x", "? keys"):
            assert part in line
        assert len(line) == size[0]


async def test_the_line_has_a_sign_for_each_place_and_never_moves() -> None:
    async with watching(ReplayStart(paused=True)) as pilot:
        first = pilot.text("StopBar").splitlines()[-1]
        assert [sign for sign in first if sign in "◆▲■✎│"] == ["◆", "▲", "■", "✎", "│"]
        await pilot.press("end")
        last = pilot.text("StopBar").splitlines()[-1]
        assert [last.index(sign) for sign in "◆▲✎"] == [first.index(sign) for sign in "◆▲✎"]
        assert last.index("UTC") == first.index("UTC")


@pytest.mark.parametrize("look", [Appearance(ASCII, "woz-16"), Appearance(UNICODE, "woz-16")])
async def test_the_line_can_be_read_without_colours_and_in_ascii(look: Appearance) -> None:
    async with watching(ReplayStart(at_us=20 * SECOND, paused=True), look=look) as pilot:
        line = pilot.text("StopBar").splitlines()[-1]
        if look.glyphs.ascii:
            assert line.isascii()
            assert line.startswith(" || 00:20 / 01:00 ")
            assert [sign for sign in line if sign in "*!#nO|"][2:] == ["*", "!", "#", "O", "n", "|"]
        else:
            assert line.startswith(" ┃┃ 00:20 / 01:00 ")


async def test_space_stands_still_and_goes_on_and_nothing_ages_meanwhile() -> None:
    async with watching(ReplayStart(at_us=9 * SECOND)) as pilot:
        assert "▶ Go" in pilot.text("ActionPanels")
        await pilot.press("space")
        before = pilot.text("ActionPanels"), pilot.text("Meters"), pilot.text("StatusLines")
        await pilot.pass_time(60)
        assert (
            pilot.text("ActionPanels"),
            pilot.text("Meters"),
            pilot.text("StatusLines"),
        ) == before
        assert "┃┃ 00:09" in pilot.text("StopBar")
        await pilot.press("space")
        await pilot.pass_time(5)
        assert "▶  00:14" in pilot.text("StopBar")
        assert "✓ Go" in pilot.text("EventList")


@pytest.mark.parametrize(
    ("keys", "seconds"),
    [
        (["right"], 35),
        (["left"], 25),
        (["shift+right"], 60),
        (["alt+left"], 0),
        (["home"], 0),
        (["end"], 60),
        (["pageup"], 15),
        (["pagedown"], 50),
        (["pagedown", "pagedown"], 55),
        (["right", "left"], 30),
    ],
)
async def test_keys_move_through_the_log(keys: list[str], seconds: float) -> None:
    async with watching(ReplayStart(at_us=30 * SECOND, paused=True)) as pilot:
        await pilot.press(*keys)
        assert pilot.t == seconds * SECOND


@pytest.mark.parametrize(("keys", "rate"), [("]]", 4.0), ("[", 0.5), (">><", 2.0), ("[[[", 0.25)])
async def test_brackets_change_the_speed(keys: str, rate: float) -> None:
    async with watching() as pilot:
        await pilot.press(*keys)
        assert pilot.console.state.rate == rate
        assert f"{rate:g}x" in pilot.text("StopBar")


async def test_what_hurries_is_painted_less_often() -> None:
    """At 16x nearly all of the screen changes each time, which a slow line could not carry."""
    async with watching() as pilot:
        await pilot.press(*"]]]]")
        seen: list[str] = []
        for _ in range(16):
            pilot.clock.advance(0.1)
            await asyncio.to_thread(pilot.feed.tick)
            await pilot.settle()
            pilot.console.beat()  # the app's own timer keeps another time than the clock
            await pilot.settle()
            seen.append(pilot.text("StopBar"))
        changes = sum(before != after for before, after in itertools.pairwise(seen))
        assert 3 <= changes <= 4
        assert pilot.t == 16 * 1.6 * SECOND


async def test_a_dot_steps_and_says_to_which_line() -> None:
    async with watching(ReplayStart(at_us=5_900_000)) as pilot:
        await pilot.press(".")
        assert pilot.t == 6 * SECOND
        assert "00:06.000 marker" in pilot.text("StopBar")
        assert "┃┃" in pilot.text("StopBar")
        assert "Marker  smile" in pilot.text("EventList")


async def test_the_list_follows_many_steps_while_time_stands_still() -> None:
    async with watching(ReplayStart(paused=True)) as pilot:
        for _ in range(80):
            await pilot.press("left", "end")
        assert "Session ended" in pilot.text("EventList")
        await pilot.press("home")
        assert "Session ended" not in pilot.text("EventList")


async def test_an_action_of_then_lights_its_cap_up() -> None:
    async with watching(ReplayStart(at_us=2_500_000)) as pilot:
        await pilot.pass_time(0.6)
        panels = pilot.console._panels
        assert [text.strip() for row in panels.rows for text, look in row if look == "flash"] == [
            "h"
        ]
        await pilot.pass_time(1)
        assert not [look for row in panels.rows for _, look in row if look == "flash"]


async def test_the_page_of_an_action_of_then_is_shown() -> None:
    names = [f"Action {number}" for number in range(60)]
    panel = PanelView(title="All", actions=[ActionView(name=each, label=each) for each in names])
    plan = msgspec.structs.replace(PLAN, panels=[panel], script=[])
    action_requested = m.ActionRequested(run="a1", action="Action 59", source="key")
    told = stamped([(0, START), (0.2, plan), (3, action_requested), (60, m.Note(text="over"))])
    start = ReplayStart(at_us=2 * SECOND)
    async with watching(start, recording=recording_of(told)) as pilot:
        assert "Action 59" not in pilot.text("ActionPanels")
        await pilot.pass_time(2)
        assert "Action 59" in pilot.text("ActionPanels")


async def test_the_keys_of_the_session_are_shown_but_play_nothing() -> None:
    async with watching() as pilot:
        assert "h" in pilot.text("ActionPanels")
        await pilot.press("h")
        assert "h is not assigned" in pilot.text("StopBar")
        assert pilot.feed.asked == []


async def test_the_stop_of_then_is_seen_and_what_is_said_too() -> None:
    async with watching(ReplayStart(at_us=14_900_000, paused=True)) as pilot:
        await pilot.press(".")
        assert "stop.pressed" in pilot.text("StopBar")
        await pilot.pass_time(20)
        assert "STOPPED by key at 00:15" in pilot.text("StopBar")
        await pilot.press("escape")
        assert "the robot does not move" in pilot.text("StopBar")
        await pilot.press(".")
        await pilot.pass_time(20)
        assert "confirmed: robot" in pilot.text("StopBar")


@pytest.mark.parametrize("key", ["escape", "ctrl+c"])
async def test_escape_moves_nothing_says_so_and_closes_dialogs(key: str) -> None:
    async with watching() as pilot:
        await pilot.press("g")
        assert len(pilot.console.screen_stack) == 2
        await pilot.press(key)
        assert len(pilot.console.screen_stack) == 1
        assert "the robot does not move" in pilot.text("StopBar")
        assert not pilot.console.state.session.stop


async def test_ctrl_q_leaves_at_once() -> None:
    async with watching() as pilot:
        await pilot.press("ctrl+q")
        assert pilot.console.return_value == "left"


async def test_going_to_a_typed_time() -> None:
    async with watching(ReplayStart(paused=True)) as pilot:
        await pilot.press("g", *"0:42", "enter")
        assert pilot.t == 42 * SECOND
        assert pilot.console.dialog is None


async def test_going_to_a_place_that_is_found_by_its_letters() -> None:
    async with watching(ReplayStart(paused=True)) as pilot:
        await pilot.press("g")
        assert all(
            word in pilot.drawn() for word in ("smile", "Go too late", "stop by key", "trial 2")
        )
        await pilot.press(*"back")
        found = pilot.console.screen.query_one("#found", OptionList)
        assert found.option_count == 1
        await pilot.press("enter")
        assert pilot.t == 50 * SECOND


async def test_the_engagement_model_of_a_replay_is_told_in_words_and_not_taken_in_hand() -> None:
    changed = m.EngagementChanged(
        was="Wait", now="EngagedWithKnown", outcome="x", why="looks", verdicts={}
    )
    shown = engagement_scene.engagement_shown("EngagedWithKnown")
    began, *rest = story()
    lines = [began, *stamped([(4.0, changed), (4.1, shown)]), *rest]
    recording = recording_of(sorted(lines, key=lambda each: each.t))
    async with watching(ReplayStart(at_us=9 * SECOND, paused=True), recording=recording) as pilot:
        await pilot.press("g", *"known")
        assert "engaged, known" in pilot.drawn()
        assert "EngagedWithKnown" not in pilot.drawn()
        await pilot.press("ctrl+q", "=", "tab")
        assert "[engaged, known]" in pilot.drawn()
        assert "by hand" not in pilot.drawn().casefold()


async def test_the_list_of_places_begins_with_the_next_one() -> None:
    async with watching(ReplayStart(at_us=14 * SECOND, paused=True)) as pilot:
        await pilot.press("g", "down", "enter")
        assert pilot.t == 50 * SECOND


async def test_a_place_that_is_not_there() -> None:
    async with watching(ReplayStart(paused=True)) as pilot:
        await pilot.press("g", *"zzz", "enter")
        assert "there is no 'zzz' in this log" in pilot.text("StopBar")
        await pilot.press("g", *"9:99", "enter")
        assert "the session is 01:00 long" in pilot.text("StopBar")


async def test_help_shows_the_keys_of_the_replay() -> None:
    async with watching(size=(100, 60)) as pilot:
        await pilot.press("?")
        for part in ("stand still, go on", "5 s back", "twice the speed", "Hello"):
            assert part in pilot.drawn()
        assert "drive forward" not in pilot.drawn()
        assert "would do" not in pilot.drawn()


async def test_what_is_missing_is_in_the_header_and_can_be_read() -> None:
    async with watching(notes=("3 damaged line(s) left out",)) as pilot:
        assert "▲ log incomplete" in pilot.text("StatusLines")
        assert "This log: 3 damaged line(s)" in pilot.text("EventList")
        await pilot.press("i")
        for part in ("3 damaged line(s) left out", "guide.yaml", "W2", "x_S01.jsonl"):
            assert part in pilot.drawn()


async def test_idle_time_that_was_cut_is_shown() -> None:
    async with watching(ReplayStart(at_us=18 * SECOND, max_idle_us=4 * SECOND)) as pilot:
        await pilot.pass_time(4)
        assert "00:28 cut" in pilot.text("StopBar")


async def test_an_old_burst_of_keys_is_not_refused() -> None:
    async with watching(ReplayStart(paused=True)) as pilot:
        assert pilot.console.keyboard.arrive("right", stale=True)
        await pilot.settle()
        assert pilot.t == 5 * SECOND


async def test_a_code_is_typed_while_the_replay_stands_still_and_chosen_the_next_time(
    tmp_path: Path,
) -> None:
    coding = Coding(tmp_path / "x.coding.jsonl", "K1", START)
    recording = Recording(story(), KeptSamples(()), coded=True)
    async with watching(ReplayStart(at_us=4 * SECOND), recording=recording, coding=coding) as pilot:
        assert "CODER K1" in pilot.drawn()
        assert "hidden" in pilot.drawn()
        assert "warm" not in pilot.drawn()
        await pilot.press("m")
        await pilot.pass_time(3)
        assert pilot.t == 4 * SECOND
        await pilot.press(*"smiles", "enter")
        assert [(code.t, code.text) for code in coding.codes] == [(4 * SECOND, "smiles")]
        assert "Code of K1" in pilot.drawn()
        await pilot.pass_time(2)
        await pilot.press("m", "enter")
        assert [code.text for code in coding.codes] == ["smiles", "smiles"]
        await pilot.press("n", *"odd", "enter")
        assert coding.codes[-1].note
        await pilot.press("x")
        assert len(coding.codes) == 2
        await pilot.press("m", *"never", "ctrl+q")
        assert len(coding.codes) == 2
        before = pilot.t
        await pilot.pass_time(1)
        assert pilot.t > before, "it goes on"


@pytest.mark.parametrize("keys", [("space", "m"), ("space", "space", "m"), ("m",)])
async def test_the_replay_stands_still_while_a_code_is_typed_and_then_is_as_it_was(
    keys: tuple[str, ...],
) -> None:
    """However soon behind the pause: what the screen shows is older than the keys."""
    async with watching(ReplayStart(at_us=4 * SECOND)) as pilot:
        await pilot.pass_time(10)  # the greeting is gone: no key is a reason to paint any more
        await pilot.press(*keys)
        await pilot.pass_time(3)
        assert pilot.t == 14 * SECOND
        await pilot.press("ctrl+q")
        await pilot.pass_time(3)
        assert pilot.t == (14 if keys == ("space", "m") else 17) * SECOND


async def test_a_dialog_that_closes_at_once_lets_the_replay_go_on() -> None:
    async with watching(ReplayStart(at_us=4 * SECOND)) as pilot:
        for key in ("m", "escape"):
            pilot.console.post_message(Key(key, key_to_character(key)))
        await pilot.press()
        await pilot.pass_time(3)
        assert pilot.t == 7 * SECOND


async def test_what_is_typed_is_the_code_also_where_a_longer_one_was_set_before(
    tmp_path: Path,
) -> None:
    coding = Coding(tmp_path / "x.coding.jsonl", "K1", START)
    for at, text in ((1, "gaze: robot"), (2, "gaze:"), (3, "gaze: robot")):
        coding.add(at * SECOND, text)
    recording = Recording(story(), KeptSamples(()), coded=True)
    async with watching(ReplayStart(at_us=4 * SECOND), recording=recording, coding=coding) as pilot:
        await pilot.press("m", *"gaze:", "enter")
        assert max(coding.codes, key=lambda code: code.number).text == "gaze:"
        await pilot.press("m", *"gaze:", "down", "enter")
        assert max(coding.codes, key=lambda code: code.number).text == "gaze: robot"


async def test_a_note_that_a_full_disk_did_not_take_is_there_again(tmp_path: Path) -> None:
    coding = Coding(tmp_path / "x.coding.jsonl", "K1", START)
    full = os.open("/dev/full", os.O_WRONLY)
    os.dup2(full, coding._file)
    os.close(full)
    recording = Recording(story(), KeptSamples(()), coded=True)
    async with watching(recording=recording, coding=coding) as pilot:
        await pilot.press("n", *"odd", "enter")
        assert "No space left" in pilot.text("StopBar")
        await pilot.press("n")
        assert "odd" in pilot.drawn()


async def test_without_a_coder_the_keys_say_how_to_begin() -> None:
    async with watching() as pilot:
        await pilot.press("x")
        assert "--coder" in pilot.drawn()
