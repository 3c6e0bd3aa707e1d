"""Proposals on the wizard's screen: each keeps its place, and is taken by its key."""

from __future__ import annotations

from typing import Any

import pytest

from tests.console import scenes
from tests.console.dialogs import entry
from tests.console.piloting import ConsolePilot, piloted_console
from tests.features.phases.test_phases_on_screen import at
from woz_tui.features.proposals.kinds import (
    AskDismiss,
    AskShown,
    AskTake,
    ProposedItem,
    SuggestGone,
    SuggestOffered,
    SuggestSettings,
    SuggestTaken,
)

SIZES = pytest.mark.parametrize("size", [(80, 24), (160, 50)])
ON = SuggestSettings(sources=["program"], programs=["mcp"])


def offered(number: int, *texts: str, **more: Any) -> SuggestOffered:
    items = [ProposedItem(str(i), text=text) for i, text in enumerate(texts, 1)]
    name = {"set": f"s{number}", "who": "mcp", "source": "program"}
    return SuggestOffered(**{**name, "items": items, "until": scenes.NOW + 10_000_000, **more})


async def told(pilot: ConsolePilot, *messages: Any) -> None:
    for seq, message in enumerate(messages, 5000):
        await at(pilot, message, seq)


@SIZES
async def test_each_has_its_key_and_who_proposes_it(size: tuple[int, int]) -> None:
    async with piloted_console(size=size) as pilot:
        before = pilot.drawn()
        await told(pilot, ON)
        assert "nothing is proposed" in pilot.drawn()
        await told(pilot, offered(1, "It is a whale.", approval=True))
        assert "F6 mcp asks: “It is a whale.”" in " ".join(pilot.drawn().split())
        assert "F9 edit  ^S no" in pilot.drawn()
        assert before.count("\n") == pilot.drawn().count("\n")


async def test_a_sentence_that_goes_on_below_has_its_keys_there() -> None:
    long = "Shall I tell you about the whale, which is eleven metres long and very old?"
    async with piloted_console(size=(80, 24)) as pilot:
        await told(pilot, ON, offered(1, long, approval=True))
        drawn = pilot.drawn().splitlines()
        below = 1 + next(at for at, line in enumerate(drawn) if "mcp asks:" in line)
        assert "very old?”" in drawn[below]
        assert drawn[below].rstrip().endswith("F9 edit  ^S no")


@SIZES
@pytest.mark.parametrize(
    ("item", "shown"),
    [
        (
            ProposedItem("1", text="Hi", verb="say", args={"text": "Hi", "volume": 80}),
            "volume 80: “Hi”",
        ),
        (
            ProposedItem("1", text="Hi", verb="say", on="nao", when_busy="replace"),
            "on nao, interrupts: “Hi”",
        ),
        (
            ProposedItem("1", action="Hello", args={"colour": "red"}, when_busy="refuse"),
            "only if nothing goes on, Hello colour red",
        ),
        (ProposedItem("1", verb="gaze", args={"yaw": [1, True]}), "gaze yaw [1, true]"),
    ],
)
async def test_what_matters_of_it_can_be_read(
    size: tuple[int, int], item: ProposedItem, shown: str
) -> None:
    async with piloted_console(size=size) as pilot:
        await told(pilot, ON, offered(1, items=[item], approval=True))
        assert f"mcp asks: {shown}" in " ".join(pilot.drawn().split())


@SIZES
async def test_a_repetition_is_marked(size: tuple[int, int]) -> None:
    async with piloted_console(size=size) as pilot:
        item = ProposedItem("1", text="It is a whale.", marks=["repeats", "asks again"])
        await told(pilot, ON, offered(1, items=[item]))
        assert "said just now  one more question" in pilot.drawn()


async def test_what_stands_on_the_screen_is_told_once() -> None:
    async with piloted_console(size=(80, 24)) as pilot:
        texts = [offered(1, "One?", "Two?"), offered(2, "Three?")]
        await told(pilot, ON, *texts)
        await pilot.press("down")
        asked = [each for each in pilot.feed.asked if isinstance(each, AskShown)]
        assert [(each.set, each.items) for each in asked] == [("s1", ["1", "2"])]
        await told(pilot, SuggestGone(set="s1", how="expired"))
        asked = [each for each in pilot.feed.asked if isinstance(each, AskShown)]
        assert asked[-1].set == "s2", "the third had no place"


async def test_of_likely_actions_only_those_are_shown_for_which_there_is_room() -> None:
    async with piloted_console(size=(80, 24)) as pilot:
        items = [ProposedItem(str(i), action="Hello" * i * 3) for i in range(1, 4)]
        likely = SuggestOffered(set="s1", source="logs", items=items)
        await told(pilot, SuggestSettings(sources=["logs"]), likely)
        asked = pilot.feed.last(AskShown)
        assert isinstance(asked, AskShown)
        assert asked.items == ["1", "2"]


