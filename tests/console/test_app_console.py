from __future__ import annotations

import asyncio
import subprocess
import sys
from dataclasses import replace

import pytest
from msgspec.structs import replace as replace_fields
from textual import events
from textual.widgets import OptionList

from tests.console import scenes
from tests.console.dialogs import open_dialog
from tests.console.piloting import piloted_console
from woz_tui.config.keys.console_keys import BUILTIN_KEYS
from woz_tui.config.keys.terminals import KITTY
from woz_tui.console.drawing.glyphs import ASCII
from woz_tui.console.drawing.theme import Appearance
from woz_tui.console.screen_app import PAINT_S
from woz_tui.features.scripts.kinds import AskScript
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView

NOW = scenes.NOW


@pytest.mark.parametrize("size", [(80, 24), (100, 36), (160, 50), (240, 70)])
async def test_the_whole_session_is_on_the_screen(size: tuple[int, int]) -> None:
    first = scenes.welcome(
        state=[*scenes.healthy(), *scenes.sensors()],
        recent=[*scenes.history(), *scenes.speaking()],
    )
    async with piloted_console(first, size=size) as pilot:
        drawn = pilot.drawn()
        for part in ("Museum guide", "P07", "● Recording", "● head", "Speech", "Restorat"):
            assert part in drawn
        for part in ("▶ Map", "0.84 m personal", "2.1 s left", "▸ Map", "Esc stop"):
            assert part in drawn
        assert all(len(line) <= size[0] for line in drawn.splitlines())


async def test_before_the_welcome_it_says_that_it_waits() -> None:
    async with piloted_console(r.Pulse(t=5)) as pilot:
        assert "Waiting for the robot process" in pilot.text("ActionPanels")
        await pilot.tell(scenes.welcome())
        assert "Hello" in pilot.text("ActionPanels")


@pytest.mark.parametrize("size", [(79, 24), (60, 20)])
async def test_a_small_terminal_keeps_panels_and_stop_and_says_what_is_missing(
    size: tuple[int, int],
) -> None:
    async with piloted_console(size=size) as pilot:
        drawn = pilot.drawn()
        assert "80 x 24" in drawn
        assert "Hello" in drawn
        assert "Esc stop" in drawn
        await pilot.tell(m.StopPressed(source="key", t=NOW))
        assert "STOPPED by key" in pilot.drawn()


@pytest.mark.parametrize("size", [(30, 8), (12, 4), (49, 24), (200, 11)])
async def test_a_tiny_terminal_shows_a_sentence_and_the_stop(size: tuple[int, int]) -> None:
    async with piloted_console(size=size) as pilot:
        await pilot.tell(m.StopPressed(source="key", t=NOW))
        drawn = pilot.drawn()
        assert "STOPPED" in drawn
        assert f"{size[0]} x {size[1]}"[:8] in drawn
        await pilot.press("h")
        assert isinstance(pilot.feed.asked[-1], r.AskAction)


async def test_growing_and_shrinking() -> None:
    async with piloted_console(size=(60, 20)) as pilot:
        for size in ((160, 50), (80, 24), (60, 20), (80, 24)):
            await pilot.pilot.resize_terminal(*size)
            await pilot.pass_time(0.2)
            assert ("80 x 24" in pilot.drawn()) is (size == (60, 20))
            assert "Hello" in pilot.drawn()


async def test_a_key_plays_its_action_and_its_cap_lights_up() -> None:
    async with piloted_console() as pilot:
        await pilot.press("h")
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert (asked.action, asked.source, asked.key) == ("Hello", "key", "h")
        panels = pilot.console._panels
        flashing = [text for row in panels.rows for text, look in row if look == "flash"]
        assert [text.strip() for text in flashing] == ["h"]
        await pilot.pass_time(1.0)
        assert not [look for row in panels.rows for _, look in row if look == "flash"]


async def test_sequences_wait_for_their_second_key() -> None:
    async with piloted_console() as pilot:
        await pilot.press("c")
        assert "c … waits for its second key" in pilot.text("StopBar")
        await pilot.press("r")
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "Restoration room"


