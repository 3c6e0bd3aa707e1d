"""No robot learns a face before its owner has said yes, by whatever way it is asked for."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.session.engagement_rig import (
    PLAIN,
    WIZARD,
    EngagementRig,
    GuideDriver,
    effect,
    guided,
    in_room,
)
from tests.session.rig import (
    CONSENT_VERB,
    HERE,
    LEARN_VERB,
    action,
    call,
    together,
    with_verbs,
)
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.experiment import Action, DriverSpec, Panel
from woz_tui.drivers.contract import Ask, Job, Offer
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.welcome import PerceptionView, StudySettings
from woz_tui.session.redactor import Redactor

PROGRAM = RequestOrigin("program", "", "con2")
BY_ROBOT = replace(PLAIN, handshake=replace(PLAIN.handshake, by="robot"))


class Learner(GuideDriver):
    """Learns a face in a second, and forgets it, as a Pepper does."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return with_verbs(super().offer(settings), CONSENT_VERB, LEARN_VERB)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if job.verb == "learn_face":
            await asyncio.sleep(1.0)
        return await super().perform(job)

    @property
    def learnt(self) -> list[Json]:
        return [args["name"] for verb, args in self.calls if verb == "learn_face"]


def _keys() -> tuple[Action, ...]:
    consents, learns = call("face_consent", name="Anna"), call("learn_face", name="Anna")
    withdraws = call("face_consent", name="Anna", given=False)
    return (
        action("Consents", together(consents)),
        action("Learns", together(learns)),
        action("Consents and learns", together(consents), together(learns)),
        action("Withdraws", together(withdraws)),
        action("Anna", together(call("visitor", "engagement", code="Anna"))),
        action("{visitor} consents", together(call("face_consent", name="{visitor}"))),
    )


def played(
    tmp_path: Path,
    scenario: Callable[[EngagementRig], Awaitable[None]],
    settings: EngagementSettings = PLAIN,
    on_enter: Mapping[str, Action] | None = None,
) -> EngagementRig:
    experiment = guided(tmp_path, settings, on_enter)
    spec: DriverSpec = replace(experiment.drivers[0], offer=Learner.offer(None))
    panels = (*experiment.panels, Panel("Faces", _keys(), HERE))
    return in_room(
        tmp_path, scenario, replace(experiment, drivers=(spec,), panels=panels), kind=Learner
    )


def learnt(rig: EngagementRig) -> list[Json]:
    assert isinstance(rig.robot, Learner)
    return rig.robot.learnt


def refused(rig: EngagementRig) -> list[str]:
    return [line.code for line in rig.of(m.Refused)]


async def press(rig: EngagementRig, *names: str, origin: RequestOrigin = WIZARD) -> None:
    for name in names:
        try:
            rig.session.play(name, origin)
        except RequestError as error:
            assert "face_consent" in error.hint, error.reason
        await rig.visit(1.5)


@pytest.mark.parametrize("settings", [PLAIN, BY_ROBOT], ids=["by wizard", "by robot"])
def test_a_name_in_a_handshake_is_no_consent(tmp_path: Path, settings: EngagementSettings) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(6.0)
        assert rig.path[-1] == "Handshake"
        await press(rig, "Anna")

    rig = played(tmp_path, scenario, settings)
    assert "eng2know" in rig.outcomes
    assert learnt(rig) == []
    [notice] = [each for each in rig.of(m.Notice) if "face" in each.text]
    assert "face_consent" in notice.remedy
    assert notice.tells == ("identity",)


