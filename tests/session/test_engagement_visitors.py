"""Who stands there: handshakes by the wizard and by the robot, and the store of visitors."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from datetime import date
from pathlib import Path
from typing import Any

import msgspec
import pytest

from tests.session.engagement_rig import PLAIN, EngagementRig, GuideDriver, guided, in_room
from tests.session.rig import CONSENT_VERB, LEARN_VERB, with_verbs
from woz_tui.config.engagement import HandshakeSettings
from woz_tui.drivers.contract import Job, Offer
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.sensing.visitor_store import VisitorStore

pytestmark = pytest.mark.safety

KNOWN = "EngagedWithKnown"
ASKING = replace(PLAIN, handshake=HandshakeSettings(by="robot", seconds=40.0, silence=4.0))


def stranger(
    scenario: Callable[[EngagementRig], Awaitable[None]],
) -> Callable[[EngagementRig], Awaitable[None]]:
    """Somebody without a name is engaged before `scenario`."""

    async def go(rig: EngagementRig) -> None:
        rig.tell("sense", sign="all", value="on")
        await asyncio.sleep(0.1)
        await scenario(rig)

    return go


async def answers(rig: EngagementRig, segment: int, text: str) -> None:
    """Wait until the robot has asked, then say something."""
    await asyncio.sleep(1.5)
    await rig.hears(segment, 0.8)
    rig.session.hub.publish(m.SpeechText(driver="robot", segment=segment, text=text))


def stored(tmp_path: Path) -> list[str]:
    path = tmp_path / "recordings" / "visitors.json"
    return [visitor.name for visitor in VisitorStore(path).everybody()]


def saves(rig: EngagementRig) -> None:
    """Wait for the thread that writes the file."""
    model = rig.session.engagement._model
    assert model is not None
    visiting = model.visitors
    visiting.visitors.wait(10)


def test_the_wizard_is_told_and_gives_a_name(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        assert rig.engagement_shown.state == "Handshake"
        assert any("who is it" in text for text in rig.notices)
        rig.tell("visitor", code="Anna", age_group="adult")
        await asyncio.sleep(0.5)
        saves(rig)

    rig = in_room(tmp_path, stranger(scenario))
    assert rig.path[-2:] == ["Handshake", KNOWN]
    assert rig.outcomes[-1] == "eng2know"
    (changed,) = rig.of(m.VisitorChanged)
    assert (changed.visitor, changed.what) == ("Anna", "learnt")
    assert changed.about == {"age_group": "adult"}
    assert stored(tmp_path) == ["Anna"]


def test_a_name_that_is_known_is_that_visitor_and_nothing_is_overwritten(tmp_path: Path) -> None:
    store = VisitorStore(tmp_path / "recordings" / "visitors.json")
    store.path.parent.mkdir()
    store.add("Anna", on=date(2026, 1, 1), age_group="adult")

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("visitor", code="anna", age_group="child", address="formal")
        await asyncio.sleep(0.5)
        saves(rig)

    rig = in_room(tmp_path, stranger(scenario))
    assert [change.what for change in rig.of(m.VisitorChanged)] == ["met", "profile"]
    assert rig.engagement_shown.visitor == "Anna"
    assert any("age group adult; the file keeps this" in text for text in rig.notices)
    (anna,) = VisitorStore(store.path).everybody()
    assert (anna.name, anna.about) == ("Anna", {"age_group": "adult", "address": "formal"})
    assert anna.meetings == 2


def test_the_wizard_goes_on_without_a_name(tmp_path: Path) -> None:
    settings = replace(PLAIN, handshake=HandshakeSettings(attempts=2))

    async def scenario(rig: EngagementRig) -> None:
        for _ in range(2):
            rig.tell("handshake", what="fail")
            await asyncio.sleep(0.3)
        rig.tell("handshake", what="ok")
        await asyncio.sleep(0.3)

    rig = in_room(tmp_path, stranger(scenario), guided(tmp_path, settings))
    assert rig.outcomes[-4:] == ["handshake", "eng2unknow", "handshake", "eng2unknow"]
    (refused,) = rig.of(m.Refused)
    assert "no handshake to end" in refused.reason


def test_bad_names_are_refused_with_a_reason(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        for name in ("", " \t", "x" * 500, "a\x1bb", "Unknown"):
            rig.tell("visitor", code=name)
        await asyncio.sleep(0.3)

    rig = in_room(tmp_path, stranger(scenario))
    assert len(rig.of(m.Refused)) == 5
    assert rig.engagement_shown.state == "Handshake"


def test_a_recogniser_that_finds_the_name_ends_the_handshake(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(4, identity="V1")

    rig = in_room(tmp_path, stranger(scenario))
    assert rig.outcomes[-2:] == ["handshake", "eng2know"]
    assert rig.engagement_shown.visitor == "V1"


def test_the_robot_asks_repeats_and_learns(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await answers(rig, 1, "My name is Bruno")
        await answers(rig, 2, "Yes!")
        await asyncio.sleep(2)
        saves(rig)

    rig = in_room(tmp_path, stranger(scenario), guided(tmp_path, ASKING))
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said == [
        ASKING.handshake.ask,
        "Bruno, is that right?",
        "Nice to meet you, Bruno!",
    ]
    assert "eng2know" in rig.outcomes
    assert stored(tmp_path) == ["Bruno"]
    assert ("visitor", {"code": "Bruno"}) in rig.commands


class ConsentingFaceDriver(GuideDriver):
    """Learns the faces of people who consented."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return with_verbs(super().offer(settings), CONSENT_VERB, LEARN_VERB)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if job.verb == "face_consent":
            await asyncio.sleep(0.5)  # a slow one
        return await super().perform(job)