async def test_a_key_without_meaning_says_so() -> None:
    async with piloted_console() as pilot:
        await pilot.press("z")
        assert "z is not assigned" in pilot.text("StopBar")
        await pilot.pass_time(30)
        assert "is not assigned" not in pilot.text("StopBar")


async def test_what_was_told_of_a_key_goes_with_the_next_one_and_hides_no_stop() -> None:
    async with piloted_console() as pilot:
        await pilot.press("z")
        assert "z is not assigned" in pilot.text("StopBar")
        assert "Esc stop" in pilot.text("StopBar")
        await pilot.press("h")
        assert "is not assigned" not in pilot.text("StopBar")


async def test_what_a_driver_refused_is_told_until_its_state_changes() -> None:
    refused = m.Refused(
        command="c-a1",
        driver="voice",
        code="not_ready",
        reason="it is starting " * 4,
        remedy="wait",
    )
    async with piloted_console() as pilot:
        await pilot.press("h")
        await pilot.tell(*scenes.played_action("a1", "Hello", NOW, None), refused)
        shown = pilot.text("StopBar")
        assert "it is starting" in shown
        assert "Esc stop" in shown
        await pilot.tell(m.DriverConnected(driver="head"))
        assert "it is starting" in pilot.text("StopBar")
        await pilot.tell(m.DriverConnected(driver="voice"))
        assert "it is starting" not in pilot.text("StopBar")


@pytest.mark.parametrize(
    ("key", "lacks"), [("up", "head that can turn (gaze)"), ("alt+up", "drive")]
)
async def test_an_arrow_that_no_driver_has_a_use_for_says_so(key: str, lacks: str) -> None:
    async with piloted_console() as pilot:
        await pilot.press(key)
        assert pilot.feed.asked == []
        assert f"This robot has no {lacks}" in pilot.text("StopBar")


async def test_an_arrow_that_several_robots_could_follow_names_them() -> None:
    verbs = {"nao.nao": ["drive"], "ros.turtlebot": ["drive"], "furhat.furhat": ["nudge"]}
    first = replace_fields(scenes.welcome(), verbs=verbs, drivers=[*verbs])
    async with piloted_console(first) as pilot:
        await pilot.press("alt+up")
        assert pilot.feed.asked == []
        assert "nao, ros: use a button" in pilot.text("StopBar")
        await pilot.press("up")
        assert pilot.feed.last(r.AskVerb) is not None
        await pilot.press("shift+up")
        assert "No robot here has a hip" in pilot.text("StopBar")


async def test_what_is_refused_is_told_while_the_robot_is_stopped() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[r.AskMarker] = lambda asked, ref: r.Reply(
            ref=ref, ok=False, reason="no participant is set"
        )
        await pilot.press("z")
        await pilot.tell(m.StopPressed(source="key", t=NOW))
        await pilot.press("full_stop")
        assert "waiting for the drivers" in pilot.text("StopBar")
        await pilot.tell(m.StopConfirmed(confirmed=["head"], missing=[], elapsed_us=3_000))
        await pilot.press("full_stop")
        assert "STOPPED by key" in pilot.text("StopBar")
        assert "no participant is set" in pilot.text("StopBar")
        await pilot.pass_time(30)
        assert "confirmed: head" in pilot.text("StopBar")
        await pilot.press("full_stop")
        await pilot.tell(m.StopReleased(source="key", t=NOW))
        assert "no participant is set" not in pilot.text("StopBar")


async def test_who_did_not_confirm_the_stop_is_named_whatever_else_is_told() -> None:
    async with piloted_console() as pilot:
        await pilot.press("z")
        missing = m.StopConfirmed(confirmed=["head"], missing=["voice"], elapsed_us=3_000)
        await pilot.tell(m.StopPressed(source="key", t=NOW), missing)
        assert "NOT CONFIRMED: voice" in pilot.text("StopBar")
        await pilot.press("z")
        assert "NOT CONFIRMED: voice" in pilot.text("StopBar")


