"""A WoZ4U file played: what a Pepper at the other end of the wire is asked to do."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from tests.config.woz4u.reading import CATALOGUE, read_experiment
from tests.drivers.pepper.connection_rig import patience
from tests.fakes.naoqi import StandIn, stand_in
from tests.session.rig import SessionRig
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.participant_identity import SessionIdentity

KEY = RequestOrigin("key", "h", "con1")

TEXT = r"""
autonomous_life_config: {autonomous_state: solitary, tangential_collision: 0.07, blinking: False,
  basic_awareness: "", listening_movement: True, arms_breathing: "false"}
volume: 0.4
voice_speed: 80
voice_pitch: 1.3
animated_speech:
  - {title: Greeting, string: "It&apos;s me {you} ^run(animations/Stand/Gestures/Hey_1) \\pau=200\\ Grüße & #1",
     key_comb: [ctrl, 3]}
  - {title: Tale, string: tale.txt}
gestures: [{title: Nod, gesture: animations/Stand/Gestures/Yes_1}]
audio_files: [{title: Gong, location: /home/nao/sounds/gong.wav}]
tablet_items: [{title: Page, file_name: "http://a.example/page"}]
colors:
  - {title: Dark, red: 0, green: 0, blue: 0}
  - {title: Green, red: 0, green: 1, blue: 0.2, is_default: True}
rasta_anim: {duration: 2}
random_anim: {duration: 3}
rotate_anim: {duration: 1}
lock_gesture_section: "true"
lock_movement_control_section: "true"
"""  # noqa: E501


class PepperSession(SessionRig):
    """A session with the file, and the robot."""

    def __init__(self, robot: StandIn, folder: Path) -> None:
        made = read_experiment(folder, TEXT, start=f'pepper_ips: ["{robot.address}"]\n')
        super().__init__(folder, identity=SessionIdentity(), catalogue=CATALOGUE, made=made)
        self.robot = robot

    async def play(self, name: str) -> None:
        """Play an action to its end."""
        run = self.session.play(name, KEY)
        await self.until(
            lambda: self.of(m.Failed) or run in [each.run for each in self.of(m.ActionDone)]
        )
        assert self.of(m.Failed) == []

    async def call_arguments(self, *names: str) -> list[list[Any]]:
        """Arguments of all calls of these methods."""
        return [call.args for call in await self.robot.trace(*names)]


@asynccontextmanager
async def on_the_wire(folder: Path) -> AsyncIterator[PepperSession]:
    with patience():
        async with stand_in(pace=50.0) as robot, PepperSession(robot, folder) as rig:
            rig.session.bus.unwatched = ""
            # Told when all that the file wants has been set.
            await rig.until(lambda: rig.of(m.DriverConnected))
            yield rig


@pytest.mark.woz4u("pepper_ips", "autonomous_life_config", "volume", "is_default", "colors")
async def test_what_is_set_on_connect_and_what_the_buttons_do(tmp_path: Path) -> None:
    (tmp_path / "tale.txt").write_text("One.\n\nTwo.\n", encoding="utf-8")
    async with on_the_wire(tmp_path) as session:
        assert await session.call_arguments("ALAutonomousBlinking.setEnabled") == [[False]]
        assert await session.call_arguments("ALListeningMovement.setEnabled") == [[True]]
        assert await session.call_arguments("ALBasicAwareness.setEnabled") == []
        assert await session.call_arguments("ALMotion.setTangentialSecurityDistance") == [
            [pytest.approx(0.07)]
        ]
        assert await session.call_arguments("ALMotion.setBreathEnabled") == [["Arms", False]]
        assert await session.call_arguments("ALTextToSpeech.setVolume") == [[pytest.approx(0.4)]]
        parameters = await session.call_arguments("ALTextToSpeech.setParameter")
        assert ["speed", 80.0] in parameters
        assert any(
            name == "pitchShift" and value == pytest.approx(1.3) for name, value in parameters
        )
        colour = (await session.call_arguments("ALLeds.fadeRGB"))[-1]
        assert colour == ["FaceLeds", 0.0, 1.0, pytest.approx(0.2), 0.5]
        assert await session.call_arguments("ALTabletService.hideWebview") == [[]], (
            "there is no default picture"
        )

        await session.play("Greeting")
        await session.play("Tale")
        greeting = "It's me {you} ^run(animations/Stand/Gestures/Hey_1) \\pau=200\\ Grüße & #1"
        said = [args[0] for args in await session.call_arguments("ALAnimatedSpeech.say")]
        assert said[0].strip() == greeting
        assert [text.strip() for text in said[1:]] == ["One.", "Two."]

        for name in ("Rasta", "Random", "Rotate Green", "Page"):
            await session.play(name)
        # The driver asks for them piece by piece, so that they can be cut short.
        assert sum(
            [args[-1] for args in await session.call_arguments("ALLeds.rasta")]
        ) == pytest.approx(2)
        assert sum(
            [args[-1] for args in await session.call_arguments("ALLeds.randomEyes")]
        ) == pytest.approx(3)
        turned = await session.call_arguments("ALLeds.rotateEyes")
        assert {args[0] for args in turned} == {0x00FF33}
        assert sum(args[-1] for args in turned) == pytest.approx(1)
        assert await session.call_arguments("ALTabletService.showWebview") == [
            ["http://a.example/page"]
        ]


@pytest.mark.woz4u("lock_gesture_section", "lock_movement_control_section")
async def test_locked_sections_ask_the_robot_for_nothing(tmp_path: Path) -> None:
    async with on_the_wire(tmp_path) as pepper_session:
        session = pepper_session.session
        with pytest.raises(RequestError, match="locked"):
            session.play("Nod", KEY)
        with pytest.raises(RequestError, match="'Gestures' is locked, and with it 'play'"):
            session.send("play", {"move": "Hey_1"}, "", KEY)
        for verb, args in (("nudge", {"yaw": 5.0}), ("drive", {"x": 0.1}), ("hip", {"pitch": 2.0})):
            with pytest.raises(RequestError, match=f"'Movement' is locked, and with it '{verb}'"):
                session.send(verb, args, "", KEY)
        await pepper_session.play("Green")  # so whatever was sent before has arrived
        assert await pepper_session.call_arguments("ALAnimationPlayer.run", "ALMotion.moveTo") == []
        assert (
            await pepper_session.call_arguments("ALMotion.setAngles", "ALMotion.angleInterpolation")
            == []
        )