async def test_the_key_takes_what_stands_there_by_its_set() -> None:
    async with piloted_console(size=(160, 50)) as pilot:
        await told(pilot, ON, offered(1, "One?", "Two?"), offered(2, "Three?"))
        for key, wanted in (("f6", ("s1", "1")), ("f7", ("s1", "2")), ("f8", ("s2", "1"))):
            await pilot.press(key)
            asked = pilot.feed.last(AskTake)
            assert isinstance(asked, AskTake)
            assert (asked.set, asked.item, asked.key) == (*wanted, key)
        await pilot.press("ctrl+s")
        declined = pilot.feed.last(AskDismiss)
        assert isinstance(declined, AskDismiss)
        assert declined.set == "s1"


async def test_nothing_moves_under_a_finger() -> None:
    async with piloted_console(size=(80, 24)) as pilot:
        await told(pilot, ON, offered(1, "One?"), offered(2, "Two?"))
        await told(pilot, SuggestGone(set="s1", how="expired"))
        await pilot.press("f7")
        asked = pilot.feed.last(AskTake)
        assert isinstance(asked, AskTake)
        assert asked.set == "s2", "it stands where it stood"
        await pilot.press("f6")
        assert "Nothing is proposed there" in pilot.drawn()
        await told(pilot, offered(3, "Three?"))
        await pilot.press("f6")
        asked = pilot.feed.last(AskTake)
        assert isinstance(asked, AskTake)
        assert asked.set == "s3"


async def test_it_is_changed_before_it_is_said() -> None:
    async with piloted_console() as pilot:
        await told(pilot, ON, offered(1, "It is a wale."))
        await pilot.press("f9")
        assert "Proposed by mcp" in pilot.drawn()
        assert entry(pilot).value == "It is a wale."
        await pilot.press(*["backspace"] * 5)
        await pilot.type("whale!")
        await pilot.press("enter")
        asked = pilot.feed.last(AskTake)
        assert isinstance(asked, AskTake)
        assert (asked.set, asked.text) == ("s1", "It is a whale!")


async def test_the_box_closes_when_the_proposal_has_gone() -> None:
    async with piloted_console() as pilot:
        await told(pilot, ON, offered(1, "It is a wale."))
        await pilot.press("f9")
        assert pilot.console.dialog is not None
        await told(pilot, SuggestTaken(set="s1", item="1", how="key"))
        assert pilot.console.dialog is None


async def test_a_session_without_proposals_has_no_line_of_them() -> None:
    async with piloted_console() as pilot:
        assert "nothing is proposed" not in pilot.drawn()
        await pilot.press("f6")
        assert "Nothing is proposed there" in pilot.drawn()


@SIZES
async def test_likely_actions_stand_there_with_their_own_keys(size: tuple[int, int]) -> None:
    async with piloted_console(size=size) as pilot:
        likely = SuggestOffered(set="s1", source="logs", items=[ProposedItem("1", action="Hello")])
        on = SuggestSettings(sources=["logs", "program"], programs=["mcp"])
        await told(pilot, on, likely, offered(2, "It is a whale."))
        (row,) = [line for line in pilot.drawn().splitlines() if "likely" in line]
        assert row.split()[1:] == ["h", "Hello"]
        await pilot.press("f6")
        asked = pilot.feed.last(AskTake)
        assert isinstance(asked, AskTake)
        assert asked.set == "s2", "they have no place of their own"


async def test_both_sentences_of_a_model_are_shown_beside_likely_actions() -> None:
    async with piloted_console(size=(80, 24)) as pilot:
        likely = SuggestOffered(set="s1", source="logs", items=[ProposedItem("1", action="Hello")])
        texts = offered(2, "One?", "Two?", who="suggest", source="model")
        on = SuggestSettings(sources=["logs", "program", "model"])
        await told(pilot, on, likely, texts)
        assert "F7  suggest: “Two?”" in pilot.drawn()
        await pilot.press("f7")
        asked = pilot.feed.last(AskTake)
        assert isinstance(asked, AskTake)
        assert (asked.set, asked.item) == ("s2", "2")


LONG = "Shall I show you where the whale shark lives, behind the large tank? It is " + "far " * 20


async def test_a_long_sentence_goes_on_in_the_empty_row_below() -> None:
    async with piloted_console(size=(80, 24)) as pilot:
        await told(pilot, ON, offered(1, LONG[:110].strip()))
        assert "".join(LONG[:110].split()) in "".join(pilot.drawn().replace("10 s", "").split())
        await pilot.press("f6")
        assert isinstance(pilot.feed.last(AskTake), AskTake)


async def test_what_cannot_be_read_whole_is_shown_before_it_is_taken() -> None:
    async with piloted_console(size=(80, 24)) as pilot:
        await told(pilot, ON, offered(1, LONG.strip(), "Two?"))
        await pilot.press("f6")
        assert "Proposed by mcp" in pilot.drawn()
        assert pilot.drawn().count("far") > 15
        await pilot.press("enter")
        asked = pilot.feed.last(AskTake)
        assert isinstance(asked, AskTake)
        assert (asked.set, asked.text) == ("s1", "")