@pytest.mark.parametrize("key", ["escape", "ctrl+c"])
async def test_both_stop_keys_stop_and_the_bar_follows(key: str) -> None:
    async with piloted_console() as pilot:
        await pilot.press(key)
        asked = pilot.feed.last(r.AskStop)
        assert asked is not None
        await pilot.until(lambda: "STOP SENT" in pilot.text("StopBar"))
        await pilot.tell(m.StopPressed(source="key", t=NOW))
        assert "STOPPED by key" in pilot.text("StopBar")
        await pilot.tell(m.StopConfirmed(confirmed=["head"], missing=[], elapsed_us=3_000))
        await pilot.press("ctrl+r")
        assert pilot.feed.last(r.AskRelease) is not None
        await pilot.tell(m.StopReleased(source="key", t=NOW))
        assert "STOP" not in pilot.text("StopBar")
        assert pilot.console.is_running


async def test_a_stop_that_is_released_at_once_does_not_stay_on_the_bar() -> None:
    async with piloted_console() as pilot:
        await pilot.press("escape")
        await pilot.until(lambda: "STOP SENT" in pilot.text("StopBar"))
        await pilot.tell(m.StopPressed(source="key", t=NOW), m.StopReleased(source="key", t=NOW))
        assert "STOP" not in pilot.text("StopBar")


async def test_keys_of_the_console_without_dialogs() -> None:
    async with piloted_console() as pilot:
        await pilot.press("full_stop", "backspace")
        kinds = [type(asked) for asked in pilot.feed.asked]
        assert kinds == [r.AskMarker, r.AskMistake]


async def test_the_last_run_can_be_cut_short() -> None:
    async with piloted_console() as pilot:
        await pilot.press("ctrl+x")
        assert "No action is running" in pilot.text("StopBar")
        await pilot.tell(*scenes.speaking())
        await pilot.press("ctrl+x")
        asked = pilot.feed.last(r.AskCancel)
        assert isinstance(asked, r.AskCancel)
        assert asked.run == "a9"


@pytest.mark.parametrize(("on", "back"), [("tab", "shift+tab"), ("pagedown", "pageup")])
async def test_page_keys_turn_the_pages(on: str, back: str) -> None:
    async with piloted_console(scenes.welcome(shown=scenes.many_panels(60))) as pilot:
        assert "Action 0 " in pilot.text("ActionPanels")
        await pilot.press(on)
        assert "Action 0 " not in pilot.text("ActionPanels")
        assert "page 2" in pilot.text("StopBar")
        await pilot.press(back)
        assert "Action 0 " in pilot.text("ActionPanels")
        await pilot.press(back)
        assert "Action 59" in pilot.text("ActionPanels")
        await pilot.press(on)
        assert "Action 0 " in pilot.text("ActionPanels")


async def test_a_panel_of_many_pages_is_seen_whole() -> None:
    (panel,) = scenes.many_panels(10)
    many = [action for each in scenes.many_panels(90) for action in each.actions]
    shown = [replace_fields(panel, actions=many), scenes.panels()[0]]
    async with piloted_console(scenes.welcome(shown=shown)) as pilot:
        seen = ""
        for page in (1, 2, 3, 1):
            seen += pilot.text("ActionPanels")
            assert f"page {page}/3" in pilot.text("StopBar")
            await pilot.press("tab")
        assert all(f"Action {number} " in seen for number in range(90))
        assert "Goodbye" in seen
        await pilot.press("shift+tab", "shift+tab")
        assert "page 3/3" in pilot.text("StopBar")
        await pilot.press("shift+tab")
        pilot.console.terminal_found(KITTY)  # the caps are made anew
        await pilot.settle()
        assert "page 2/3" in pilot.text("StopBar")


async def test_the_first_alt_chord_of_a_plain_terminal_is_explained_once() -> None:
    async with piloted_console() as pilot:
        for _ in range(2):
            pilot.console.keyboard.on_alt()
            await pilot.settle()
        told = [event for event in pilot.console.state.events if "alt" in event.text]
        assert len(told) == 1
        assert told[0].text[:20] in pilot.text("EventList")


async def test_a_refusal_is_shown_where_the_hints_are() -> None:
    async with piloted_console() as pilot:
        pilot.feed.answers[AskScript] = lambda _, ref: r.Reply(
            ref=ref, ok=False, reason="the script has no more lines"
        )
        await pilot.press("space")
        await pilot.until(lambda: "the script has no more lines" in pilot.text("StopBar"))


