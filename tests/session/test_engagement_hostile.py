"""Whatever is published or asked for: the model goes on, and so does everybody who listens."""

from __future__ import annotations

import asyncio
import math
import random
import tempfile
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.sensing.test_engagement_stream import MESSAGES
from tests.session.engagement_rig import WIZARD, EngagementRig, effect, guided, in_room
from tests.session.rig import call, together
from woz_tui.config.engagement import EngagementSettings, HandshakeSettings
from woz_tui.config.session_verbs import ENGAGEMENT_VERBS
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError

STEPS = st.lists(st.tuples(MESSAGES, st.floats(0, 3)), max_size=30)
ASKING = EngagementSettings(handshake=HandshakeSettings(by="robot"))


@given(STEPS)
def test_no_message_fails_in_the_hub(steps: list[tuple[Any, float]]) -> None:
    """E9: in a whole session, with effects, handshake and attention."""

    async def scenario(rig: EngagementRig) -> None:
        for message, pause in steps:
            rig.session.hub.publish(message)
            await asyncio.sleep(pause)

    effects = effect("PersonDetected", together(call("say", text="Come near")))
    with tempfile.TemporaryDirectory() as name:
        rig = in_room(Path(name), scenario, guided(Path(name), ASKING, effects), linger=0)
    assert not [text for text in rig.notices if "the engagement model failed" in text]


def test_no_verb_fails_whatever_it_says(tmp_path: Path) -> None:
    """E7, E9: each verb with each kind of junk ends in one way, and the model lives."""
    junk: list[Any] = [None, "", "on", "Wait", "done", -1, 1e300, math.nan, True, [], {"a": 1}]
    names = ["sign", "value", "to", "run", "kind", "samples", "threshold", "metres", "code", "what"]

    async def scenario(rig: EngagementRig) -> None:
        chance = random.Random(1)
        for _ in range(1500):
            verb = chance.choice([*ENGAGEMENT_VERBS])
            args = {chance.choice(names): chance.choice(junk) for _ in range(3)}
            rig.tell(verb, **args)
            await asyncio.sleep(0.001)
        await rig.visit(4, identity="V1")

    rig = in_room(tmp_path, scenario)
    asked = [line for line in rig.of(m.Command) if line.driver == "engagement"]
    ended = [line for line in rig.of(m.End) if line.command in {each.command for each in asked}]
    assert len(asked) == len(ended) >= 1500
    assert not [text for text in rig.notices if "failed" in text]
    assert not rig.of(m.Failed)


def test_a_failure_inside_is_told_once_and_the_session_goes_on(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    async def scenario(rig: EngagementRig) -> None:
        model = rig.session.engagement._model
        assert model is not None
        model.follower.sensors.update(presence="no sign at all", gaze="none either")
        for _ in range(5):
            rig.sense(presence=1, gaze=1)
        with_robot = rig.session.play("Welcome", WIZARD)
        assert with_robot

    rig = in_room(tmp_path, scenario)
    told = [text for text in rig.notices if "the engagement model failed" in text]
    assert len(told) == len(set(told)) == 2
    assert len([record for record in caplog.records if record.exc_info]) == 2
    assert ("say", {"text": "Welcome"}) in rig.robot.calls


@pytest.mark.parametrize("place", ["no/such/folder/\0visitors.json", ".", "file/visitors.json"])
def test_a_place_that_takes_no_file_costs_no_name(tmp_path: Path, place: str) -> None:
    (tmp_path / "file").touch()
    settings = EngagementSettings(signals="none", visitors=str(tmp_path / place))

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("sense", sign="all", value="on")
        await asyncio.sleep(0.1)
        rig.tell("visitor", code="Anna")
        await asyncio.sleep(0.5)
        model = rig.session.engagement._model
        assert model is not None
        visiting = model.visitors
        visiting.visitors.wait(10)
        await asyncio.sleep(0.5)
        assert visiting.visitors.is_taken("anna")

    rig = in_room(tmp_path, scenario, guided(tmp_path, settings))
    assert rig.path[-1] == "EngagedWithKnown"
    assert any(text.startswith("visitors: ") for text in rig.notices)


def test_nothing_comes_after_the_end(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.tell("force", to="RobotReplies")
        await asyncio.sleep(0.1)
        await rig.session.close("early")
        seen = len(rig.lines)
        rig.sense(presence=1)
        await asyncio.sleep(200)
        assert len(rig.lines) == seen + 1
        try:
            rig.tell("toggle", sign="gaze")
        except RequestError:
            return
        raise AssertionError

    in_room(tmp_path, scenario)
