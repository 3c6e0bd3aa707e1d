"""What a study knows of its participants reaches the sentence, and nobody who may not know it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path

import msgspec
import pytest
from msgspec.structs import replace
from textual.widgets import Input

from tests.config.reading import HEAD, errors, panel, read_experiment
from tests.console import scenes
from tests.console.piloting import piloted_console
from tests.host.rig import ServedSession, served_session
from tests.session.rig import ScriptedDriver
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.loading import load
from woz_tui.export.redaction import redacted
from woz_tui.features.people.kinds import AskDescribe, ParticipantDescribed
from woz_tui.features.people.section import PEOPLE
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import AskSet, Reply
from woz_tui.protocol.welcome import PerceptionView, StudySettings, WelcomeSettings
from woz_tui.session.action_texts import utterances
from woz_tui.session.redactor import Redactor

FILE = """title: T
robot: {drivers: {robot: {type: puppet}}}
participants:
  pattern: 'P\\d\\d'
  fields: {first: text, group: [child, adult]}
  table: people.csv
panels:
  - title: Speech
    actions:
      - {label: Hello, say: "Hello {participant.first}!"}
      - {label: Whale, say: {by: participant.group, child: "Look!", else: "A whale."}}
"""
TABLE = "participant,first,group,age\nP07,Anna,child,8\nP08,,adult,40\n"
CATALOGUE = {"puppet": ScriptedDriver}


def study(folder: Path, table: str = TABLE, text: str = FILE) -> Experiment:
    (folder / "people.csv").write_text(table)
    path = folder / "study.yaml"
    path.write_text(text)
    return load(path, CATALOGUE)


def hosted(
    experiment: Experiment, scenario: Callable[[ServedSession], Awaitable[None]]
) -> ServedSession:
    async def go() -> ServedSession:
        folder = experiment.path.parent
        async with served_session(folder, made=experiment, catalogue=CATALOGUE) as host:
            await scenario(host)
            return host

    return asyncio.run(go())


def said(host: ServedSession) -> list[str]:
    return [str(line.args["text"]) for line in host.of(m.Command) if line.verb == "say"]


def test_the_table_says_who_takes_part_and_the_sentence_is_theirs(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await host.connect()
        await peer.hello("wizard")
        prepared = utterances(host.session.experiment, host.session.values())["robot"]
        assert [args["text"] for args in prepared] == ["Hello Anna!", "Look!", "A whale."]
        for code in ("P07", "P08", "P09"):
            assert (await peer.ask("set", participant=code))["ok"]
            assert (await peer.ask("action", action="Whale"))["ok"]
        refused = await peer.ask("action", action="Hello")
        assert "{participant.first} has no value yet" in refused["reason"]

    host = hosted(study(tmp_path), scenario)
    assert said(host) == ["Look!", "A whale.", "A whale."]
    assert [
        (line.participant, line.fields, line.source) for line in host.of(ParticipantDescribed)
    ] == [
        ("P07", {"first": "Anna", "group": "child"}, "table"),
        ("P08", {"group": "adult"}, "table"),
    ]


def test_what_the_wizard_says_goes_before_the_table(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await host.connect()
        await peer.hello("wizard")
        fields = {"first": "Bo"}
        assert (await peer.ask("participant-fields", participant="P08", fields=fields))["ok"]
        assert (await peer.ask("set", participant="P08"))["ok"]
        assert (await peer.ask("action", action="Hello"))["ok"]
        wrong = await peer.ask("participant-fields", participant="P08", fields={"group": "old"})
        assert wrong["reason"] == "group is not 'old'; it can be child, adult"
        wrong = await peer.ask("participant-fields", participant="P08", fields={"age": "8"})
        assert "no field 'age'" in wrong["reason"]
        late = await host.connect()
        state = (await late.hello("watcher"))["state"]
        told = [line for line in state if line["kind"] == "participant.described"]
        assert told[-1]["fields"] == {"first": "Bo", "group": "adult"}

    assert said(hosted(study(tmp_path), scenario)) == ["Hello Bo!"]


def test_it_is_kept_from_whom_identity_is_hidden_and_from_a_redacted_log(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await host.connect()
        await peer.hello("wizard")
        assert (await peer.ask("action", action="Hello"))["ok"]
        assert (await peer.ask("action", action="Whale"))["ok"]

    host = hosted(study(tmp_path), scenario)
    blind = Redactor(StudySettings(perception=PerceptionView(hide=["identity"])))
    seen = [str(blind.message(line)) for line in host.lines]
    assert not [text for text in seen if "Anna" in text or "Look!" in text]
    (line,) = host.of(ParticipantDescribed)
    assert "Anna" not in str(redacted(msgspec.to_builtins(line)))
    log = host.recorder.path.read_text()
    assert "P08" not in log, "the table itself is in no log"


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ("code,first\nP01,Anna\n", "has no column 'participant'"),
        ("participant,first,group\nP01,Anna,old\n", "line 2 of the table: 'group' is wrong"),
        ("participant,first,group\nP01,A,child\nP01,B,child\n", "line 3 of the table is about"),
    ],
)
def test_a_mistake_in_the_table_is_told_with_its_line(
    tmp_path: Path, table: str, told: str
) -> None:
    with pytest.raises(ExperimentError, match=told) as raised:
        study(tmp_path, table)
    assert "Anna" not in str(raised.value)


def test_fields_of_a_file(tmp_path: Path) -> None:
    text = panel("{label: A, say: 'Hi {participant.first}'}", head=HEAD)
    right = read_experiment(tmp_path, text + "participants: {fields: {first: text}}\n")
    assert PEOPLE.of(right).fields == {"first": ()}
    assert [*PEOPLE.summary(right)] == [("participants", "first (text)")]
    for fields, told in (
        ("{fist: text}", "did you mean 'participant.fist'?"),
        ("{first: txt}", "expected text, or the words that it can be"),
        ("{first: [else, a]}", "'else' stands for everybody else"),
        ("text", "fields, such as"),
    ):
        wrong = errors(tmp_path, text + f"participants: {{fields: {fields}}}\n")
        assert any(told in each for each in wrong), wrong


async def test_the_dialog_asks_and_what_is_refused_stays() -> None:
    fields = {"first": [], "group": ["child", "adult"]}
    welcome = replace(scenes.welcome(), settings=WelcomeSettings(participant_fields=fields))
    async with piloted_console(welcome) as pilot:
        pilot.feed.answers[AskDescribe] = lambda request, ref: Reply(
            ref=ref, ok=False, reason="group is not 'old'"
        )
        await pilot.press("ctrl+t")
        assert "group: child, adult" in pilot.drawn()
        dialog = pilot.console.dialog
        assert dialog is not None
        entry = dialog.query_one("#field-group", Input)
        assert entry.placeholder == "child, adult"
        entry.value = "old"
        await pilot.press("enter")
        assert "group is not 'old'" in pilot.drawn()
        assert not [each for each in pilot.feed.asked if isinstance(each, AskSet)]
        del pilot.feed.answers[AskDescribe]
        entry.value = "child"
        await pilot.press("enter")
        asked = pilot.feed.last(AskDescribe)
        assert isinstance(asked, AskDescribe)
        assert (asked.participant, asked.fields) == ("P07", {"group": "child"})
        last = pilot.feed.last(AskSet)
        assert isinstance(last, AskSet)
        assert last.participant == "P07"
        assert pilot.console.dialog is None