async def test_a_refusal_names_the_key_that_helps_as_it_is_bound_here() -> None:
    moved = [replace(key, chord="ctrl+n") if key.id == "start" else key for key in BUILTIN_KEYS]
    async with piloted_console(builtins=moved) as pilot:
        pilot.feed.answers[AskScript] = lambda _, ref: r.Reply(
            ref=ref, ok=False, reason="nobody", hint="choose", command="start"
        )
        await pilot.press("space")
        await pilot.until(lambda: "nobody; press ^N to choose" in pilot.text("StopBar"))


async def test_messages_in_a_burst_are_painted_at_most_ten_times_a_second() -> None:
    async with piloted_console() as pilot:
        painted = 0
        paint = pilot.console.paint

        def counted() -> None:
            nonlocal painted
            painted += 1
            paint()

        pilot.console.paint = counted  # type: ignore[method-assign]
        loop = asyncio.get_running_loop()
        begun = loop.time()
        pilot.clock.advance(1.0)
        for number in range(200):
            await pilot.tell_quietly(scenes.reading(NOW, "distance", number / 100))
        assert painted <= (loop.time() - begun) / PAINT_S + 2
        assert painted < 200
        await pilot.pass_time(0.2)
        assert "1.99 m" in pilot.text("Meters")


async def test_only_changed_cells_are_painted(monkeypatch: pytest.MonkeyPatch) -> None:
    first = scenes.welcome(state=[*scenes.healthy(), *scenes.sensors()])
    async with piloted_console(first) as pilot:
        regions: list[object] = []
        panels = pilot.console._panels
        monkeypatch.setattr(panels, "refresh", lambda *found: regions.extend(found))
        await pilot.tell(scenes.reading(NOW, "distance", 2.0))
        assert regions == []
        await pilot.tell(*scenes.played_action("x1", "Nod", NOW, None))
        assert len(regions) == 1


async def test_a_reload_rebinds_the_keys() -> None:
    async with piloted_console() as pilot:
        action = ActionView(name="New", label="New one", key="h")
        panels_changed = r.PanelsChanged(
            title="Guide 2",
            panels=[PanelView(title="Only", actions=[action])],
            script=[],
            verbs={},
            conditions=[],
            keyboard="us",
        )
        await pilot.tell(panels_changed)
        assert "New one" in pilot.text("ActionPanels")
        assert "Hello" not in pilot.text("ActionPanels")
        await pilot.press("h")
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "New"


async def test_what_cannot_arrive_has_a_reserve_key_that_plays() -> None:
    async with piloted_console() as pilot:
        cap = pilot.console.caps["Call staff"]
        assert cap.reserve
        assert f"{cap.chord}*" in pilot.text("ActionPanels")
        await pilot.press(cap.chord)
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "Call staff"


async def test_a_watcher_is_told_that_it_watches() -> None:
    wizard = m.ConsoleAttached(console="con2", role="wizard", t=NOW)
    first = scenes.welcome(state=[*scenes.healthy(), wizard], role="watcher")
    async with piloted_console(first) as pilot:
        assert "WATCHING" in pilot.text("StatusLines")


async def test_the_lines_state_is_the_feeds() -> None:
    async with piloted_console(size=(120, 36)) as pilot:
        pilot.feed.round_trip_us = 61_000
        await pilot.pass_time(1.1)
        assert "connection 61 ms" in pilot.text("StatusLines")
        pilot.feed.line_ok = False
        await pilot.pass_time(1.1)
        assert "TERMINAL STALLED" in pilot.text("StatusLines")


async def test_ascii_and_sixteen_colours_for_the_linux_console() -> None:
    first = scenes.welcome(
        state=[*scenes.healthy(), *scenes.sensors()],
        recent=[*scenes.history(), *scenes.speaking()],
    )
    async with piloted_console(first, look=Appearance(ASCII, "woz-16")) as pilot:
        assert pilot.drawn().isascii()
        for key in ("question_mark", "colon", "comma", "ctrl+q"):
            await pilot.press(key)
            assert pilot.drawn().isascii()
            await pilot.press("ctrl+q")


