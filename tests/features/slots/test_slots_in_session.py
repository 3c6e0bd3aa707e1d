"""Slots are filled in by who asks for an action; what is kept is not asked for again."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.host.rig import Peer, ServedSession, served_session
from tests.session.rig import action, call, experiment, together, with_script
from woz_tui.analysis.figures import SessionFigures
from woz_tui.client import WozRefusedError, connect
from woz_tui.client.tools import PLAY, ToolCaller
from woz_tui.config.experiment import Experiment, Panel, TextVariants
from woz_tui.features.slots.figures import FIGURES
from woz_tui.features.slots.kinds import SlotFilled
from woz_tui.features.slots.report import REPORT
from woz_tui.features.slots.report import SLOTS as TABLE
from woz_tui.features.slots.section import SLOTS, Slot
from woz_tui.features.slots.slot_value import LONGEST, SlotValueError, checked_value, tidied
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import plan_of
from woz_tui.session.action_texts import GivenValues, calls_in, utterances
from woz_tui.session.variables import VariableValues, fill_variables
from woz_tui.timeline.timeline import timeline_of


def made(folder: Path, keep: str = "no", **more: Any) -> Experiment:
    """With a sentence that has a slot, and one that has two."""
    plain = experiment(folder)
    speech = (
        action("Ask", together(call("say", text="Do you like {colour}?"))),
        action("Both", together(call("say", text="{colour} and {shape}, {participant}"))),
        action("Hello", together(call("say", text="Hello {participant}"))),
        *more.pop("actions", ()),
    )
    panel = Panel("Speech", speech, plain.panels[0].place)
    slots = {"colour": Slot(("red", "blue"), heard=True, keep=keep), "shape": Slot()}
    sections = {**plain.sections, SLOTS: slots}
    whole = replace(plain, panels=(panel, plain.panels[1]), sections=sections, **more)
    return with_script(whole, "Ask", "Hello")


def hosted(experiment: Experiment, scenario: Callable[[ServedSession], Awaitable[None]]) -> Any:
    async def go() -> ServedSession:
        folder = experiment.path.parent
        async with served_session(folder, made=experiment) as host:
            await scenario(host)
            return host

    return asyncio.run(go())


def said(host: ServedSession) -> list[str]:
    return [str(line.args["text"]) for line in host.of(m.Command) if line.verb == "say"]


def filled(host: ServedSession) -> list[tuple[str, str, str]]:
    return [(line.slot, line.text, line.source) for line in host.of(SlotFilled)]


async def wizard(host: ServedSession) -> Peer:
    peer = await host.connect()
    await peer.hello("wizard")
    return peer


def test_a_sentence_with_a_gap_is_refused_and_says_what_it_needs(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        program = await host.connect()
        welcome = await program.hello()
        assert welcome["settings"]["slots"]["colour"] == {"offer": ["red", "blue"], "heard": True}
        actions = {each["name"]: each for each in welcome["panels"][0]["actions"]}
        assert actions["Both"]["slots"] == ["colour", "shape"]
        assert "slots" not in actions["Hello"]
        reply = await program.ask("action", action="Both", slots={"shape": "a square"})
        assert (reply["ok"], reply["needs"]) == (False, ["colour"])
        assert "{colour} is not filled in" in reply["reason"]
        later = host.session.hub.now() + 60_000_000
        assert (await program.ask("action", action="Ask", at=later))["needs"] == ["colour"]
        assert (await program.ask("script"))["needs"] == ["colour"]

    host = hosted(made(tmp_path), scenario)
    assert said(host) == []
    assert [line.action for line in host.of(m.ActionRefused)] == ["Both", "Ask", "Ask"]


def test_it_is_said_with_what_came_along_and_the_log_says_where_that_is_from(
    tmp_path: Path,
) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        sources = {"colour": "offered", "shape": "heard"}
        reply = await peer.ask(
            "action",
            action="Both",
            slots={"colour": "red", "shape": "a  square"},
            slot_sources=sources,
            slots_took_us=900_000,
        )
        assert reply["ok"]
        assert (await peer.ask("script", key="space", slots={"colour": "green"}))["ok"]
        program = await host.connect()
        await program.hello()
        assert (await program.ask("action", action="Ask", slots={"colour": "grey"}))["ok"]

    host = hosted(made(tmp_path), scenario)
    assert said(host) == ["red and a square, P07", "Do you like green?", "Do you like grey?"]
    assert filled(host) == [
        ("colour", "red", "offered"),
        ("shape", "a square", "heard"),
        ("colour", "green", "typed"),
        ("colour", "grey", "program"),
    ]
    first, heard, *_ = host.of(SlotFilled)
    assert (first.run, first.action, first.took_us) == ("a00001", "Both", 900_000)
    assert heard.tells == ("transcript",)
    command = host.of(m.Command)[0]
    assert (command.tells, command.unfilled) == (
        ("transcript",),
        {"text": "red and {shape}, P07"},
    )


def test_a_line_that_is_edited_may_do_without_its_slot(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        with_gap = await peer.ask("script", key="ctrl+g", text="Is {colour} nice?")
        assert with_gap["needs"] == ["colour"]
        assert (await peer.ask("script", key="ctrl+g", text="Is it nice?"))["ok"]

    assert said(hosted(made(tmp_path), scenario)) == ["Is it nice?"]


@pytest.mark.parametrize(
    ("slots", "why"),
    [
        ({"colour": " "}, "is empty"),
        ({"colour": "a" * (LONGEST + 1)}, "60 are allowed"),
        ({"colour": "red\nblue"}, "a second line"),
        ({"colour": "\\pau=500\\"}, "begins a tag"),
        ({"size": "big"}, "has no slot 'size'"),
    ],
)
def test_what_cannot_stand_in_a_slot_is_refused(
    tmp_path: Path, slots: dict[str, str], why: str
) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        assert why in (await peer.ask("action", action="Ask", slots=slots))["reason"]

    assert said(hosted(made(tmp_path), scenario)) == []


def test_what_is_kept_for_a_participant_is_said_until_another_one_comes(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        assert (await peer.ask("action", action="Ask", slots={"colour": "red"}))["ok"]
        assert (await peer.ask("action", action="Ask", source="palette"))["ok"]
        await host.published(
            lambda line: (
                isinstance(line, m.ActionsFilled)
                and "red" in str(line.actions["Ask"])
                and "{shape}" in str(line.actions["Both"])
            )
        )
        late = await host.connect()
        state = (await late.hello("watcher"))["state"]
        assert [line["text"] for line in state if line["kind"] == "slot.filled"] == ["red"]
        assert (await peer.ask("set", trial=2))["ok"]
        assert (await peer.ask("action", action="Ask"))["ok"]
        assert (await peer.ask("set", participant="P08"))["ok"]
        assert (await peer.ask("action", action="Ask"))["needs"] == ["colour"]

    host = hosted(made(tmp_path, keep="participant"), scenario)
    assert said(host) == ["Do you like red?"] * 3
    assert [source for *_, source in filled(host)] == ["typed", "kept", "kept"]


def test_what_is_kept_for_a_trial_is_asked_anew_in_the_next(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        assert (await peer.ask("action", action="Ask", slots={"colour": "red"}))["ok"]
        assert (await peer.ask("action", action="Ask"))["ok"]
        assert (await peer.ask("set", trial=2))["ok"]
        assert (await peer.ask("action", action="Ask"))["needs"] == ["colour"]

    hosted(made(tmp_path, keep="trial"), scenario)


def test_other_words_have_the_same_value(tmp_path: Path) -> None:
    wordings = TextVariants({"": ("{colour} it is.", "So, {colour}.")})
    said_so = replace(call("say"), choices={"text": wordings})
    file = made(tmp_path, actions=(action("So", together(said_so)),))

    async def scenario(host: ServedSession) -> None:
        texts = host.session.texts
        so = host.session.experiment.action("So")
        assert so is not None
        host.session.play("So", RequestOrigin("key"), given=GivenValues({"colour": "red"}))
        [command] = host.of(m.Command)
        other = texts.other(so, command)
        assert other is not None
        [again] = calls_in(other)
        assert {command.args["text"], again.args["text"]} == {"red it is.", "So, red."}

    hosted(file, scenario)


def test_sentences_with_offered_values_are_prepared(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        prepared = utterances(host.session.experiment, host.session.values())
        texts = [args["text"] for args in prepared["robot"]]
        assert texts == ["Do you like red?", "Do you like blue?", "Hello P07"]

    hosted(made(tmp_path), scenario)


def test_a_blind_wizard_is_asked_whatever_the_condition_is(tmp_path: Path) -> None:
    depends = replace(
        call("say"), choices={"text": TextVariants({"warm": ("Ah, {colour}!",), "cold": ("Ok.",)})}
    )
    file = made(tmp_path, actions=(action("Ah", together(depends)),))

    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        for condition in ("warm", "cold"):
            assert (await peer.ask("set", condition=condition))["ok"]
            assert (await peer.ask("action", action="Ah"))["needs"] == ["colour"]

    hosted(file, scenario)


@given(st.text(max_size=80))
def test_no_value_leaves_its_slot(text: str) -> None:
    """Whatever is typed or heard: it is said as it stands, on one line, and does nothing else."""
    for taken in (text, tidied(text)):
        try:
            value = checked_value(taken)
        except SlotValueError:
            continue
        values = VariableValues({"slot": value, "condition": "cold"})
        assert fill_variables("<{slot}>", values) == f"<{value}>"
        assert len(value) <= LONGEST
        assert len(value.splitlines()) == 1
        assert not {*"\\^<>\x1b"} & {*value}
    assert not tidied(text) or checked_value(tidied(text)) == tidied(text)


@pytest.mark.parametrize("braces", ["{condition}", "{{condition}}", "{", "}", "{colour}"])
def test_braces_are_said_and_not_kept(tmp_path: Path, braces: str) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        assert (await peer.ask("action", action="Ask", slots={"colour": braces}))["ok"]
        assert (await peer.ask("action", action="Ask"))["needs"] == ["colour"]

    assert said(hosted(made(tmp_path, keep="trial"), scenario)) == [f"Do you like {braces}?"]


def test_a_report_counts_them_and_a_table_has_each(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        asked = {"slots": {"colour": "red"}, "slot_sources": {"colour": "offered"}}
        assert (await peer.ask("action", action="Ask", **asked, slots_took_us=1_200_000))["ok"]
        assert (await peer.ask("action", action="Ask"))["ok"]

    host = hosted(made(tmp_path, keep="participant"), scenario)
    rows = FIGURES.count(timeline_of(host.lines))
    assert rows is not None
    [table] = REPORT.session_tables(rows)
    assert [[str(cell) for cell in row] for row in table.rows] == [
        ["colour", "0", "1", "0", "0", "1", "1.20 s"]
    ]
    of_nobody = cast("SessionFigures", None)  # these columns look at their row alone
    cells = [[column.cell(of_nobody, row) for column in TABLE.columns[-4:]] for row in rows]
    assert cells == [["colour", "red", "offered", "1.200000"], ["colour", "red", "kept", None]]


def test_programs_and_assistants_say_what_stands_there(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        async with connect(host.path) as woz:
            await woz.press("Ask", slots={"colour": "red"})
            caller = ToolCaller(woz)
            tool = next(each for each in caller.tools() if each.name == PLAY)
            assert "Both: Both (slots: colour, shape)" in tool.summary
            assert {*tool.schema["properties"]["slots"]["properties"]} == {"colour", "shape"}
            await caller.call(PLAY, {"action": "Ask", "slots": {"colour": "blue"}})
            with pytest.raises(WozRefusedError, match="is not filled in"):
                await caller.call(PLAY, {"action": "Ask"})

    assert said(hosted(made(tmp_path), scenario)) == ["Do you like red?", "Do you like blue?"]


def test_what_would_be_said_is_foretold_only_when_it_is_known(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        program = await host.connect()
        await program.hello()
        reply = await program.ask("predict", action="Ask")
        assert "{colour} has no value yet: a wizard or a program fills it in" in reply["reason"]
        assert "command" not in reply, "no participant is missing"

    hosted(made(tmp_path), scenario)


def test_a_re_run_says_the_same_words(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await wizard(host)
        for text in ("red", "{condition}"):
            assert (await peer.ask("action", action="Ask", slots={"colour": text}))["ok"]

    host = hosted(made(tmp_path), scenario)
    plan = plan_of(host.recorder.path)
    texts = [step.command.args["text"] for step in plan.steps if step.command.verb == "say"]
    assert texts == ["Do you like red?", "Do you like {condition}?"]
