from __future__ import annotations

import msgspec
import pytest

from tests.console import scenes
from tests.console.dialogs import open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.console.drawing.glyphs import ASCII, UNICODE, Glyphs, PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.status_rows import StatusInfo, status_rows
from woz_tui.features.profiles.console import ProfileList
from woz_tui.features.profiles.kinds import AskProfile, ProfileChanged
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.welcome import Allowance

pytestmark = pytest.mark.toolkit("U3")

NOW = scenes.NOW
SIZES = pytest.mark.parametrize("size", [(80, 24), (160, 50)])
ALLOWS: dict[str, m.Json] = {
    "child": {"panels": ["Speech"], "controls": ["neck"], "verbs": ["play"], "hide": True},
    "adult": {"actions": ["Nod", "Bow"]},
}


def guide(current: str = "", names: tuple[str, ...] = ("child", "adult")) -> r.Welcome:
    settings: dict[str, m.Json] = {"profile": current, "profiles": [*names], "allows": ALLOWS}
    return scenes.welcome(settings=settings)


def panels_changed(current: str, names: tuple[str, ...] = ("child", "adult")) -> r.PanelsChanged:
    """What everybody gets after a change: only Speech is left open."""
    panels = [
        panel if panel.title == "Speech" else msgspec.structs.replace(panel, locked=bool(current))
        for panel in scenes.panels()
    ]
    return r.PanelsChanged(
        title="Museum guide",
        panels=panels,
        script=["Hello"],
        verbs={"voice": ["say"]},
        conditions=["warm", "cold"],
        keyboard="us",
        profiles=[*names],
        profile=current,
        allows=msgspec.convert(ALLOWS, dict[str, Allowance]),
    )


def profile_requests(pilot: ConsolePilot) -> list[AskProfile]:
    return [request for request in pilot.feed.asked if isinstance(request, AskProfile)]


def line_of(pilot: ConsolePilot, name: str) -> str:
    """The dialog's line that begins with a profile's name."""
    lines = [line.partition("│")[2] for line in pilot.drawn().splitlines()]
    [found] = [line for line in lines if f" {name}  " in line]
    return found


@SIZES
async def test_the_list_tells_what_each_allows_and_which_is_in_use(size: tuple[int, int]) -> None:
    async with piloted_console(guide("child"), size=size) as pilot:
        await open_dialog(pilot, "ProfileDialog")
        drawn = pilot.drawn()
        rows = [drawn.index(line_of(pilot, name)) for name in ("everything", "child", "adult")]
        assert rows == sorted(rows)
        assert "● in use  child " in line_of(pilot, "child")
        assert "panels: Speech; knobs: neck; " in line_of(pilot, "child")
        assert "the rest is hidden" in drawn
        assert "actions: Nod, Bow" in line_of(pilot, "adult")
        assert drawn.count("in use") == 1


@SIZES
async def test_a_profile_is_chosen_and_stands_in_the_top_line(size: tuple[int, int]) -> None:
    async with piloted_console(guide(), size=size) as pilot:
        before = pilot.text("StatusLines").splitlines()[0]
        assert "child" not in before
        await open_dialog(pilot, "ProfileDialog")
        await pilot.press("down", "enter")
        assert pilot.console.dialog is None
        assert [(one.profile, one.source) for one in profile_requests(pilot)] == [("child", "key")]
        await pilot.tell(ProfileChanged(profile="child", t=NOW), panels_changed("child"))
        after = pilot.text("StatusLines").splitlines()[0]
        assert ("◇ profile child" if size[0] >= 100 else "◇ child") in after
        for part in ("Museum guide", "P07", "warm", "trial 3", "Recording"):
            assert after.index(part) == before.index(part), "nothing moves"
        assert "Gestures locked" in pilot.text("ActionPanels")
        assert "Profile child" in pilot.text("EventList")
        await open_dialog(pilot, "ProfileDialog")
        await pilot.press("up", "enter")
        assert profile_requests(pilot)[-1].profile == ""
        await pilot.tell(ProfileChanged(profile="", t=NOW), panels_changed(""))
        assert pilot.text("StatusLines").splitlines()[0] == before


async def test_enter_after_a_slip_changes_nothing() -> None:
    for current in ("", "adult"):
        async with piloted_console(guide(current)) as pilot:
            await open_dialog(pilot, "ProfileDialog")
            await pilot.press("enter")
            assert pilot.console.dialog is None
            assert profile_requests(pilot) == []


