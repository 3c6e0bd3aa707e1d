"""The study that has sounds rated: a condition is an emotion, and the wizard is not told which."""

from __future__ import annotations

import asyncio
import csv
from collections import Counter
from pathlib import Path

import pytest

from tests.features.questionnaires.rig import questionnaires
from tests.session.rig import SessionRig
from tests.session.study_rig import trial_control
from tools.demo_session import catalogue
from woz_tui.cli import main
from woz_tui.config.loading import load
from woz_tui.drivers.plugins import installed
from woz_tui.features.questionnaires.kinds import AskAnswer
from woz_tui.features.questionnaires.section import QUESTIONNAIRES
from woz_tui.gate.questions import RequestOrigin
from woz_tui.motion.emotions import DIRECTIONS, emotion_affect
from woz_tui.protocol import messages as m
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.redactor import Redactor
from woz_tui.session.session_plan import study_settings

STUDY = Path(__file__).parents[2] / "experiments/sound-ratings.yaml"
KEY = RequestOrigin("key", "n", "con1")


def simulated(folder: Path) -> Path:
    """The study with a robot that makes no sound."""
    file = folder / "ratings.yaml"
    before, _, rest = STUDY.read_text("utf-8").partition("robot: ")
    after = rest.partition("voice: {type: speech}")[2]
    file.write_text(f"{before}robot: simulated{after}", encoding="utf-8")
    return file


@pytest.mark.parametrize("emotion", DIRECTIONS)
def test_each_condition_sounds_like_its_emotion_to_a_wizard_who_is_not_told(
    tmp_path: Path, emotion: str
) -> None:
    made = load(simulated(tmp_path), installed())

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


#: An imagined participant, who knows notes and hears anger in all gibberish.
DIRECTIONS_IN_ORDER = [*DIRECTIONS]
HEARD = {emotion: number for number, emotion in enumerate(DIRECTIONS, 1)}


def test_it_is_played_to_its_end_and_gives_the_table_of_what_was_heard(tmp_path: Path) -> None:
    made = load(simulated(tmp_path), installed())
    choices = QUESTIONNAIRES.of(made).questionnaires[0].items[2].choices
    assert [choice.text for choice in choices][:6] == [*DIRECTIONS]

    async def over(rig: SessionRig, count: int) -> None:
        await rig.until(lambda: len(rig.of(m.ActionDone)) >= count)

    async def scenario(rig: SessionRig) -> None:
        study, asked = trial_control(rig.session), questionnaires(rig)
        study.assign("P03", [*DIRECTIONS])
        for number in range(2 * len(DIRECTIONS)):
            study.trial("begin", "")
            rig.session.play("Gibberish" if number % 2 else "Notes", KEY)
            await over(rig, number + 1)
            study.trial("done", "")
            asked.begin_or_end("sound", "begin", "wizard")
            condition = DIRECTIONS_IN_ORDER[number // 2]
            valence, arousal = emotion_affect(condition, 1.0)
            heard = HEARD["angry"] if number % 2 else HEARD[condition]
            for item, value in (
                ("valence", round(5 + 4 * valence)),
                ("arousal", round(5 + 4 * arousal)),
                ("emotion", heard),
            ):
                asked.answer(AskAnswer(questionnaire="sound", item=item, value=float(value)))
            asked.begin_or_end("sound", "done", "wizard")
        await asyncio.sleep(1)

    identity = SessionIdentity(participant="P03", seed=3)
    rig = SessionRig(tmp_path, identity=identity, catalogue=catalogue(), made=made)
    rig.run(scenario)
    log = tmp_path / "recordings" / "made.jsonl"
    assert main(["report", str(log), "--csv", str(tmp_path / "ratings")]) == 0
    with (tmp_path / "ratings" / "questionnaires_wide.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["trial"]) for row in rows] == [*range(1, 13)]
    assert all(int(row["sound.emotion"]) == HEARD[row["condition"]] for row in rows[::2])
    table = Counter((row["condition"], int(row["sound.emotion"])) for row in rows)
    assert table == Counter(
        pair
        for emotion in DIRECTIONS
        for pair in ((emotion, HEARD[emotion]), (emotion, HEARD["angry"]))
    )
    excited = {row["condition"]: int(row["sound.arousal"]) for row in rows}
    assert sorted(excited, key=lambda name: excited[name])[0] == "sleepy"
