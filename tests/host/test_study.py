"""The study over the socket: proposals, trials, questionnaires; who may ask for what."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.features.questionnaires.rig import study_experiment
from tests.host.rig import Peer, ServedSession, served_session
from tests.session.study_rig import had, log, renamed
from woz_tui.config.experiment import SessionSettings
from woz_tui.features.questionnaires.kinds import QuestionnaireEnded, QuestionnaireStarted
from woz_tui.protocol import messages as m

TITLE = "Made by hand"


def hosted(
    tmp_path: Path,
    scenario: Callable[[ServedSession], Awaitable[None]],
    settings: SessionSettings | None = None,
) -> list[m.Message]:
    """Plays the scenario with a host; what was published."""

    async def go() -> list[m.Message]:
        experiment = study_experiment(tmp_path)
        async with served_session(tmp_path, settings, made=experiment) as host:
            await scenario(host)
            return host.lines

    return asyncio.run(go())


async def wizard(host: ServedSession) -> tuple[Peer, dict[str, Any]]:
    peer = await host.connect()
    return peer, await peer.hello("wizard")


def test_a_participant_from_the_proposal_to_the_answers(tmp_path: Path) -> None:
    for number, row in enumerate((0, 0, 1)):
        lines = had(f"P1{number}", ["cold", "warm"] if row else ["warm", "cold"], "dddd", row=row)
        log(tmp_path / "recordings", f"2026-02-0{number + 1}T10-00-00_S01", lines, title=TITLE)

    async def scenario(host: ServedSession) -> None:
        peer, _ = await wizard(host)
        reply = await peer.ask("proposal", participant="P01")
        assert reply["ok"]
        data = reply["data"]
        assert data == {
            "order": ["B", "A"],
            "method": "latin-square",
            "row": 1,
            "why": "row 2 of 2: least used so far (1 participant)",
            "condition": "B",
            "trial": 1,
            "planned": 4,
            "wording": {
                "why": {"code": "study.least_used", "values": {"row": 2, "rows": 2, "count": 1}}
            },
        }
        assert (await peer.ask("assign", participant="P01", order=data["order"]))["ok"]
        assert (await peer.ask("trial", what="begin"))["ok"]
        assert (await peer.ask("trial", what="done", text="well"))["ok"]
        guest = await host.connect()
        welcome = await guest.hello("participant")
        assert welcome["role"] == "participant"
        assert welcome["settings"]["study"]["due"] == ["each"]
        assert (await guest.ask("questionnaire", questionnaire="each"))["ok"]
        answered = await guest.ask("answer", questionnaire="each", item="hard", value=4)
        assert answered["ok"], answered
        assert (await guest.ask("questionnaire", questionnaire="each", what="done"))["ok"]

    lines = hosted(tmp_path, scenario)
    (assigned,) = (line for line in lines if isinstance(line, m.ConditionsAssigned))
    assert (assigned.method, assigned.row) == ("latin-square", 1)
    (started,) = (line for line in lines if isinstance(line, QuestionnaireStarted))
    assert started.source == "participant"
    (questionnaire_ended,) = (line for line in lines if isinstance(line, QuestionnaireEnded))
    assert (questionnaire_ended.reason, questionnaire_ended.answered) == ("done", 1)


@pytest.mark.parametrize(
    ("kind", "fields"),
    [
        ("action", {"action": "Hello"}),
        ("verb", {"verb": "say", "args": {"text": "x"}}),
        ("script", {}),
        ("release", {}),
        ("set", {"participant": "P02"}),
        ("marker", {"text": "x"}),
        ("note", {"text": "x"}),
        ("mistake", {}),
        ("lock", {"panel": "Base", "locked": True}),
        ("profile", {}),
        ("reload", {}),
        ("preflight", {}),
        ("end", {}),
        ("proposal", {"participant": "P01"}),
        ("assign", {"participant": "P01", "order": ["warm", "cold"]}),
        ("trial", {"what": "begin"}),
        ("check", {"check": "the door is shut"}),
        ("cancel", {"run": "a00001"}),
    ],
)
def test_a_participant_can_never_play_the_robot(
    tmp_path: Path, kind: str, fields: dict[str, Any]
) -> None:
    async def scenario(host: ServedSession) -> None:
        guest = await host.connect()
        await guest.hello("participant", take_over=True)
        before = host.session.hub.seq
        reply = await guest.ask(kind, **fields)
        assert not reply["ok"]
        assert reply["reason"] == "this console can only answer questionnaires"
        assert host.session.hub.seq == before
        assert not host.host.wizards

    hosted(tmp_path, scenario)


def test_a_participant_may_stop_and_asks_only_for_what_is_due(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        guest = await host.connect()
        await guest.hello("participant")
        reply = await guest.ask("questionnaire", questionnaire="ux", source="wizard")
        assert reply["reason"] == "the questionnaire 'ux' is not due yet"
        assert (await guest.ask("stop", source="key"))["ok"]
        assert host.session.bus.latched

    lines = hosted(tmp_path, scenario)
    (stop,) = (line for line in lines if isinstance(line, m.StopPressed))
    assert stop.source == "the participant", "the wizard has to know that it was not their own key"


def test_a_participant_alone_does_not_keep_the_session(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        guest = await host.connect()
        await guest.hello("participant")
        assert await asyncio.wait_for(host.host.serve(), 20) == "abandoned"

    hosted(tmp_path, scenario, SessionSettings(abandon_after=0.2))


def test_a_watcher_looks_on(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer = await host.connect()
        await peer.hello("watcher")
        for kind, fields in (
            ("proposal", {"participant": "P01"}),
            ("trial", {"what": "begin"}),
            ("questionnaire", {"questionnaire": "ux"}),
        ):
            reply = await peer.ask(kind, **fields)
            assert (reply["ok"], reply["command"]) == (False, "take_over")

    hosted(tmp_path, scenario)


@pytest.mark.parametrize(
    ("kind", "fields", "reason"),
    [
        ("proposal", {"participant": "x y"}, "'x y' is not a valid participant code"),
        ("assign", {"participant": "P01", "order": []}, "each participant gets all conditions"),
        ("trial", {"what": "done"}, "no trial is running"),
        ("trial", {"what": "finish"}, "Invalid enum value 'finish'"),
        ("answer", {"questionnaire": "ux", "item": "x"}, "the questionnaire 'ux' is not open"),
        ("check", {"check": "x"}, "the preflight list has no 'x'"),
    ],
)
def test_refusals_say_why(tmp_path: Path, kind: str, fields: dict[str, Any], reason: str) -> None:
    async def scenario(host: ServedSession) -> None:
        peer, _ = await wizard(host)
        reply = await peer.ask(kind, **fields)
        assert not reply["ok"]
        assert reason in reply["reason"]

    hosted(tmp_path, scenario)


def test_a_newcomer_is_told_how_the_study_stands(tmp_path: Path) -> None:
    async def scenario(host: ServedSession) -> None:
        peer, welcome = await wizard(host)
        study = welcome["settings"]["study"]
        assert study["design"] == {"order": "latin-square", "within": True, "trials": 2}
        assert study["blind"] == {"A": "A", "B": "B"}
        assert [each["name"] for each in study["questionnaires"]] == [
            "each",
            "ux",
            "last",
            "whenever",
        ]
        assert study["perception"] == {"hide": ["distance"], "blur": ["transcript"]}
        assert (study["assigned"], study["planned"], study["trial"]) == ([], 0, 1)
        await peer.ask("proposal", participant="P01")
        await peer.ask("assign", participant="P01", order=["warm", "cold"])
        await peer.ask("check", check="the door is shut")
        await peer.ask("trial", what="begin")
        await peer.ask("trial", what="break")
        late = await host.connect()
        welcome = await late.hello("watcher")
        study = welcome["settings"]["study"]
        assert (study["assigned"], study["planned"]) == (["A", "B"], 4)
        assert (study["trial"], study["running"], study["on_break"]) == (1, True, True)
        assert study["preflight"][0] == {"check": "the door is shut", "ok": True}
        kinds = [line["kind"] for line in welcome["state"]]
        for kind in (
            *("condition.assigned", "trial.started", "break.started"),
            *("preflight.checked", "perception.changed"),
        ):
            assert kind in kinds
        values = welcome["settings"]["values"]
        assert values["condition"] == "A"
        assert "greeting" not in values

    hosted(tmp_path, scenario)


def test_after_a_reload_the_study_is_told_again(tmp_path: Path) -> None:
    experiment = study_experiment(tmp_path)
    other = replace(experiment, study=replace(experiment.study, preflight=("the lamp is on",)))

    async def go() -> None:
        async with served_session(tmp_path, made=experiment, load=lambda: other) as host:
            peer, _ = await wizard(host)
            reply = await peer.ask("reload")
            assert reply["ok"], reply
            told = [line for line in peer.seen if line["kind"] == "panels"]
            assert told[-1]["study"]["preflight"] == [{"check": "the lamp is on", "ok": False}]
            assert reply["data"] == [
                "preflight 'the door is shut' was removed",
                "preflight 'the camera sees the table' was removed",
                "preflight 'the lamp is on' is new",
            ]

    asyncio.run(go())


def test_a_condition_that_was_renamed_is_not_told_to_a_blind_wizard(tmp_path: Path) -> None:
    async def go() -> None:
        async with served_session(
            tmp_path, made=study_experiment(tmp_path), load=lambda: renamed(tmp_path)
        ) as host:
            peer, _ = await wizard(host)
            assert (await peer.ask("assign", participant="P01", order=["A", "B"]))["ok"]
            assert (await peer.ask("reload"))["ok"]
            reply = await peer.ask("trial", what="begin")
            assert (reply["ok"], reply["command"]) == (False, "start")
            assert not re.search("warm|friendly", f"{reply} {peer.seen}")

    asyncio.run(go())


def test_two_hundred_earlier_logs_do_not_hold_up_the_robot(tmp_path: Path) -> None:
    """While they are read, a stop is answered."""
    filler = [m.Note(text="x" * 200) for _ in range(300)]
    for number in range(200):
        lines = [*filler, *had(f"P{number % 100:02}", ["warm", "cold"], "dd", row=0)]
        name = f"2026-02-01T10-{number // 60:02}-{number % 60:02}_S01"
        log(tmp_path / "recordings", name, lines, title=TITLE)

    async def scenario(host: ServedSession) -> None:
        peer, _ = await wizard(host)
        await peer.say(kind="proposal", ref=1, participant="P01")
        await peer.say(kind="stop", ref=2)
        first = await peer.kind("reply")
        assert first["ref"] == 2
        second = await peer.kind("reply")
        assert (second["ref"], second["data"]["row"], second["data"]["trial"]) == (1, 0, 3)

    hosted(tmp_path, scenario)
