"""The offer to keep what was typed, as a wizard sees it."""

from __future__ import annotations

from msgspec.structs import replace

from tests.console import scenes
from tests.console.dialogs import SIZES, open_dialog
from tests.console.piloting import ConsolePilot, piloted_console
from woz_tui.console.widgets.action_panels import arrange
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView

DIFF = ["--- talk.yaml", "+++ talk-typed.yaml", "@@ -9,0 +10,3 @@", '+      - {say: "One moment"}']


def welcome_with_typed() -> r.Welcome:
    """A session in which a sentence was typed."""
    welcome = scenes.welcome()
    button = ActionView(name="typed: One moment", label="One moment", key="1", help="typed")
    return replace(welcome, panels=[*welcome.panels, PanelView(title="Typed", actions=[button])])


def answers(pilot: ConsolePilot, wrong: str = "", sentences: int = 1) -> None:
    """What the robot process says."""

    def answer(request: r.Request, ref: int) -> r.Reply:
        assert isinstance(request, r.AskKeepTyped)
        if wrong and not request.dry_run:
            return r.Reply(ref=ref, ok=False, reason=wrong)
        file = "/study/talk-typed.yaml"
        data = {"sentences": sentences, "file": file, "diff": DIFF, "written": True}
        return r.Reply(ref=ref, ok=True, data=data)

    pilot.feed.answers[r.AskKeepTyped] = answer


def writes(pilot: ConsolePilot) -> list[bool]:
    """The requests so far: whether each writes."""
    return [not each.dry_run for each in pilot.feed.asked if isinstance(each, r.AskKeepTyped)]


async def test_the_buttons_stay_where_they_are_when_a_sentence_is_typed() -> None:
    """At every size, however many sentences there are; theirs are on this page or on a further."""
    few = [PanelView(title=each.title, actions=each.actions[:4]) for each in scenes.panels()[:3]]
    for shown in (few, scenes.panels(), scenes.many_panels(60)):
        for width, height in [*SIZES, (90, 30), (120, 36)]:
            for cells in ((width, height - 11), (width - 50, height - 6)):
                before = arrange(shown, *cells, 3)
                for count in (1, 2, 5, 40):
                    actions = [
                        ActionView(name=f"t{n}", label=f"Sentence {n}") for n in range(count)
                    ]
                    after = arrange([*shown, PanelView(title="Typed", actions=actions)], *cells, 3)
                    own = after.slots[: len(before.slots)]
                    assert (own, after.width) == (before.slots, before.width)
                    added = after.slots[len(before.slots) :]
                    assert [slot.action for slot in added if slot.action] == actions
                    places = [(slot.page, slot.column, slot.row) for slot in after.slots]
                    assert len({*places}) == len(places)
                    assert all(row < cells[1] for *_, row in places)
                    assert max(page for page, *_ in places) == after.pages - 1


async def test_the_end_writes_no_copy_unless_it_was_chosen() -> None:
    for size in SIZES:
        async with piloted_console(welcome_with_typed(), size=size) as pilot:
            answers(pilot)
            await open_dialog(pilot, "LeaveDialog")
            assert "1 typed sentence: in the log only" in pilot.drawn(), size
            await pilot.press("down", "down", "enter")
            await pilot.until(lambda: pilot.feed.last(r.AskEnd) is not None)
            assert writes(pilot) == []


async def test_the_end_writes_the_copy_that_was_chosen_and_ends() -> None:
    async with piloted_console(welcome_with_typed()) as pilot:
        answers(pilot)
        await open_dialog(pilot, "LeaveDialog")
        await pilot.press("down", "down", "down", "enter")
        assert "1 typed sentence: also into a copy of your file" in pilot.drawn()
        await pilot.press("ctrl+q")
        await open_dialog(pilot, "LeaveDialog")
        assert "also into a copy" in pilot.drawn(), "what was chosen is kept"
        await pilot.press("down", "down", "enter")
        await pilot.until(lambda: pilot.feed.last(r.AskEnd) is not None)
        assert writes(pilot) == [True]
        assert pilot.console.requests.typed_copy == "/study/talk-typed.yaml"


async def test_nothing_typed_is_no_question() -> None:
    button = ActionView(name="One moment", label="One moment", key="1")
    file = replace(scenes.welcome(), panels=[PanelView(title="Typed", actions=[button])])
    async with piloted_console(file) as pilot:
        await open_dialog(pilot, "LeaveDialog")
        await pilot.press("down", "down", "enter")
        await pilot.until(lambda: pilot.feed.last(r.AskEnd) is not None)
        assert writes(pilot) == []


async def test_a_copy_that_cannot_be_written_says_why_and_ends_nothing() -> None:
    async with piloted_console(welcome_with_typed(), size=(160, 50)) as pilot:
        answers(pilot, wrong="no copy could be written to /study: Read-only file system")
        await open_dialog(pilot, "LeaveDialog")
        await pilot.press("down", "down", "down", "enter", "up", "enter")
        await pilot.until(lambda: "Read-only file system" in pilot.drawn())
        assert "the sentences are in the log" in pilot.drawn()
        assert pilot.feed.last(r.AskEnd) is None
        await open_dialog(pilot, "LeaveDialog")
        assert "1 typed sentence: in the log only" in pilot.drawn()
        await pilot.press("down", "down", "enter")
        await pilot.until(lambda: pilot.feed.last(r.AskEnd) is not None)


async def test_the_finder_offers_it_any_time() -> None:
    async with piloted_console(welcome_with_typed()) as pilot:
        answers(pilot)
        await open_dialog(pilot, "FindDialog")
        await pilot.type("typed sentences")
        await pilot.press("enter")
        await pilot.until(lambda: "/study/talk-typed.yaml" in pilot.drawn())
        assert "Keep the sentence you typed?" in pilot.drawn()
        assert "One moment" in pilot.drawn()
        assert "@@" not in pilot.drawn(), "no wizard reads a diff"
        await pilot.press("enter")
        await pilot.until(lambda: "/study/talk-typed.yaml" in pilot.text("StopBar"))
        assert writes(pilot) == [False, True]
        assert pilot.feed.last(r.AskEnd) is None


async def test_where_somebody_else_ends_the_session_the_sentences_are_in_the_log() -> None:
    async with piloted_console(welcome_with_typed()) as pilot:
        await pilot.tell(m.SessionEnd(reason="program", sha256="0"))
        pilot.feed.cut("session ended")
        await pilot.until(lambda: type(pilot.console.dialog).__name__ == "EndedDialog")
        assert "sentences typed in it are in the log" in pilot.drawn()


async def test_a_session_that_has_ended_cannot_be_ended_again() -> None:
    async with piloted_console(welcome_with_typed()) as pilot:
        await pilot.tell(m.SessionEnd(reason="program", sha256="0"))
        pilot.feed.cut("session ended")
        await pilot.until(lambda: type(pilot.console.dialog).__name__ == "EndedDialog")
        await pilot.press("enter")
        assert pilot.console.dialog is None
        await pilot.press("ctrl+q")
        assert "Leave the console" in pilot.drawn()
        assert "the robot rests" not in pilot.drawn()
