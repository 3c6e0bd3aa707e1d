"""Many faults in a row with commands under way: each command ends once, nothing hangs or stays."""

from __future__ import annotations

import asyncio
import random
from pathlib import Path
from typing import Any

import pytest
from naoqi_simulator.robot_time import PacedTime
from robot_simulators.furhat import FurhatSimulator
from woz_drivers.furhat.settings import FurhatListeningSettings, FurhatSensesSettings
from woz_drivers.lines import web_socket_line

from tests.drivers.furhat.furhat_rig import FurhatRig, connected_furhat
from woz_tui.drivers.contract import DriverError, Health
from woz_tui.testing import until

FAULTS = 25
COMMANDS: tuple[tuple[str, dict[str, Any]], ...] = (
    ("say", {"text": "What I have to say takes a while"}),
    ("play", {"move": "Nod"}),
    ("play", {"move": "dance", "speed": 4.0}),
    ("emotion", {"emotion": "happy"}),
    ("gaze", {"yaw": 20.0, "pitch": 5.0}),
    ("follow", {"user": "closest"}),
    ("eyes", {"color": "red", "animation": "intermittent"}),
    ("voice", {"name": "Amy"}),
    ("picture", {}),
    ("listen", {"on": True}),
)
#: One at a time in each lane, as the bus does it.
LANES = {"play": "body", "emotion": "face", "gaze": "head", "follow": "head"}
NONSENSE = ("nonsense", "{}", '{"type": "response.users.data", "users": [{}]}', "[]", "17")


class Troubles:
    """Commands and faults by the dice."""

    def __init__(self, rig: FurhatRig, seed: int) -> None:
        self.rig = rig
        self.dice = random.Random(seed)
        self.ended: list[str] = []
        self._lanes: dict[str, asyncio.Task[None]] = {}

    def command(self) -> None:
        """Give a command if its lane is free."""
        verb, args = self.dice.choice(COMMANDS)
        lane = LANES.get(verb, verb)
        if lane not in self._lanes or self._lanes[lane].done():
            self._lanes[lane] = asyncio.create_task(self._performed(verb, dict(args)))

    async def _performed(self, verb: str, args: dict[str, Any]) -> None:
        try:
            await self.rig.begin(verb, **args)
        except DriverError as error:
            self.ended.append(error.what)
        else:
            self.ended.append("")

    async def fault(self) -> None:
        """Something goes wrong for a moment."""
        robot = self.rig.robot
        pause = self.dice.uniform(0.0, 0.05)
        match self.dice.choice(("drop", "freeze", "away", "nonsense", "refuse", "silence", "stop")):
            case "drop":
                robot.drop()
            case "freeze":
                robot.freeze()
                await asyncio.sleep(self.dice.choice((pause, 0.5)))
                robot.thaw()
            case "away":
                await robot.close()
                await asyncio.sleep(pause)
                await robot.start()
            case "nonsense":
                await robot.send_raw(self.dice.choice(NONSENSE))
            case "refuse":
                robot.faults.refused["request.speak.text"] = "not now"
                await asyncio.sleep(pause)
                robot.faults.refused.clear()
            case "silence":
                robot.ignored |= {"request.gesture.start", "request.voice.config"}
                await asyncio.sleep(pause)
                robot.ignored.clear()
            case "stop":
                await robot.send_raw('{"type": "response.speak.end", "aborted": true}')

    async def over(self) -> None:
        """Return when all commands have ended."""
        async with asyncio.timeout(20):
            await asyncio.gather(*self._lanes.values())


async def answers(rig: FurhatRig) -> None:
    """Return when the robot carries out what it is asked for: the last fault is over."""
    async with asyncio.timeout(20):
        while True:
            await until(lambda: rig.healthy is Health.CONNECTED, 20)
            try:
                await rig.do("voice", name="Matthew")
                return
            except DriverError:
                await asyncio.sleep(0.02)


@pytest.mark.usefixtures("unhurried_stop")
@pytest.mark.parametrize("seed", [1, 2])
async def test_many_faults_in_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    monkeypatch.setattr(web_socket_line, "_PING_S", 0.05)
    monkeypatch.setattr(web_socket_line, "_SILENCE_S", 0.3)
    before = len(asyncio.all_tasks())
    robot = FurhatSimulator(PacedTime(50))
    sensing = {"senses": FurhatSensesSettings(), "listening": FurhatListeningSettings()}
    async with connected_furhat(tmp_path, robot, **sensing) as rig:
        troubles = Troubles(rig, seed)
        for _ in range(FAULTS):
            troubles.command()
            await asyncio.sleep(troubles.dice.uniform(0.0, 0.03))
            await troubles.fault()
        await troubles.over()
        assert "" in troubles.ended and len(set(troubles.ended)) > 1, "the faults had no effect"
        await answers(rig)
        assert not (await rig.stop()).missing
        assert (robot.speaking, robot.gesturing) == ("", [])
        assert (await rig.do("say", text="All is well"))["text"] == "All is well"
    async with asyncio.timeout(10):
        while len(asyncio.all_tasks()) > before:  # noqa: ASYNC110
            await asyncio.sleep(0.01)
