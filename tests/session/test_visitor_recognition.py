"""Who was introduced is recognised the next time, by a robot that can learn faces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from tests.session.engagement_rig import WIZARD, EngagementRig, GuideDriver, guided, in_room
from tests.session.rig import CONSENT_VERB, LEARN_VERB, action, call, together, with_verbs
from woz_tui.config.experiment import DriverSpec
from woz_tui.drivers.contract import FACE_CONSENT, LEARN_FACE, DriverError, Job, Offer
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json


class FaceLearningDriver(GuideDriver):
    """A guide that learns faces, unless nobody shows one."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return with_verbs(super().offer(settings), CONSENT_VERB, LEARN_VERB)

    async def perform(self, job: Job) -> Mapping[str, Json]:
        if job.verb == LEARN_FACE and job.args.get("name") == "Nobody":
            raise DriverError("nobody shows a face", "wait for somebody")
        return await super().perform(job)


def introduced(
    tmp_path: Path, name: str, kind: type[GuideDriver] = FaceLearningDriver, sees: str = ""
) -> EngagementRig:
    """A stranger is engaged, consents and is named; the camera may call them `sees`."""

    async def scenario(rig: EngagementRig) -> None:
        await rig.visit(6.0)
        assert rig.path[-1] == "Handshake"
        consents = together(call(FACE_CONSENT, name=name))
        rig.session.runner.play(action("Consents", consents), WIZARD)
        if sees:
            await rig.visit(6.0, identity=sees)
        else:
            rig.tell("visitor", code=name)

    experiment = guided(tmp_path)
    spec: DriverSpec = replace(experiment.drivers[0], offer=kind.offer(None))
    return in_room(tmp_path, scenario, replace(experiment, drivers=(spec,)), kind=kind, linger=2)


def learnt(rig: EngagementRig) -> list[Json]:
    return [args["name"] for verb, args in rig.commands if verb == LEARN_FACE]


def test_the_face_of_whoever_was_introduced_gets_the_name(tmp_path: Path) -> None:
    rig = introduced(tmp_path, "Kim")
    assert "eng2know" in rig.outcomes
    assert learnt(rig) == ["Kim"]
    assert [line.driver for line in rig.of(m.Command) if line.verb == LEARN_FACE] == ["robot"]


def test_a_face_that_was_not_learnt_is_told_of(tmp_path: Path) -> None:
    rig = introduced(tmp_path, "Nobody")
    assert "robot did not learn the face of Nobody: nobody shows a face" in rig.notices


def test_a_face_that_is_recognised_has_its_name_already(tmp_path: Path) -> None:
    rig = introduced(tmp_path, "", sees="V1")
    assert "eng2know" in rig.outcomes
    assert learnt(rig) == []


def test_a_robot_that_learns_no_faces_is_not_asked_to(tmp_path: Path) -> None:
    rig = introduced(tmp_path, "Kim", kind=GuideDriver)
    assert "eng2know" in rig.outcomes
    assert learnt(rig) == []
