"""The study that has sounds rated: a condition is an emotion, and the wizard is not told which."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from tests.session.rig import SessionRig
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.gate.questions import RequestOrigin
from woz_tui.motion.emotions import DIRECTIONS, emotion_affect
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.redactor import Redactor
from woz_tui.session.session_plan import study_settings

STUDY = Path(__file__).parents[2] / "experiments/sound-ratings.yaml"
KEY = RequestOrigin("key", "n", "con1")


@pytest.mark.parametrize("emotion", DIRECTIONS)
def test_each_condition_sounds_like_its_emotion_to_a_wizard_who_is_not_told(
    tmp_path: Path, emotion: str
) -> None:
    file = tmp_path / "ratings.yaml"
    before, _, rest = STUDY.read_text("utf-8").partition("robot: ")
    after = rest.partition("voice: {type: speech}")[2]
    file.write_text(f"{before}robot: simulated{after}", encoding="utf-8")
    made = load(file, installed())

    async def scenario(rig: SessionRig) -> None:
        await asyncio.sleep(0.1)
        for name in ("Notes", "Gibberish"):
            rig.session.play(name, KEY)

    identity = SessionIdentity(participant="P07", condition=emotion, seed=3)
    rig = SessionRig(tmp_path, identity=identity, catalogue=installed(), made=made)
    commands = rig.run(scenario).of(m.Command)
    assert [command.args["voice"] for command in commands[1:]] == ["gibberish"]
    blind = Redactor(study_settings(made))
    for command in commands:
        assert command.args["emotion"] == emotion
        valence, arousal = (round(value, 3) for value in emotion_affect(emotion, 1.0))
        assert (command.args["valence"], command.args["arousal"]) == (valence, arousal)
        assert command.args["seed"] == 1  # all participants hear the same
        seen = blind.message(command)
        assert isinstance(seen, m.Command)
        assert seen.args["emotion"] != emotion
        assert seen.args["valence"] == seen.args["arousal"] == "{mood}"
