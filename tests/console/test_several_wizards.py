"""Several wizards on the screen: who plays what, which keys are somebody else's, who did what."""

from __future__ import annotations

import msgspec
import pytest
from rich.cells import cell_len

from tests.console import scenes, study_scene
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r

NOW = scenes.NOW


def console_attached(console: str, part: str, role: str = "wizard") -> m.ConsoleAttached:
    return m.ConsoleAttached(console=console, role=role, part=part, t=NOW)


def welcome(part: str, *others: m.ConsoleAttached, role: str = "wizard") -> r.Welcome:
    """The guide's session for the console `console1` that plays `part`: speech for the voice,
    gestures for the body.
    """
    state = [*scenes.healthy(), console_attached("console1", part, role), *others]
    first = scenes.welcome(state=state, role=role)
    parts = {"Speech": ["voice"], "Gestures": ["body"]}
    panels = [
        msgspec.structs.replace(panel, parts=parts.get(panel.title, [])) for panel in first.panels
    ]
    return msgspec.structs.replace(first, panels=panels, part=part)


def named(part: str) -> r.Welcome:
    """The same with another name for the other wizard's part."""
    first = welcome("voice", console_attached("con2", part))
    panels = [
        msgspec.structs.replace(panel, parts=[part]) if panel.parts == ["body"] else panel
        for panel in first.panels
    ]
    return msgspec.structs.replace(first, panels=panels)


def line_with(word: str, pilot: ConsolePilot, widget: str = "ActionPanels") -> str:
    return next(line for line in pilot.text(widget).splitlines() if word in line)


def locks(pilot: ConsolePilot, *actions: str) -> set[str]:
    """Those of these actions that are marked as locked."""
    glyph = pilot.console.look.glyphs.locked
    text = pilot.text("ActionPanels")
    return {each for each in actions if f"{glyph} {each}" in text}


async def test_the_other_wizards_panel_is_locked_and_says_whose_it_is() -> None:
    async with piloted_console(
        welcome("voice", console_attached("con2", "body")), size=(120, 40)
    ) as pilot:
        assert "body" in line_with("Gestures", pilot)
        assert "voice" not in line_with("Speech", pilot)
        assert locks(pilot, "Hello", "Nod", "Happy") == {"Nod"}
        top = pilot.text("StatusLines").splitlines()[0]
        assert " voice " in top
        assert "with body" in pilot.text("StatusLines")
        # What the other one plays is seen here, too.
        await pilot.tell(*scenes.played_action("a1", "Nod", NOW, None))
        assert "Nod" in pilot.text("EventList")
        assert locks(pilot, "Nod") == set()


@pytest.mark.parametrize("part", ["", "voice"])
async def test_a_wizard_with_a_part_reads_the_trial_at_80_columns(part: str) -> None:
    first = study_scene.welcome(study_scene.trial())
    async with piloted_console(msgspec.structs.replace(first, part=part)) as pilot:
        top = pilot.text("StatusLines").splitlines()[0]
        assert "trial 3/4 02:41" in top
        assert part in top


async def test_columns_stand_below_each_other_whatever_a_part_is_called() -> None:
    async with piloted_console(welcome("voice", console_attached("con2", "body"))) as pilot:
        there_was = [cell_len(line) for line in pilot.text("ActionPanels").splitlines()]
    async with piloted_console(named("身体动作")) as pilot:
        assert "身体" in pilot.text("ActionPanels")
        assert [cell_len(line) for line in pilot.text("ActionPanels").splitlines()] == there_was


async def test_what_nobody_else_plays_any_more_can_be_played_here() -> None:
    async with piloted_console(welcome("voice", console_attached("con2", "body"))) as pilot:
        lost = m.ConsoleLost(console="con2", role="wizard", why="closed", part="body", t=NOW)
        await pilot.tell(lost)
        assert locks(pilot, "Hello", "Nod") == set()
        assert "body" not in line_with("Gestures", pilot)
        assert "wizard body disconnected" in pilot.text("EventList")
        await pilot.tell(console_attached("con5", "body"))
        assert locks(pilot, "Hello", "Nod") == {"Nod"}
        assert "wizard body attached" in pilot.text("EventList")


async def test_events_name_the_other_wizard() -> None:
    async with piloted_console(
        welcome("voice", console_attached("con2", "body")), size=(120, 40)
    ) as pilot:
        for run, console, action in (("a1", "con2", "Nod"), ("a2", "console1", "Hello")):
            action_requested = m.ActionRequested(
                run=run, action=action, source="key", console=console, t=NOW
            )
            await pilot.tell(action_requested)
        assert "body" in line_with("Nod", pilot, "EventList")
        assert "voice" not in line_with("Hello", pilot, "EventList")
        assert "body" not in line_with("Hello", pilot, "EventList")


