"""Phases on the screen: the status line, panels that fold away, the key and the list."""

from __future__ import annotations

import dataclasses
from typing import Any

import msgspec
import pytest
from msgspec.structs import replace

from tests.console import scenes
from tests.console.dialogs import open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from tests.console.still_feed import StillFeed
from woz_tui.console.commands import COMMANDS, by_key
from woz_tui.console.input.keyboard import HELD_US, Keyboard
from woz_tui.features.phases.kinds import AskPhase, PhaseChanged
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.system.clock import ManualClock

NOW = scenes.NOW
SIZES = pytest.mark.parametrize("size", [(80, 24), (160, 50)])
PHASES = [
    {"name": "opening", "title": "Opening", "panels": ["Speech"], "script": ["Hello", "Nod"]},
    {
        **{"name": "ride", "title": "The ride", "panels": ["Gestures"], "after": ["opening"]},
        **{"planned": 120.0},
    },
    {"name": "end", "after": ["ride"]},
]


def guide(**settings: Any) -> r.Welcome:
    return scenes.welcome(settings={"phases": PHASES, **settings})


def begins(phase: str, source: str = "key", **more: Any) -> PhaseChanged:
    return PhaseChanged(phase=phase, source=source, **more)


async def at(pilot: ConsolePilot, message: Any, seq: int = 5000) -> None:
    """A message of this moment."""
    now = pilot.console.state.now(pilot.console.clock.now_us())
    await pilot.tell(replace(message, seq=seq, t=now))


@SIZES
async def test_the_phase_stands_in_the_status_line_with_its_time(size: tuple[int, int]) -> None:
    async with piloted_console(guide(), size=size) as pilot:
        assert "no phase  )  Opening" in pilot.text("StatusLines")
        await at(pilot, begins("opening"))
        assert "Opening 00:00" in pilot.text("StatusLines")
        assert ") phase" in pilot.text("StopBar")
        await at(pilot, begins("ride", planned_us=120_000_000), 5001)
        await pilot.pass_time(130)
        assert "The ride 02:10/02:00" in pilot.text("StatusLines")
        assert (" )  end" in pilot.text("StatusLines")) == (size[0] >= 100)
        assert "Phase The ride" in pilot.text("EventList")


async def test_a_phase_begins_with_the_first_page_of_its_panels() -> None:
    async with piloted_console(guide()) as pilot:
        panels = pilot.console._main_screen.panels
        await at(pilot, begins("opening"))
        panels.board = dataclasses.replace(panels.board, chosen=1, further=1)
        await at(pilot, begins("opening"), 5001)
        assert (panels.board.chosen, panels.board.further) == (1, 1)
        await at(pilot, begins("ride"), 5002)
        assert (panels.board.chosen, panels.board.further) == (0, 0)


async def test_beside_a_phase_a_driver_that_is_lost_stays_in_sight() -> None:
    names = ["speech", "head", "base", "camera", "distance"]
    state = [m.DriverConnected(driver=name, t=NOW) for name in names[:-1]]
    lost = m.DriverLost(driver="distance", detail="cut", t=NOW)
    settings: dict[str, m.Json] = {"phases": [*PHASES]}
    first = replace(
        scenes.welcome([scenes.start(), *state, lost], settings=settings), drivers=names
    )
    async with piloted_console(first) as pilot:
        await at(pilot, begins("opening", planned_us=120_000_000))
        assert "distance lost" in pilot.text("StatusLines")
        assert "Opening 00:00/02:00" in pilot.text("StatusLines")


@SIZES
async def test_a_phases_title_is_cut_only_where_there_is_no_room(size: tuple[int, int]) -> None:
    title = "Free talk about what was seen"
    settings: dict[str, m.Json] = {"phases": [{"name": "talk", "title": title}]}
    async with piloted_console(scenes.welcome(settings=settings), size=size) as pilot:
        await at(pilot, begins("talk"))
        shown = title if size[0] > 80 else "Free talk about wh…"
        assert f"{shown} 00:00" in pilot.text("StatusLines")