async def test_a_refusal_is_shown() -> None:
    async with piloted_console(guide("child")) as pilot:
        pilot.feed.answers[AskProfile] = lambda request, ref: r.Reply(
            ref=ref, ok=False, reason="you are watching", hint="take over"
        )
        await open_dialog(pilot, "ProfileDialog")
        await pilot.press("up", "enter")
        await pilot.until(lambda: "you are watching; take over" in pilot.text("StopBar"))
        assert "child" in pilot.text("StatusLines")


async def test_it_is_found_by_typing() -> None:
    async with piloted_console(guide()) as pilot:
        await open_dialog(pilot, "FindDialog")
        await pilot.type("profile")
        await pilot.press("enter")
        assert type(pilot.console.dialog).__name__ == "ProfileDialog"


async def test_the_help_lists_its_key() -> None:
    async with piloted_console(guide(), size=(160, 120)) as pilot:
        await open_dialog(pilot, "HelpDialog")
        assert any(
            line.split("│")[1].split()[:3] == ["-", "choose", "the"]
            for line in pilot.drawn().splitlines()
            if "choose the profile" in line
        )


async def test_the_mark_follows_while_the_list_is_open() -> None:
    async with piloted_console(guide()) as pilot:
        await open_dialog(pilot, "ProfileDialog")
        assert "in use" in line_of(pilot, "everything")
        await pilot.tell(ProfileChanged(profile="adult", source="program", t=NOW))
        await pilot.tell(panels_changed("adult"))
        assert "in use" in line_of(pilot, "adult")
        assert "in use" not in line_of(pilot, "everything")
        await pilot.press("enter")  # it still stands on the first line
        assert profile_requests(pilot)[-1].profile == ""


async def test_a_file_without_profiles_says_so() -> None:
    async with piloted_console() as pilot:
        await open_dialog(pilot, "ProfileDialog")
        assert "names no profiles" in pilot.drawn()
        assert "in use  everything" in pilot.drawn()


async def test_one_that_has_gone_from_the_file_is_still_in_use() -> None:
    async with piloted_console(guide("child", ("adult",))) as pilot:
        await open_dialog(pilot, "ProfileDialog")
        assert "in use" in line_of(pilot, "child")
        assert "not in the file any more" in line_of(pilot, "child")


async def test_a_refused_press_says_so_at_the_button_the_event_and_the_bar() -> None:
    reason = "'Nod' is not in the profile child"
    async with piloted_console(guide("child"), size=(160, 50)) as pilot:
        await pilot.tell(panels_changed("child"))
        pilot.feed.answers[r.AskAction] = lambda request, ref: r.Reply(
            ref=ref, ok=False, reason=reason
        )
        await pilot.press("1")
        await pilot.tell(
            m.ActionRequested(run="a1", action="Nod", source="key", t=NOW),
            m.ActionRefused(run="a1", action="Nod", reason=reason, t=NOW),
        )
        assert "⊘ Nod" in pilot.text("ActionPanels")
        assert reason in pilot.text("EventList")
        assert reason in pilot.text("StopBar")


@pytest.mark.parametrize("glyphs", [UNICODE, ASCII])
@pytest.mark.parametrize("width", [60, 80, 100, 160])
def test_long_names_leave_room_for_time_and_recorder(width: int, glyphs: Glyphs) -> None:
    state = ConsoleState()
    first = guide("those who are here for the first time" * 3)
    state.apply([msgspec.structs.replace(first, title="A title " * 12)], 0)
    frame = PaintFrame(width, 2, NOW, glyphs)
    [top, _] = status_rows(state, frame, StatusInfo())
    text = "".join(piece for piece, _ in top)
    assert len(text) == width
    for part in ("12:31", "those who", "ecording", "connect"):
        assert part in text
    assert glyphs is UNICODE or text.isascii()


def test_a_profiles_name_is_cut_only_where_there_is_no_room() -> None:
    state = ConsoleState()
    state.apply([guide("the first afternoon")], 0)
    for width, shown in ((160, "profile the first afternoon  "), (72, "the first aft")):
        [top, _] = status_rows(state, PaintFrame(width, 2, NOW), StatusInfo())
        assert shown in "".join(piece for piece, _ in top)


def test_a_profile_of_which_nothing_is_known_has_no_words() -> None:
    assert ProfileList("", ("a",), {}).words("a") == ""