@pytest.mark.parametrize("answer", ["Yes, you may.", "No!"])
def test_a_face_is_learnt_after_a_consent_that_is_in_the_log(tmp_path: Path, answer: str) -> None:
    question = "May I remember your face, {name}?"
    settings = replace(ASKING, handshake=replace(ASKING.handshake, face_consent=question))
    experiment = guided(tmp_path, settings)
    spec = replace(experiment.drivers[0], offer=ConsentingFaceDriver.offer(None))

    async def scenario(rig: EngagementRig) -> None:
        await answers(rig, 1, "My name is Bruno")
        await answers(rig, 2, "Yes!")
        await answers(rig, 3, answer)
        await asyncio.sleep(3)
        saves(rig)

    rig = in_room(
        tmp_path,
        stranger(scenario),
        replace(experiment, drivers=(spec,)),
        kind=ConsentingFaceDriver,
    )
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said[2:] == ["May I remember your face, Bruno?", "Nice to meet you, Bruno!"]
    told = [verb for verb, _ in rig.commands if verb in ("face_consent", "visitor", "learn_face")]
    yes = answer.startswith("Yes")
    assert told == (["face_consent", "visitor", "learn_face"] if yes else ["visitor"])
    if yes:
        assert ("face_consent", {"name": "Bruno", "given": True}) in rig.commands
    assert stored(tmp_path) == ["Bruno"], "the name is kept in any case"
    assert not [text for text in rig.notices if "did not learn" in text]


class FaceLearningDriver(GuideDriver):
    """Learns a face whoever asks for it, as a Pepper does."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return with_verbs(super().offer(settings), LEARN_VERB)


def test_a_name_that_the_wizard_gives_is_no_consent(tmp_path: Path) -> None:
    settings = replace(ASKING, handshake=replace(ASKING.handshake, face_consent="Your face?"))
    experiment = guided(tmp_path, settings)
    spec = replace(experiment.drivers[0], offer=FaceLearningDriver.offer(None))

    async def scenario(rig: EngagementRig) -> None:
        await answers(rig, 1, "My name is Bruno")
        await answers(rig, 2, "Yes!")
        await asyncio.sleep(1.5)
        rig.tell("visitor", code="Bruno")
        await asyncio.sleep(2)
        saves(rig)

    rig = in_room(
        tmp_path, stranger(scenario), replace(experiment, drivers=(spec,)), kind=FaceLearningDriver
    )
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert "Your face?" in said
    assert "learn_face" not in [verb for verb, _ in rig.commands]
    assert stored(tmp_path) == ["Bruno"]


def test_the_name_counts_where_the_time_ends_with_the_question_for_the_face(
    tmp_path: Path,
) -> None:
    handshake = replace(ASKING.handshake, seconds=10.0, silence=8.0, face_consent="Your face?")
    experiment = guided(tmp_path, replace(ASKING, handshake=handshake))
    spec = replace(experiment.drivers[0], offer=FaceLearningDriver.offer(None))

    async def scenario(rig: EngagementRig) -> None:
        await answers(rig, 1, "My name is Bruno")
        await answers(rig, 2, "Yes!")
        await asyncio.sleep(12)
        saves(rig)

    rig = in_room(
        tmp_path, stranger(scenario), replace(experiment, drivers=(spec,)), kind=FaceLearningDriver
    )
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said[-2:] == ["Your face?", "Nice to meet you, Bruno!"]
    assert "eng2unknow" not in rig.outcomes
    assert "learn_face" not in [verb for verb, _ in rig.commands]
    assert stored(tmp_path) == ["Bruno"]


def test_silence_is_asked_again_and_then_left_alone(tmp_path: Path) -> None:
    """Attempts and time are bounded."""

    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(60)

    rig = in_room(tmp_path, stranger(scenario), guided(tmp_path, ASKING))
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said == [
        ASKING.handshake.ask,
        ASKING.handshake.again,
        ASKING.handshake.again,
        ASKING.handshake.give_up,
    ]
    assert rig.outcomes[-2:] == ["handshake", "eng2unknow"]
    assert max(shown.attempt for shown in rig.of(m.EngagementShown)) == 3


def test_what_the_robot_hears_of_itself_is_no_answer(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await rig.hears(1, 0.5)
        rig.session.hub.publish(m.SpeechText(driver="robot", segment=1, text="my name is Robot"))
        await asyncio.sleep(1)

    rig = in_room(tmp_path, stranger(scenario), guided(tmp_path, ASKING), linger=0.1)
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said == [ASKING.handshake.ask]


def test_an_answer_into_the_question_is_one_where_the_microphone_tells_it_apart(
    tmp_path: Path,
) -> None:
    """By its words: it was the robot's own voice until they were known."""

    async def scenario(rig: EngagementRig) -> None:
        publish = rig.session.hub.publish
        publish(m.SpeechStarted(driver="robot", segment=1, began=0, own=True))
        publish(m.SpeechEnded(driver="robot", segment=1, began=0, ended=1, own=True))
        await asyncio.sleep(1.5)
        spoken = m.SpeechText(driver="robot", segment=1, text="my name is Kim")
        publish(msgspec.structs.replace(spoken, text="what is your name", own=True))
        publish(msgspec.structs.replace(spoken, own=False, overlap=True))
        await asyncio.sleep(1.5)

    rig = in_room(tmp_path, stranger(scenario), guided(tmp_path, ASKING), linger=0.1)
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said == [ASKING.handshake.ask, ASKING.handshake.confirm.replace("{name}", "Kim")]


