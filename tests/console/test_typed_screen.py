"""The offer to keep what was typed, as a wizard sees it."""

from __future__ import annotations

from msgspec.structs import replace

from tests.console import scenes
from tests.console.dialogs import SIZES, opened
from tests.console.driving import Sitting, sitting
from woz_tui.console.action_panels import arrange
from woz_tui.protocol import messages as m
from woz_tui.protocol import requests as r
from woz_tui.protocol.panels import ActionView, PanelView

DIFF = ["--- talk.yaml", "+++ talk-typed.yaml", "@@ -9,0 +10,3 @@", '+      - {say: "One moment"}']


def typed() -> r.Welcome:
    """A session in which a sentence was typed."""
    welcome = scenes.welcome()
    button = ActionView(name="typed: One moment", label="One moment", key="1", help="typed")
    return replace(welcome, panels=[*welcome.panels, PanelView(title="Typed", actions=[button])])


def answers(seat: Sitting, wrong: str = "", sentences: int = 1) -> None:
    """What the robot process says."""

    def answer(request: r.AnyRequest, ref: int) -> r.Reply:
        assert isinstance(request, r.AskKeepTyped)
        if wrong and not request.dry_run:
            return r.Reply(ref=ref, ok=False, reason=wrong)
        file = "/study/talk-typed.yaml"
        data = {"sentences": sentences, "file": file, "diff": DIFF, "written": True}
        return r.Reply(ref=ref, ok=True, data=data)

    seat.feed.answers[r.AskKeepTyped] = answer


def writes(seat: Sitting) -> list[bool]:
    """The requests so far: whether each writes."""
    return [not each.dry_run for each in seat.feed.asked if isinstance(each, r.AskKeepTyped)]


async def ending(seat: Sitting, dialog: str = "KeepTypedDialog") -> None:
    await opened(seat, "LeaveDialog")
    await seat.press("down", "down", "enter")
    await seat.until(lambda: type(seat.console.dialog).__name__ == dialog)
    await seat.settle()


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


async def test_the_end_shows_what_comes_in_writes_it_and_ends() -> None:
    for size in SIZES:
        async with sitting(typed(), size=size) as seat:
            answers(seat)
            await ending(seat)
            drawn = seat.drawn()
            for shown in ("/study/talk-typed.yaml", DIFF[-1], "n ends without"):
                assert shown in drawn, (size, shown)
            assert (writes(seat), seat.feed.last(r.AskEnd)) == ([False], None)
            await seat.press("enter")
            await seat.until(lambda: seat.feed.last(r.AskEnd) is not None)
            assert writes(seat) == [False, True]


async def test_the_end_without_a_copy_and_no_end_at_all() -> None:
    async with sitting(typed()) as seat:
        answers(seat)
        await ending(seat)
        await seat.press("ctrl+q")
        assert seat.console.dialog is None
        assert seat.feed.last(r.AskEnd) is None
        await ending(seat)
        await seat.press("n")
        await seat.until(lambda: seat.feed.last(r.AskEnd) is not None)
        assert writes(seat) == [False, False]


async def test_an_answer_that_does_not_come_holds_up_no_end() -> None:
    async with sitting(typed()) as seat:
        # A reply to something else: this one is never answered.
        seat.feed.answers[r.AskKeepTyped] = lambda _, ref: r.Reply(ref=ref + 9999, ok=True)
        await ending(seat)
        assert "reading" in seat.drawn()
        await seat.press("enter", "n")
        assert seat.feed.last(r.AskEnd) is not None


async def test_what_is_kept_already_is_not_offered_at_the_end() -> None:
    async with sitting(typed()) as seat:
        answers(seat, sentences=0)
        await opened(seat, "LeaveDialog")
        await seat.press("down", "down", "enter")
        await seat.until(lambda: seat.feed.last(r.AskEnd) is not None)


async def test_nothing_typed_is_no_question() -> None:
    button = ActionView(name="One moment", label="One moment", key="1")
    file = replace(scenes.welcome(), panels=[PanelView(title="Typed", actions=[button])])
    async with sitting(file) as seat:
        await opened(seat, "LeaveDialog")
        await seat.press("down", "down", "enter")
        await seat.until(lambda: seat.feed.last(r.AskEnd) is not None)
        assert writes(seat) == []


async def test_a_copy_that_cannot_be_written_says_why_and_where_the_sentences_are() -> None:
    async with sitting(typed()) as seat:
        answers(seat, wrong="no copy could be written to /study: Read-only file system")
        await ending(seat)
        await seat.press("enter")
        await seat.until(lambda: "Read-only file system" in seat.drawn())
        assert "in the log" in seat.drawn()
        assert seat.console.state.log in seat.drawn()
        assert seat.feed.last(r.AskEnd) is None
        await seat.press("n")
        await seat.until(lambda: seat.feed.last(r.AskEnd) is not None)


async def test_the_finder_offers_it_any_time() -> None:
    async with sitting(typed()) as seat:
        answers(seat)
        await opened(seat, "FindDialog")
        await seat.type("typed sentences")
        await seat.press("enter")
        await seat.until(lambda: DIFF[-1] in seat.drawn())
        await seat.press("enter")
        await seat.until(lambda: "/study/talk-typed.yaml" in seat.text("StopBar"))
        assert writes(seat) == [False, True]
        assert seat.feed.last(r.AskEnd) is None


async def test_where_somebody_else_ends_the_session_the_sentences_are_in_the_log() -> None:
    async with sitting(typed()) as seat:
        await seat.tell(m.SessionEnd(reason="program", sha256="0"))
        seat.feed.cut("session ended")
        await seat.until(lambda: type(seat.console.dialog).__name__ == "EndedDialog")
        assert "sentences typed in it are in the log" in seat.drawn()
