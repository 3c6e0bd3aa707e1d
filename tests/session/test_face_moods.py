"""A sound without an emotion of its own follows the robot's face, and the log says what it was."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.replay.rerun_rig import player_of, rerun_over
from tests.session.rig import (
    HERE,
    NoSettings,
    ScriptedDriver,
    SessionRig,
    action,
    call,
    experiment,
    together,
)
from woz_tui.config.experiment import Call, DriverSpec, Panel
from woz_tui.drivers.contract import Argument, DriverError, Job, Offer, Verb
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.gate.questions import RequestOrigin
from woz_tui.motion.emotions import FEELINGS, emotion_affect
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.protocol.welcome import StudySettings
from woz_tui.replay.rerun_plan import fitted, plan_of
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.redactor import Redactor

HAND = RequestOrigin("program", "", "con2")
UTTER = common_verb("utter", choices=FEELINGS)


class Feeling(ScriptedDriver):
    """Has a face and a voice; an emotion that is `sleepy` fails."""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        mood = (Argument("valence", "number"), Argument("arousal", "number"))
        face = (common_verb("emotion", choices=FEELINGS), Verb("affect", "", mood, lane="face"))
        return Offer(verbs=(*face, UTTER))

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, dict(job.args)))
        await asyncio.sleep(0.1)
        if job.args.get("emotion") == "sleepy":
            raise DriverError("it is wide awake")
        return dict(job.args)


def feeling(
    folder: Path,
    scenario: Callable[[SessionRig], Awaitable[None]],
    *drivers: str,
    identity: SessionIdentity | None = None,
) -> SessionRig:
    names = drivers or ("robot",)
    made = experiment(folder, names)
    both = action("Both", together(call("emotion", emotion="happy"), call("utter", seconds=0.5)))
    specs = [DriverSpec(one, "feeling", NoSettings(), Feeling.offer(None), HERE) for one in names]
    made = replace(
        made, drivers=tuple(specs), panels=(Panel("Feelings", (both,), HERE),), sections={}
    )
    rig = SessionRig(folder, identity=identity, catalogue={"feeling": Feeling}, made=made)
    return rig.run(scenario, 1)


async def send(rig: SessionRig, verb: str, on: str = "", **args: Json) -> dict[str, Json]:
    """Send it, and let it end; its arguments as they are in the log."""
    rig.session.send(verb, args, on, HAND)
    await asyncio.sleep(0.3)
    return rig.of(m.Command)[-1].args


def place(args: Mapping[str, Json]) -> tuple[Json, Json]:
    return args["valence"], args["arousal"]


def rounded(emotion: str, intensity: float = 1.0) -> tuple[float, float]:
    valence, arousal = emotion_affect(emotion, intensity)
    return round(valence, 3), round(arousal, 3)


@pytest.mark.toolkit("X5")
def test_it_follows_what_the_face_was_told_last(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        assert place(await send(rig, "utter")) == (0, 0)
        await send(rig, "emotion", emotion="sad", intensity=0.5)
        assert place(await send(rig, "utter")) == rounded("sad", 0.5)
        await send(rig, "affect", valence=0.2, arousal=-0.7)
        assert place(await send(rig, "utter")) == (0.2, -0.7)
        await send(rig, "emotion", emotion="sleepy")  # fails: the face is as it was
        assert place(await send(rig, "utter")) == (0.2, -0.7)

    feeling(tmp_path, scenario)


def test_what_is_asked_for_in_one_step_goes_together(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        rig.session.play("Both", HAND)
        await asyncio.sleep(0.5)

    rig = feeling(tmp_path, scenario)
    [heard] = [args for verb, args in rig.driver().calls if verb == "utter"]
    assert place(heard) == rounded("happy")


def test_what_moves_and_knobs_make_of_a_face_counts(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        show = rig.session.hub.publish
        show(m.FaceShown(driver="robot", width=1, rows="0", emotion="angry", intensity=0.4))
        assert place(await send(rig, "utter")) == rounded("angry", 0.4)
        knobs: dict[str, Json] = {
            "emotion": "happy",
            "intensity": 0.5,
            "valence": 0.4,
            "arousal": 0.3,
        }
        show(m.BodyChanged(driver="robot", values=knobs))
        show(m.FaceShown(driver="robot", width=1, rows="0", emotion="happy", intensity=0.5))
        assert place(await send(rig, "utter")) == (0.4, 0.3)
        show(m.BodyChanged(driver="robot", values={**knobs, "emotion": "amazed", "intensity": 1.0}))
        assert place(await send(rig, "utter")) == rounded("amazed")

    feeling(tmp_path, scenario)


def test_an_emotion_of_its_own_or_a_mood_in_numbers_is_kept(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        await send(rig, "emotion", emotion="sad")
        happy = await send(rig, "utter", emotion="happy", intensity=0.5, seed=3)
        assert (place(happy), happy["seed"]) == (rounded("happy", 0.5), 3)
        assert place(await send(rig, "utter", valence=0.1, arousal=0.9)) == (0.1, 0.9)

    feeling(tmp_path, scenario)


@pytest.mark.toolkit("X5")
def test_each_robot_sounds_like_its_own_face(tmp_path: Path) -> None:
    async def scenario(rig: SessionRig) -> None:
        await send(rig, "emotion", "ada.face", emotion="angry")
        await send(rig, "emotion", "bob.face", emotion="happy")
        assert place(await send(rig, "utter", "ada.voice")) == rounded("angry")
        assert place(await send(rig, "utter", "bob.voice")) == rounded("happy")

    feeling(tmp_path, scenario, "ada.face", "ada.voice", "bob.face", "bob.voice")


def test_seeds_come_from_that_of_the_session(tmp_path: Path) -> None:
    seeds: list[list[Json]] = []

    async def scenario(rig: SessionRig) -> None:
        seeds.append([(await send(rig, "utter"))["seed"] for _ in range(3)])

    for number, seed in enumerate((5, 5, 6)):
        identity = SessionIdentity(participant="P07", condition="warm", seed=seed)
        feeling(tmp_path / str(number), scenario, identity=identity)
    assert seeds[0] == seeds[1] != seeds[2]
    assert len({*map(str, seeds[0])}) == 3


@pytest.mark.toolkit("X5")
def test_a_re_run_sounds_the_same_whatever_the_face_looks_like(tmp_path: Path) -> None:
    async def recorded(rig: SessionRig) -> None:
        await send(rig, "emotion", emotion="happy")
        await send(rig, "utter")

    first = feeling(tmp_path / "a", recorded)
    plan = plan_of(first.recorder.path)
    alone = replace(plan, steps=tuple(one for one in plan.steps if one.command.verb == "utter"))

    async def again(rig: SessionRig) -> None:
        await send(rig, "emotion", emotion="angry")
        player = player_of(rig, fitted(alone, rig.experiment))
        player.begin()
        await rerun_over(rig, player)

    second = feeling(tmp_path / "b", again)
    heard = [
        [args for verb, args in rig.driver().calls if verb == "utter"] for rig in (first, second)
    ]
    assert heard[0] == heard[1]


@pytest.mark.parametrize("tells", [(), ("condition",)])
def test_a_face_that_tells_the_condition_is_not_read_from_the_sound(
    tmp_path: Path, tells: tuple[str, ...]
) -> None:
    async def scenario(rig: SessionRig) -> None:
        shown = Call("emotion", {"emotion": "sad"}, "robot", HERE, tells=tells)
        rig.session.runner.send(shown, HAND, "queue", None)
        await asyncio.sleep(0.3)
        await send(rig, "utter")

    rig = feeling(tmp_path, scenario)
    seen = Redactor(StudySettings(blind={"warm": "Lemon"})).message(rig.of(m.Command)[-1])
    assert isinstance(seen, m.Command)
    assert (place(seen.args) == rounded("sad")) is not bool(tells)