def test_the_stop_silences_the_question_and_its_release_asks_anew(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(0.5)
        rig.session.stop("key")
        await asyncio.sleep(10)
        rig.session.release("key")
        await asyncio.sleep(2)
        rig.tell("visitor", code="Carla")
        await asyncio.sleep(2)

    rig = in_room(tmp_path, stranger(scenario), guided(tmp_path, ASKING), linger=0.1)
    said = [args["text"] for verb, args in rig.robot.calls if verb == "say"]
    assert said == [ASKING.handshake.ask] * 2 + ["Nice to meet you, Carla!"]


def test_a_stop_that_outlasts_the_handshake_says_how_it_goes_on(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(0.5)
        rig.session.stop("key")
        await asyncio.sleep(60)
        assert rig.engagement_shown.state == "EngagedWithUnknown"
        rig.session.release("key")
        await asyncio.sleep(2)

    rig = in_room(tmp_path, stranger(scenario), guided(tmp_path, ASKING), linger=0.1)
    assert any("handshake: begin" in notice.remedy for notice in rig.of(m.Notice))


def test_buttons_say_the_name_of_who_takes_the_place_of_a_visitor(tmp_path: Path) -> None:
    def shown(rig: EngagementRig) -> str:
        filled = rig.session.state.filled
        assert filled is not None
        step = filled.actions["Greet"][0]
        assert isinstance(step, list)
        return str(step[0].args["text"])

    async def scenario(rig: EngagementRig) -> None:
        for name in ("Anna", "Bruno"):
            rig.tell("sense", sign="identity", value=name)
            await asyncio.sleep(2.0)
            assert (rig.session.values()["visitor"], shown(rig)) == (name, f"Hello {name}")

    in_room(tmp_path, stranger(scenario))


def test_a_store_that_cannot_be_read_costs_a_notice_and_no_name(tmp_path: Path) -> None:
    path = tmp_path / "recordings" / "visitors.json"
    path.parent.mkdir()
    path.write_text("{ this is no store")

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("visitor", code="Anna")
        await asyncio.sleep(0.3)
        saves(rig)
        await asyncio.sleep(0.3)
        assert rig.session.values()["visitor"] == "Anna"

    rig = in_room(tmp_path, stranger(scenario))
    notices = [line for line in rig.of(m.Notice) if line.text.startswith("visitors: ")]
    assert notices
    assert all(notice.remedy for notice in notices)
    assert path.read_text() == "{ this is no store"
    assert rig.path[-1] == KNOWN


def test_the_store_may_lie_elsewhere(tmp_path: Path) -> None:
    settings = replace(PLAIN, visitors=str(tmp_path / "people" / "known.json"))

    async def scenario(rig: EngagementRig) -> None:
        rig.tell("visitor", code="Anna")
        await asyncio.sleep(0.3)
        saves(rig)

    in_room(tmp_path, stranger(scenario), guided(tmp_path, settings))
    assert "Anna" in json.dumps(json.loads((tmp_path / "people" / "known.json").read_text()))


def test_the_wizard_types_the_answer_that_nobody_hears(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await asyncio.sleep(1.5)
        assert any("no device recognises" in text for text in rig.notices)
        rig.tell("visitor", code="Anna")
        await asyncio.sleep(1.5)
        saves(rig)

    rig = in_room(tmp_path, stranger(scenario), guided(tmp_path, ASKING))
    assert (rig.engagement_shown.state, rig.engagement_shown.visitor) == (KNOWN, "Anna")
    assert stored(tmp_path) == ["Anna"]
    said = [str(sent.args["text"]) for sent in rig.of(m.Command) if sent.verb == "say"]
    assert said == [ASKING.handshake.ask, "Nice to meet you, Anna!"]
