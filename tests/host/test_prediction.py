"""How something would go: told without moving, and to nobody who may not know."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from woz_drivers.simulated import SimulatedRobot, SimulatedSettings

from tests.host.rig import ServedSession, served_session
from tests.host.test_programs import program
from tests.session.rig import action, call, experiment, together, with_script
from woz_tui.config.experiment import DriverSpec, Experiment, Panel, Wait
from woz_tui.features.study.design import Design
from woz_tui.features.study.section import DESIGN
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import PROTOCOL

#: 14 characters take a second.
TEXT = "one two three."


def simulated(folder: Path) -> Experiment:
    made, settings = experiment(folder), SimulatedSettings()
    place = made.panels[0].place
    spec = DriverSpec("robot", "simulated", settings, SimulatedRobot.offer(settings), place)
    actions = (
        action("Greet", together(call("say", text=TEXT), call("play", move="nod"))),
        action(
            "Show",
            together(call("say", text=TEXT)),
            Wait(0.5),
            together(call("play", move="nod"), call("mark", "session", text="shown")),
        ),
        action("Look", together(call("gaze", yaw=10.0)), together(call("say", text=TEXT))),
        action("Who", together(call("say", text="{greeting} {participant}"))),
    )
    made = replace(made, drivers=(spec,), panels=(Panel("P", actions, place),), variables={})
    return with_script(made)


def robot(folder: Path, made: Experiment | None = None) -> Any:
    return served_session(
        folder, made=made or simulated(folder), catalogue={"simulated": SimulatedRobot}
    )


def driver_messages(host: ServedSession) -> list[m.Message]:
    return host.of(m.Command, m.ActionRequested)


async def test_a_verbs_duration_words_and_stroke(tmp_path: Path) -> None:
    async with robot(tmp_path) as host:
        peer = await program(host)
        said = (await peer.ask("predict", verb="say", args={"text": TEXT}))["data"]
        assert said["duration_us"] == 1_000_000
        [command] = said["commands"]
        assert (command["verb"], command["driver"], command["begins_us"]) == ("say", "robot", 0)
        words = [(mark["sort"], mark["text"]) for mark in command["marks"]]
        assert words == [("word", "one"), ("word", "two"), ("word", "three.")]
        played = (await peer.ask("predict", verb="play", args={"move": "nod", "speed": 2.0}))[
            "data"
        ]
        assert played["duration_us"] == 600_000
        assert played["commands"][0]["marks"] == [{"at_us": 120_000, "sort": "stroke"}]
        assert not driver_messages(host)


async def test_an_actions_steps_add_up(tmp_path: Path) -> None:
    async with robot(tmp_path) as host:
        peer = await program(host)
        greet = (await peer.ask("predict", action="Greet"))["data"]
        assert greet["duration_us"] == 1_200_000
        show = (await peer.ask("predict", action="Show"))["data"]
        assert [command["begins_us"] for command in show["commands"]] == [0, 1_500_000, 1_500_000]
        assert show["duration_us"] == 2_700_000
        assert not driver_messages(host)


async def test_what_nobody_knows_is_null(tmp_path: Path) -> None:
    async with robot(tmp_path) as host:
        peer = await program(host)
        look = (await peer.ask("predict", action="Look"))["data"]
        assert look["duration_us"] is None
        assert look["commands"][0]["duration_us"] is None
        assert look["commands"][1]["begins_us"] == 0, "a gaze is done when it was taken"
    async with served_session(tmp_path / "other") as host:
        peer = await program(host)
        said = (await peer.ask("predict", verb="say", args={"text": TEXT}))["data"]
        assert (said["duration_us"], said["commands"][0]["marks"]) == (None, None)


@pytest.mark.parametrize(
    ("fields", "reason"),
    [
        ({"verb": "say", "args": {}}, "needs 'text'"),
        ({"verb": "fly"}, "offers 'fly'"),
        ({"action": "Fly"}, "no action 'Fly'"),
        ({"action": "Who"}, "greeting"),
        ({}, "either"),
        ({"action": "Greet", "verb": "say"}, "either"),
    ],
)
async def test_what_would_be_refused_is_refused(
    tmp_path: Path, fields: dict[str, Any], reason: str
) -> None:
    async with robot(tmp_path) as host:
        peer = await program(host)
        reply = await peer.ask("predict", **fields)
        assert not reply["ok"]
        assert reason in reply["reason"]


async def test_the_marks_come_as_they_were_foretold(tmp_path: Path) -> None:
    async with robot(tmp_path) as host:
        peer = await program(host)
        await peer.ask("verb", verb="say", args={"text": TEXT})
        await peer.kind("command.done")
        marks = [line for line in peer.seen if line["kind"] == "command.mark"]
        assert [(mark["sort"], mark["text"]) for mark in marks] == [
            ("word", "one"),
            ("word", "two"),
            ("word", "three."),
        ]
        await peer.ask("verb", verb="play", args={"move": "nod"})
        stroke = await peer.kind("command.mark")
        assert stroke["sort"] == "stroke"


async def test_a_blind_wizard_gets_no_words_and_no_times(tmp_path: Path) -> None:
    made = simulated(tmp_path)
    design = Design(blind={"warm": "1", "cold": "2"})
    made = replace(
        made,
        sections={**made.sections, DESIGN: design},
        by_condition={"greeting": {"warm": "How lovely", "cold": "Hello"}},
    )
    async with robot(tmp_path, made) as host:
        wizard, peer = await host.connect(), await program(host)
        await wizard.hello("wizard", protocol=PROTOCOL)
        known = (await peer.ask("predict", action="Who"))["data"]
        assert [mark["text"] for mark in known["commands"][0]["marks"]][:2] == ["How", "lovely"]
        hidden = (await wizard.ask("predict", action="Who"))["data"]
        assert (hidden["duration_us"], hidden["commands"][0]["marks"]) == (None, None)
        assert (await wizard.ask("action", action="Who"))["ok"]
        await wizard.kind("action.done")
        await peer.kind("action.done")
        assert [line for line in peer.seen if line["kind"] == "command.mark"]
        assert not [line for line in wizard.seen if line["kind"] == "command.mark"]