async def test_no_colour_means_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    first = scenes.welcome(state=[*scenes.healthy(), m.StopPressed(source="key", t=NOW)])
    async with piloted_console(first, look=Appearance(ASCII, "woz-16")) as pilot:
        state = pilot.console.export_screenshot()
        assert "STOPPED" in state.replace("&#160;", " ")
        strips = pilot.console.screen._compositor.render_strips()
        colours = {
            colour.name
            for strip in strips
            for segment in strip.apply_filter(
                pilot.console._filters[-1], pilot.console.screen.background_colors[1]
            )
            if segment.style is not None
            for colour in (segment.style.color, segment.style.bgcolor)
            if colour is not None
        }
        assert colours == {"default"}


async def test_without_colours_the_chosen_line_of_a_list_is_told_by_its_look(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    async with piloted_console(look=Appearance(ASCII, "woz-16")) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.press("down")
        found = pilot.console.screen.query_one("#found", OptionList)
        chosen = [
            number
            for number in range(found.size.height)
            if any(
                each.style is not None and each.style.underline
                for each in found.render_line(number)
            )
        ]
        assert chosen == [1]


async def test_themes_change_while_it_runs() -> None:
    async with piloted_console() as pilot:
        for theme in ("woz-light", "woz-16", "woz-dark"):
            pilot.console.theme = theme
            await pilot.pilot.pause()
            assert "Hello" in pilot.drawn()


async def test_leaving_closes_the_feed() -> None:
    async with piloted_console() as pilot:
        pilot.console.exit("detached")
        await pilot.pilot.pause()
    assert pilot.feed.closed


async def test_what_comes_while_it_ends_is_not_painted() -> None:
    """Its parts go one after the other: whoever looked for them would miss one."""
    async with piloted_console() as pilot:
        ending = asyncio.create_task(pilot.console._shutdown())
        while not ending.done():  # at every turn of the way out
            pilot.clock.advance(1.0)
            pilot.console._main_screen.body._laid_out = None  # as if something needed more room now
            pilot.console.beat()
            await asyncio.sleep(0)
        await ending


def test_the_console_loads_neither_numpy_nor_any_dialog() -> None:
    code = (
        "import sys, woz_tui.console.app\n"
        "bad = [n for n in sys.modules if n in ('numpy', 'serial', 'dynamixel_sdk')]\n"
        "bad += [n for n in sys.modules if n.startswith('woz_tui.console.screens.')]\n"
        "bad.remove('woz_tui.console.screens.dialog')\n"
        "sys.exit(', '.join(bad) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


async def test_a_terminal_that_tells_more_keys_apart_is_bound_anew() -> None:
    async with piloted_console(size=(160, 50)) as pilot:
        assert "^1" not in pilot.text("ActionPanels")
        await pilot.press("tab")
        pilot.console.terminal_found(KITTY)
        assert "^1" in pilot.text("ActionPanels")
        assert "▸ Gestures" in pilot.text("ActionPanels")


async def test_a_press_tells_how_long_it_waited_for_the_screen() -> None:
    async with piloted_console() as pilot:
        key = events.Key("h", "h")
        key.time -= 0.25
        pilot.console.post_message(key)
        await pilot.until(lambda: pilot.feed.last(r.AskAction) is not None)
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.age_us >= 250_000


async def test_a_press_of_which_the_robot_does_nothing_is_not_shown_as_done() -> None:
    blue = ActionView(name="Blue", label="Blue", key="b", without=["eyes"])
    shown = [PanelView(title="Colours", actions=[blue])]
    requested = m.ActionRequested(
        run="a1", action="Blue", source="key", key="b", without=["eyes"], t=NOW
    )
    action_done = m.ActionDone(
        run="a1", action="Blue", reason="left out: this robot has no eyes", t=NOW
    )
    async with piloted_console(scenes.welcome(shown=shown), size=(120, 30)) as pilot:
        await pilot.tell(requested, action_done)
        for part in ("ActionPanels", "EventList"):
            assert "Blue" in pilot.text(part)
            assert "✓ Blue" not in pilot.text(part)
        assert "○ Blue" in pilot.text("EventList")
        assert "left out: this robot has no eyes" in pilot.text("EventList")
        assert "left out" in pilot.text("ActionPanels")