def test_who_consented_is_learnt_with_the_handshake(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(6.0)
        await press(rig, "Consents", "Anna")

    assert learnt(played(tmp_path, scenario)) == ["Anna"]


def test_the_present_visitor_consents_by_a_key_for_all(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(6.0)
        await press(rig, "Anna", "{visitor} consents", "Learns")

    rig = played(tmp_path, scenario)
    assert learnt(rig) == ["Anna"]
    [told] = [line for line in rig.of(m.Command) if line.verb == "face_consent"]
    [done] = [line for line in rig.of(m.Done) if line.command == told.command]
    sees_all, blind = Redactor(), Redactor(StudySettings(perception=PerceptionView(["identity"])))
    for line in (told, done):
        assert "Anna" in str(sees_all.message(line))
        assert "Anna" not in str(blind.message(line)), "a wizard to whom names are not shown"


def test_a_key_of_the_file_learns_nothing_without_a_consent(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await press(rig, "Learns")

    rig = played(tmp_path, scenario)
    assert learnt(rig) == []
    [end] = rig.of(m.Refused)
    assert end.code == "consent"
    assert "face_consent" in end.remedy


def test_a_consent_is_for_a_name_and_good_for_one_learning(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await press(rig, "Consents")
        rig.tell("learn_face", name="Berta")
        rig.tell("learn_face", name=" ANNA ")
        await asyncio.sleep(1.5)
        rig.tell("learn_face", name="Anna")

    rig = played(tmp_path, scenario)
    assert learnt(rig) == [" ANNA "]
    assert refused(rig) == ["consent", "consent"]


def test_one_key_may_do_both(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await press(rig, "Consents and learns")

    assert learnt(played(tmp_path, scenario)) == ["Anna"]


@pytest.mark.parametrize(
    "origin",
    [
        PROGRAM,
        RequestOrigin("engagement", "", "con2"),
        RequestOrigin("key", "k", "con2"),
        RequestOrigin("move", "", "robot"),
    ],
    ids=["program", "as the model", "typed", "driver"],
)
def test_a_verb_by_itself_gives_no_consent(tmp_path: Path, origin: RequestOrigin) -> None:
    async def scenario(rig: EngagementRig) -> None:
        rig.session.send("face_consent", {"name": "Anna"}, "", origin)
        await asyncio.sleep(0.5)
        rig.session.send("learn_face", {"name": "Anna"}, "", origin)

    rig = played(tmp_path, scenario)
    assert learnt(rig) == []
    assert refused(rig) == ["consent", "consent"]


@pytest.mark.parametrize(
    "source",
    ["program", "phase", "engagement", "replay", "gamepad", "stream-deck", "driver", "pedal"],
)
def test_what_no_person_presses_gives_no_consent(tmp_path: Path, source: str) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await press(rig, "Consents and learns", origin=RequestOrigin(source, "1", "con2"))

    rig = played(tmp_path, scenario)
    assert learnt(rig) == []
    assert refused(rig) == ["consent"]


def test_a_driver_that_claims_a_key_gives_no_consent(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        ask = Ask("action", "Consents and learns", source="key", key="h")
        rig.session.drivers["robot"].context.ask(ask)
        await asyncio.sleep(2.0)

    rig = played(tmp_path, scenario)
    assert learnt(rig) == []
    assert [line.source for line in rig.of(m.ActionRequested)] == ["driver"]


def test_a_panel_of_the_robot_gives_one(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        ask = Ask("action", "Consents and learns", source="midi", key="button 3")
        rig.session.drivers["robot"].context.ask(ask)
        await asyncio.sleep(2.0)

    assert learnt(played(tmp_path, scenario)) == ["Anna"]


def test_the_engagement_model_gives_no_consent_by_itself(tmp_path: Path) -> None:
    steps = (
        together(call("face_consent", name="{visitor}")),
        together(call("learn_face", name="{visitor}")),
    )

    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(6.0)
        await press(rig, "Anna")

    rig = played(tmp_path, scenario, on_enter=effect("EngagedWithKnown", *steps))
    assert learnt(rig) == []
    assert refused(rig) == ["consent"]


def test_what_is_withdrawn_counts_no_more(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await press(rig, "Consents", "Withdraws", "Learns")

    rig = played(tmp_path, scenario)
    assert learnt(rig) == []
    assert ("face_consent", {"name": "Anna", "given": False}) in rig.robot.calls, "it deletes"


def test_what_a_program_withdraws_counts_no_more(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await press(rig, "Consents")
        rig.session.send("face_consent", {"name": "anna", "given": False}, "", PROGRAM)
        await press(rig, "Learns")

    assert learnt(played(tmp_path, scenario)) == []


def test_a_consent_withdrawn_under_the_stop_or_in_the_queue_counts_no_more(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        await press(rig, "Consents")
        rig.session.stop("key")
        await asyncio.sleep(1.0)
        rig.session.send("face_consent", {"name": "Anna", "given": False}, "", WIZARD)
        rig.session.release("key")
        await press(rig, "Learns")

    assert learnt(played(tmp_path, scenario)) == []


def test_a_consent_withdrawn_while_the_learning_waits_counts_no_more(tmp_path: Path) -> None:
    async def scenario(rig: EngagementRig) -> None:
        for name in ("Anna", "Berta"):
            key = action(f"{name} consents", together(call("face_consent", name=name)))
            rig.session.runner.play(key, WIZARD)
        await asyncio.sleep(0.5)
        for name in ("Berta", "Anna"):
            rig.tell("learn_face", name=name)
        await asyncio.sleep(0.5)
        rig.tell("face_consent", name="Anna", given=False)

    rig = played(tmp_path, scenario)
    assert learnt(rig) == ["Berta"]
    assert refused(rig) == ["consent"]
