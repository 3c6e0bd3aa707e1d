"""The row of repairs, as a wizard sees and uses it."""

from __future__ import annotations

import msgspec

from tests.console import scenes
from tests.console.piloting import piloted_console
from woz_tui.config.keys import BUILTIN_KEYS
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.console.widgets.bottom_rows import action_row
from woz_tui.features.repairs.section import LABELS
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView

ALL = [ActionView(name=name, label=str(label), verbs=["say"]) for name, label in LABELS.items()]
FEW = [each for each in ALL if each.name in ("repair repeat", "repair interrupt")]


PLAIN = [PanelView(title="Speech", actions=[ActionView(name="Hello", label="Hello", key="h")])]


def welcome(repairs: list[ActionView], shown: list[PanelView] | None = None) -> r.Welcome:
    plain = scenes.welcome(shown=shown or PLAIN)
    settings = msgspec.structs.replace(plain.settings, repairs=repairs)
    return msgspec.structs.replace(plain, settings=settings)


async def test_all_of_them_stand_in_one_row_of_eighty_columns() -> None:
    async with piloted_console(welcome(ALL)) as pilot:
        row = pilot.text("ActionRow")
        assert len(row) <= 80
        for label in LABELS.values():
            assert label in row


async def test_a_key_asks_for_the_repair_from_every_page() -> None:
    async with piloted_console(welcome(ALL, scenes.many_panels(60))) as pilot:
        for key, name in (
            ("$", "repair repeat"),
            ("(", "repair yes"),
            ("ctrl+u", "repair dont_know"),
        ):
            await pilot.press("tab")
            assert LABELS[name] in pilot.text("ActionRow")
            await pilot.press(key)
            asked = pilot.feed.asked[-1]
            assert isinstance(asked, r.AskAction)
            assert (asked.action, asked.source, asked.key) == (name, "key", key)


async def test_a_held_key_says_yes_once() -> None:
    async with piloted_console(welcome(ALL)) as pilot:
        await pilot.press(*"(((((")
        asked = [each for each in pilot.feed.asked if isinstance(each, r.AskAction)]
        assert len(asked) == 1


async def test_an_interruption_opens_the_field_for_what_is_said_instead() -> None:
    async with piloted_console(welcome(FEW)) as pilot:
        await pilot.press("ctrl+n")
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "repair interrupt"
        await pilot.type("Wait, please")
        await pilot.press("enter")
        said = pilot.feed.last(r.AskVerb)
        assert isinstance(said, r.AskVerb)
        assert said.args == {"text": "Wait, please"}


async def test_repairs_that_the_file_does_not_have_have_no_key() -> None:
    async with piloted_console(welcome(FEW)) as pilot:
        assert "yes" not in pilot.text("ActionRow")
        await pilot.press("(")
        assert not [each for each in pilot.feed.asked if isinstance(each, r.AskAction)]


async def test_a_repair_gives_its_key_to_the_experiment_and_says_where_none_is_left() -> None:
    own = [item for item in BUILTIN_KEYS if item.id in ("repair_repeat", "repair_interrupt")]
    taken = ['"', *dict.fromkeys(key for item in own for key in (item.chord, *item.reserves))]
    taken.remove("insert")  # one is left, for two of them
    actions = [ActionView(name=f"A{n}", label=f"A{n}", key=key) for n, key in enumerate(taken)]
    shown = [PanelView(title="Signs", actions=actions)]
    async with piloted_console(welcome(FEW, shown)) as pilot:
        row = pilot.text("ActionRow")
        assert "no key" in row
        await pilot.press('"')
        asked = pilot.feed.last(r.AskAction)
        assert isinstance(asked, r.AskAction)
        assert asked.action == "A0"


async def test_its_line_in_the_list_of_events_has_its_label() -> None:
    async with piloted_console(welcome(ALL)) as pilot:
        await pilot.tell(
            m.ActionRequested(
                run="r9", action="repair dont_know", source="key", panel="Repairs", t=scenes.NOW
            )
        )
        assert "don't know" in pilot.text("EventList")


async def test_an_interruption_from_the_reading_thread_reaches_the_screen() -> None:
    async with piloted_console(welcome(FEW)) as pilot:
        assert not pilot.console.keyboard.arrive(
            "ctrl+n"
        )  # left to the screen, which offers it again
        await pilot.press("ctrl+n")
        assert pilot.feed.last(r.AskAction) is not None


def test_in_a_replay_there_are_labels_alone() -> None:
    state = ConsoleState()
    replaying = r.Replaying(t=0, length_us=60_000_000, rate=1.0, paused=False)
    state.apply([welcome(ALL), replaying], 0)
    shown = "".join(text for text, _ in action_row(state, PaintFrame(80, 1, scenes.NOW), {}))
    assert "no key" not in shown
    assert "repeat" in shown
