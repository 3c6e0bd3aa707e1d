"""What "that was a mistake" means: what was heard or seen last, not what was pressed last."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.session.rig import ScriptedDriver, SessionRig, action, call, experiment, together
from woz_tui.drivers.contract import Argument, Job, Offer, Verb
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError

KEY = RequestOrigin("key", "h", "con1")
TURNED = action("Turned", together(call("play", move="turn"), call("say", text="There")))


class SteeredDriver(ScriptedDriver):
    """Its head follows arrow keys."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        offered = super().offer(settings)
        head = Verb("nudge", "", (Argument("yaw", "number"),), lane="head", brief=True)
        return replace(offered, verbs=(*offered.verbs, head))

    async def perform(self, job: Job) -> Mapping[str, Json]:
        return {} if job.verb == "nudge" else await super().perform(job)


def marked(tmp_path: Path, scenario: Callable[[SessionRig], Awaitable[None]]) -> list[str]:
    """Actions and verbs that were marked as mistakes."""
    made = experiment(tmp_path)
    speech = replace(made.panels[0], actions=(*made.panels[0].actions, TURNED))
    (robot,) = made.drivers
    robot = replace(robot, offer=SteeredDriver.offer(None))
    made = replace(made, panels=(speech, *made.panels[1:]), drivers=(robot,))
    rig = SessionRig(tmp_path, made=made, catalogue={"puppet": SteeredDriver})
    rig = rig.run(scenario, 8)
    return [line.action for line in rig.of(m.Mistake)]


def test_what_waits_behind_a_sentence_is_not_meant(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        rig.session.play("Map", KEY)
        rig.session.mistake("", "")
        await asyncio.sleep(1.2)  # the map is being said
        rig.session.mistake("", "")

    assert marked(tmp_path, scenario) == ["Hello", "Map"]


@pytest.mark.parametrize("waiting", ["Welcome", "Turned"])
def test_a_gesture_whose_sentence_waits_is_not_meant(tmp_path: Path, waiting: str) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        rig.session.play(waiting, KEY)
        await asyncio.sleep(0.2)  # it moves already
        rig.session.mistake("", "")
        await asyncio.sleep(1.0)
        rig.session.mistake("", "")

    assert marked(tmp_path, scenario) == ["Hello", waiting]


def test_what_was_refused_is_not_meant(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        with pytest.raises(RequestError):
            rig.session.play("Never", KEY)  # it is locked
        with pytest.raises(RequestError, match="nothing has been played"):
            rig.session.mistake("", "")
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        with pytest.raises(RequestError):
            rig.session.play("Never", KEY)
        rig.session.mistake("", "")

    assert marked(tmp_path, scenario) == ["Hello"]


def test_what_a_hand_steers_is_not_meant(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        rig.session.send("nudge", {"yaw": 10.0}, "", KEY)  # back to the visitor
        await asyncio.sleep(1)
        rig.session.mistake("", "")

    assert marked(tmp_path, scenario) == ["Hello"]


def test_what_ended_last_is_meant_and_a_silent_act_too(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Hello", KEY)
        await asyncio.sleep(2)
        rig.session.play("Fall", KEY)
        await asyncio.sleep(2)
        rig.session.mistake("", "")

    assert marked(tmp_path, scenario) == ["Fall"]


def test_a_later_sentence_of_an_action_counts_and_its_gesture_does_not(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Map", KEY)  # a sentence, a pause, a gesture
        await asyncio.sleep(1.1)
        rig.session.send("say", {"text": "x"}, "", KEY)
        await asyncio.sleep(0.6)  # the gesture of the map has begun
        rig.session.mistake("", "")

    assert marked(tmp_path, scenario) == ["say"]