async def test_trials_and_the_stop_name_the_other_wizard() -> None:
    async with piloted_console(
        welcome("voice", console_attached("con2", "body")), size=(120, 40)
    ) as pilot:
        await pilot.tell(
            m.TrialStarted(trial=1, console="console1", t=NOW),
            m.TrialEnded(trial=1, outcome="done", console="con2", t=NOW),
            m.StopPressed(source="key", console="con2", t=NOW),
        )
        assert "body" not in line_with("begins", pilot, "EventList")
        assert "body" in line_with("Trial 1 done", pilot, "EventList")
        assert "STOPPED by body" in pilot.text("StopBar")


async def test_what_is_refused_to_the_other_wizard_is_on_the_list_and_on_no_button() -> None:
    async with piloted_console(
        welcome("voice", console_attached("con2", "body")), size=(120, 40)
    ) as pilot:
        for run, console, action in (("a1", "con2", "Hello"), ("a2", "console1", "Welcome")):
            await pilot.tell(
                m.ActionRequested(run=run, action=action, source="key", console=console, t=NOW),
                m.ActionRefused(run=run, action=action, reason="why not", t=NOW),
            )
        assert "refused" in line_with("Welcome", pilot)
        assert "refused" not in line_with("Hello", pilot)
        assert "body: why not" in line_with("Hello", pilot, "EventList")


async def test_who_watches_for_a_part_is_told_when_nobody_plays_it() -> None:
    voice = console_attached("con2", "voice")
    first = welcome("voice", voice, console_attached("con3", "body"), role="watcher")
    async with piloted_console(first) as pilot:
        assert "WATCHING voice" in pilot.text("StatusLines")
        assert locks(pilot, "Hello", "Nod") == set()
        await pilot.tell(m.ConsoleLost(console="con2", role="wizard", why="closed", t=NOW))
        assert "NOBODY PLAYS voice" in pilot.text("StatusLines")
        assert "Nobody plays voice. End" in pilot.text("StopBar")
        await pilot.press("end")
        assert isinstance(pilot.feed.asked[-1], r.AskTakeOver)
        await pilot.tell(console_attached("console1", "voice"))
        assert "NOBODY PLAYS" not in pilot.drawn()
        assert locks(pilot, "Hello", "Nod") == {"Nod"}


async def test_one_wizard_sees_nothing_of_parts() -> None:
    async with piloted_console(welcome("")) as pilot:
        assert locks(pilot, "Hello", "Nod", "Happy") == set()
        assert not {"voice", "body", "with"} & {*pilot.text("ActionPanels").split()}
        assert "with" not in pilot.text("StatusLines").split()


def two_robots() -> r.Welcome:
    """The wizard of `left`; another one, console `con2`, plays `right`, which comes first."""
    first = welcome("voice", console_attached("con2", "body"))
    each = (("left", "voice"), ("right", "body"))
    panels = [
        msgspec.structs.replace(panel, parts=[part], covers=covers)
        for panel, (robot, part) in zip(first.panels, each, strict=False)
        for covers in ([f"{robot}.{verb}" for verb in ("nudge", "say", "play")],)
    ]
    verbs = {f"{robot}.body": ["nudge", "say", "play"] for robot in ("right", "left")}
    return msgspec.structs.replace(first, panels=panels, verbs=verbs, drivers=[*verbs])


OTHER_WIZARD_LOST = m.ConsoleLost(console="con2", role="wizard", why="closed", part="body", t=NOW)


async def test_arrows_move_ones_own_robot_as_long_as_others_play_the_other() -> None:
    async with piloted_console(two_robots()) as pilot:
        await pilot.press("up")
        asked = pilot.feed.asked[-1]
        assert isinstance(asked, r.AskVerb)
        assert (asked.verb, asked.on) == ("nudge", "left.body")
        await pilot.press("slash")
        assert "voice: left.body" in pilot.drawn()
        await pilot.press("ctrl+q")
        await pilot.tell(OTHER_WIZARD_LOST)
        sent = len(pilot.feed.asked)
        await pilot.press("up")
        assert len(pilot.feed.asked) == sent
        assert "right, left: use a" in pilot.text("StopBar")


@pytest.mark.parametrize(("key", "named"), [("slash", "voice"), ("percent_sign", "robot")])
async def test_the_robot_that_a_dialog_names_gets_the_text_whoever_comes_and_goes(
    key: str, named: str
) -> None:
    async with piloted_console(two_robots()) as pilot:
        for robot, told in (
            ("left.body", OTHER_WIZARD_LOST),
            ("right.body", console_attached("con5", "body")),
        ):
            await pilot.press(key)
            assert f"{named}: {robot}" in pilot.drawn()
            await pilot.type("hi")
            await pilot.tell(told)
            await pilot.press("enter")
            asked = pilot.feed.last(r.AskVerb)
            assert isinstance(asked, r.AskVerb)
            assert asked.on == robot