@SIZES
async def test_panels_of_other_phases_fold_away(size: tuple[int, int]) -> None:
    async with piloted_console(guide(), size=size) as pilot:
        before = pilot.text("ActionPanels")
        assert "Speech" in before
        await at(pilot, begins("ride"))
        shown = pilot.text("ActionPanels")
        assert "Gestures" in shown
        assert "Speech" not in shown
        await pilot.press("h")  # its keys play all the same
        assert [each.action for each in pilot.feed.asked if isinstance(each, r.AskAction)]
        await at(pilot, begins("end"), 5001)
        assert "Speech" in pilot.text("ActionPanels")


@SIZES
async def test_the_list_of_phases(size: tuple[int, int]) -> None:
    async with piloted_console(guide(), size=size) as pilot:
        await at(pilot, begins("opening"))
        await open_dialog(pilot, "PhasesDialog")
        drawn = pilot.drawn()
        assert "present" in drawn
        assert "after The ride" in drawn
        assert "planned 02:00" in drawn
        await pilot.press("enter")
        asked = [each for each in pilot.feed.asked if isinstance(each, AskPhase)]
        assert [(each.phase, each.source) for each in asked] == [("ride", "key")]


async def test_between_trials_the_screen_offers_a_trial_and_no_phase() -> None:
    study = {"design": {"order": "fixed", "within": True, "trials": 2}}
    async with piloted_console(guide(study=study), size=(160, 50)) as pilot:
        assert "* trial" in pilot.text("StopBar")
        assert ") phase" not in pilot.text("StopBar")
        await open_dialog(pilot, "PhasesDialog")
        assert "begin with a trial" in pilot.drawn()
        assert "after ;" not in pilot.drawn()
        await pilot.press("ctrl+q")
        await at(pilot, m.TrialStarted(trial=1))
        assert "* trial" not in pilot.text("StopBar")
        assert ") phase" in pilot.text("StopBar")


@pytest.mark.parametrize(
    ("settings", "words"),
    [({}, ")  begins Opening"), ({"study": {"design": {"order": "fixed"}}}, "*  begins trial 3")],
)
async def test_without_a_script_the_screen_says_which_key_begins_what(
    settings: dict[str, Any], words: str
) -> None:
    first = msgspec.structs.replace(guide(**settings), script=[])
    async with piloted_console(first) as pilot:
        assert words in pilot.text("StopBar")
        assert "no script" not in pilot.text("StopBar")


async def test_a_file_without_phases_shows_none() -> None:
    async with piloted_console(scenes.welcome()) as pilot:
        assert "phase" not in pilot.drawn()
        await open_dialog(pilot, "PhasesDialog")
        assert "has no phases" in pilot.drawn()
        await pilot.press("enter")


async def test_a_late_console_knows_the_phase() -> None:
    state = [*scenes.healthy(), begins("ride")]
    welcome = scenes.welcome(state=state, settings={"phases": PHASES})
    async with piloted_console(welcome) as pilot:
        assert "The ride" in pilot.text("StatusLines")
        assert "Speech" not in pilot.text("ActionPanels")


def counts_once(key: str, kind: type[r.Request]) -> None:
    """The key asks for it once while it is held down, and once more when it is pressed again."""
    feed, clock = StillFeed(), ManualClock()
    keyboard = Keyboard(feed, clock)
    keyboard.bind({"h": "Hello"}, {each.chord: c for c in COMMANDS for each in c.keys})
    held: list[str] = []
    keyboard.on_held = lambda chord, name, ref: held.append(chord)

    def press(*keys: str, pause_us: int) -> int:
        before = len(feed.asked)
        for each in keys:
            clock.advance(pause_us / 1_000_000)
            assert keyboard.press(each)
        return sum(isinstance(each, kind) for each in feed.asked[before:])

    assert press(key, pause_us=2_000_000) == 1
    assert press(key, pause_us=500_000) == 0  # the first repeat comes late
    assert press(*[key] * 60, pause_us=33_000) == 0
    assert held == [key]
    assert press(key, pause_us=HELD_US) == 1
    assert press("h", key, "h", key, pause_us=100_000) == 2
    assert press(*"hhhh", pause_us=33_000) == 0
    assert len([each for each in feed.asked if isinstance(each, r.AskAction)]) == 6


def test_a_held_key_counts_once() -> None:
    counts_once(")", AskPhase)


