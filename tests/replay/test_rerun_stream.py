"""In virtual time a re-run moves the simulated robot through every single setpoint once more."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

from woz_drivers.simulated import SimulatedRobot
from woz_drivers.simulated.driver import RobotTime

from tests.fakes.virtual_time import LoopClock, run_virtual
from tests.replay.rerun_rig import KEY, NOWHERE
from woz_tui.config.experiment import Call
from woz_tui.config.loading import load
from woz_tui.drivers.contract import Driver, DriverContext
from woz_tui.drivers.plugins import installed
from woz_tui.log.recorder import Recorder
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import REPLAY, plan_of
from woz_tui.replay.rerun_player import RerunPlayer
from woz_tui.session.action_runner import RequestOrigin
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.session.session import Session
from woz_tui.system.clock import RealClock

EXPERIMENT = """\
title: Body
robot: {name: it, drivers: {robot: {type: simulated, visitor: false}}}
panels:
  - title: Body
    actions:
      - {key: n, label: Nod, play: nod}
      - {key: l, label: Left, pose: {pan: 40, tilt: 10, seconds: 0.8}}
      - {key: r, label: Round, poses: [{pan: 50, seconds: 1}, {pan: -50, tilt: 5, seconds: 1.3}]}
      - {key: h, label: Home, home: 0.7}
"""


Setpoints = list[tuple[int, str, float | None]]


class LoopPace(RobotTime):
    """The robot's time is the loop's."""

    def now(self) -> float:
        return asyncio.get_running_loop().time()


class VirtualRobot(SimulatedRobot):
    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        super().__init__(name, settings, context, pace=LoopPace())


async def staged(
    folder: Path, play: Callable[[Session], Awaitable[None]]
) -> tuple[Path, Setpoints]:
    """A session on the simulated robot; its log and the robot's setpoints."""
    catalogue = installed()
    recorder = Recorder(folder / "recordings", "made", RealClock())
    clock = LoopClock(asyncio.get_running_loop())
    robots: dict[str, type[Driver]] = {"simulated": VirtualRobot}
    session = Session(
        load(folder / "body.yaml", catalogue), robots, SessionIdentity(), recorder, clock
    )
    heard: Setpoints = []
    session.hub.listen(
        lambda message: (
            heard.append((message.t, message.sensor, message.value))
            if isinstance(message, m.Reading) and message.sensor.startswith("setpoint.")
            else None
        )
    )
    await session.open()
    await play(session)
    await session.close("test", rest=False)
    return recorder.path, heard


async def moves(session: Session) -> None:
    """Moves that follow each other, one that takes another one's place, and a stream of gazes."""
    await asyncio.sleep(1)
    for name, pause in (("Nod", 0.5), ("Left", 2.0), ("Round", 1.6)):
        session.play(name, KEY)
        await asyncio.sleep(pause)
    session.play("Home", KEY, "replace")
    await asyncio.sleep(1.2)
    for step in range(30):
        args: dict[str, m.Json] = {"yaw": step * 1.5, "pitch": -step / 2}
        session.runner.send(Call("gaze", args, "robot", NOWHERE), KEY)
        await asyncio.sleep(0.04)
    await asyncio.sleep(2)


def rerun(log: Path) -> Callable[[Session], Awaitable[None]]:
    async def play(session: Session) -> None:
        ended = asyncio.Event()

        def send(command: m.Command, on_end: Callable[[m.End], None]) -> m.Command:
            call = Call(command.verb, dict(command.args), command.driver, NOWHERE)
            return session.runner.send(
                call, RequestOrigin(REPLAY), "queue", None, on_end, like=command
            )

        player = RerunPlayer(
            plan_of(log), session.hub, send, session.runner.cancel, lambda end: ended.set()
        )
        player.begin()
        await ended.wait()
        await asyncio.sleep(2)

    return play


def course(setpoints: Setpoints) -> list[tuple[str, float | None]]:
    """Every setpoint of each joint that is another one than before, in order."""
    last: dict[str, float | None] = {}
    found = []
    for _, joint, value in setpoints:
        if last.get(joint) != value:
            last[joint] = value
            found.append((joint, value))
    return found


def session_in(folder: Path, play: Callable[[Session], Awaitable[None]]) -> tuple[Path, Setpoints]:
    """One session, from its beginning to its end."""
    folder.mkdir()
    (folder / "body.yaml").write_text(EXPERIMENT, encoding="utf-8")
    return run_virtual(staged(folder, play))


def test_every_setpoint_comes_again_twice(tmp_path: Path) -> None:
    log, first = session_in(tmp_path / "a", moves)
    _, second = session_in(tmp_path / "b", rerun(log))
    _, third = session_in(tmp_path / "c", rerun(log))
    assert len(course(first)) > 90
    assert course(second) == course(third)
    assert course(second) == course(first)
