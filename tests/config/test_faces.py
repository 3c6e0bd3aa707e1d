"""What a file says of faces that are learnt: whom a consent reaches, and a warning without one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from tests.config.catalogue import CATALOGUE, Bare, NoSettings
from tests.config.reading import panel
from woz_tui.config.experiment import Experiment
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver, Offer
from woz_tui.drivers.robot_verbs import common_verb


class Eye(Bare):
    """Learns faces."""

    Settings = NoSettings

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        return Offer(
            verbs=(common_verb("say"), common_verb("face_consent"), common_verb("learn_face")),
            sensors=("presence", "gaze", "distance", "identity", "speech", "speech.text"),
        )


CATALOGUE_WITH_EYE: Mapping[str, type[Driver]] = {**CATALOGUE, "eye": Eye}
ONE = "title: T\nrobot: {drivers: {eye: {type: eye}}}\n"
TWO = "title: T\nrobot: {drivers: {eye: {type: eye}, other: {type: eye}}}\n"


def read(folder: Path, *actions: str, head: str = ONE) -> Experiment:
    path = folder / "experiment.yaml"
    path.write_text(panel(*actions, head=head), encoding="utf-8")
    return load(path, CATALOGUE_WITH_EYE)


@pytest.mark.parametrize(
    ("consent", "name", "warned"),
    [
        ("", "V3", True),
        ("face_consent: V3", "V3", False),
        ("face_consent: v3", "V3", False),
        ("face_consent: V4", "V3", True),
        ('face_consent: "{visitor}"', "V3", False),
        ("face_consent: V3", '"{visitor}"', False),
        ("face_consent: {name: V3, given: false}", "V3", True),
    ],
)
def test_a_face_that_nobody_can_consent_to_is_warned_of(
    tmp_path: Path, consent: str, name: str, warned: bool
) -> None:
    others = [f"{{key: c, label: C, {consent}}}"] if consent else []
    learns = f"{{key: l, label: L, learn_face: {name}}}"
    head = f"{ONE}engagement: {{}}\n"
    found = [one.message for one in read(tmp_path, learns, *others, head=head).warnings]
    assert [text for text in found if "consent" in text] == (found if warned else [])
    assert bool(found) is warned
    if warned:
        assert "steps: [{face_consent: 'V3'}, {learn_face: 'V3'}]" in found[0]


@pytest.mark.parametrize(
    ("handshake", "action", "warned"),
    [
        ("{by: robot}", "say: Hi", True),
        ("{by: wizard}", "say: Hi", False),
        ("{by: robot, face_consent: May I?}", "say: Hi", False),
        ("{by: robot}", 'face_consent: "{visitor}"', False),
    ],
)
def test_a_handshake_of_the_robot_learns_nobody_where_nobody_can_consent(
    tmp_path: Path, handshake: str, action: str, warned: bool
) -> None:
    head = f"{ONE}engagement: {{handshake: {handshake}}}\n"
    found = read(tmp_path, f"{{key: c, label: C, {action}}}", head=head).warnings
    assert [one.path for one in found] == (["engagement.handshake.by"] if warned else [])


def test_a_consent_and_its_withdrawal_reach_all_that_learn_faces(tmp_path: Path) -> None:
    experiment = read(
        tmp_path,
        "{key: c, label: C, face_consent: V3}",
        "{key: d, label: D, face_consent: {name: V3, given: false}}",
        "{key: e, label: E, face_consent: V3, on: other}",
        head=TWO,
    )
    reached = [[call.driver for call in one.calls] for one in experiment.panels[0].actions]
    assert reached == [["eye", "other"], ["eye", "other"], ["other"]]