@pytest.mark.parametrize("trial", [False, True])
async def test_a_line_outside_of_a_trial_is_named_once(trial: bool) -> None:
    study = {"design": {"order": "fixed", "within": True, "trials": 2}}
    async with piloted_console(scenes.welcome(settings={"study": study})) as pilot:
        if trial:
            await at(pilot, m.TrialStarted(trial=1))
        action_requested = m.ActionRequested(run="a1", action="Hello", panel="Speech", source="key")
        await at(pilot, action_requested, 5001)
        assert ("outside of a trial; press * to begin one" in pilot.text("StopBar")) is not trial
        await pilot.pass_time(30)
        await at(pilot, m.ActionRequested(run="a2", action="Nod", panel="x", source="key"), 5002)
        assert "outside of a trial" not in pilot.text("StopBar")


async def test_what_is_refused_outside_of_a_trial_says_why_and_is_no_act_outside() -> None:
    study = {"design": {"order": "fixed", "within": True, "trials": 2}}
    async with piloted_console(scenes.welcome(settings={"study": study})) as pilot:
        action_refused = m.ActionRefused(
            run="a1", action="Hello", reason="no condition is set", seq=5002
        )
        await pilot.press("h")
        await pilot.tell(
            m.ActionRequested(run="a1", action="Hello", panel="Speech", source="key", seq=5001),
            action_refused,
            r.Reply(ref=len(pilot.feed.asked), ok=False, reason=action_refused.reason),
        )
        assert action_refused.reason in pilot.text("StopBar")
        assert "outside of a trial" not in pilot.text("StopBar")
        action_requested = m.ActionRequested(run="a2", action="Nod", panel="x", source="key")
        await at(pilot, action_requested, 5003)
        assert "outside of a trial" in pilot.text("StopBar")


def follows(**more: Any) -> r.Welcome:
    """The guide, with actions that are likely to follow Hello."""
    panels = [
        replace(
            panel,
            actions=[
                replace(a, then=["Nod", "Bow"]) if a.name == "Hello" else a for a in panel.actions
            ],
        )
        for panel in scenes.panels()
    ]
    return replace(scenes.welcome(**more), panels=panels)


@SIZES
async def test_what_follows_is_within_reach_until_the_next_act(size: tuple[int, int]) -> None:
    async with piloted_console(follows(), size=size) as pilot:

        def row() -> str:
            return next(
                (x for x in pilot.text("StopBar").splitlines() if x.startswith(" then")), ""
            )

        await at(pilot, m.ActionRequested(run="a1", action="Hello", source="key"))
        assert not row()
        await at(pilot, m.ActionDone(run="a1", action="Hello"), 5001)
        assert row().index("Nod") < row().index("Bow")
        caps = {name: pilot.console.caps[name].chord for name in ("Nod", "Bow")}
        assert all(f" {cap} " in row() for cap in caps.values())
        await open_dialog(pilot, "FindDialog")
        listed = pilot.drawn().partition("Find")[2]
        assert listed.index("Nod") < listed.index("Hello")
        await pilot.press("ctrl+q")
        await at(pilot, m.ActionRequested(run="a2", action="Yes", source="script"), 5002)
        assert not row()
        await at(pilot, m.ActionDone(run="a1", action="Hello"), 5003)  # late
        await at(pilot, m.ActionFailed(run="a2", action="Yes", reason="hot"), 5004)
        assert not row()


async def test_what_cannot_be_played_any_more_does_not_follow() -> None:
    async with piloted_console(follows()) as pilot:
        await at(pilot, m.ActionRequested(run="a1", action="Hello", source="key"))
        await at(pilot, m.ActionDone(run="a1", action="Hello"), 5001)
        assert " then" in pilot.text("StopBar")
        left = [
            replace(panel, actions=[each for each in panel.actions if each.name != "Nod"])
            for panel in follows().panels
        ]
        plan = follows()
        await pilot.tell(
            r.PanelsChanged(
                title=plan.title,
                panels=left,
                script=plan.script,
                verbs=plan.verbs,
                conditions=plan.conditions,
                keyboard=plan.keyboard,
            )
        )
        row = next(x for x in pilot.text("StopBar").splitlines() if x.startswith(" then"))
        assert "Bow" in row
        assert "Nod" not in row


def test_every_command_of_phases_has_a_key() -> None:
    assert {"phase_next", "phases"} <= by_key(COMMANDS).keys()
