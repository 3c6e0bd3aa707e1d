"""A robot on the wire that has every service and answers with whatever a test says."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from qimessaging import HostedMethod, QiServer
from woz_drivers.naoqi_robot.connection import RobotConnection
from woz_drivers.pepper.model import PEPPER
from woz_drivers.pepper.settings import PepperSettings

from tests.drivers.pepper.robot_rig import settings_for
from tests.drivers.published_messages import PublishedMessages
from woz_tui.protocol.messages import DriverConnected

SETTINGS = PepperSettings(robots=())
#: Signatures of the methods that are asked, by service.
_ASKED = {
    "ALMotion": (
        *(("stopMove", "()"), ("killAll", "()"), ("getRobotVelocity", "()")),
        *(("getStiffnesses", "([s])"), ("getAngles", "([s]b)"), ("robotIsWakeUp", "()")),
        *(("moveIsActive", "()"), ("killTasksUsingResources", "([s])")),
        *(("moveTo", "(fff)"), ("setAngles", "([s][f]f)"), ("getBreathEnabled", "(s)")),
        *(("getTangentialSecurityDistance", "()"), ("getOrthogonalSecurityDistance", "()")),
    ),
    "ALTextToSpeech": (("stopAll", "()"), ("getVolume", "()"), ("getParameter", "(s)")),
    "ALAudioPlayer": (
        *(("stopAll", "()"), ("loadFile", "(s)"), ("getFileLength", "(i)"), ("play", "(i)")),
        *(("setVolume", "(if)"), ("getLoadedFilesIds", "()")),
    ),
    "ALLeds": (("getIntensity", "(s)"),),
    "ALAutonomousLife": (("getState", "()"),),
    "ALBasicAwareness": (("isEnabled", "()"), ("getEngagementMode", "()")),
    "ALRobotPosture": (("getPosture", "()"), ("getPostureFamily", "()"), ("stopMove", "()")),
    "ALMemory": (("getData", "(s)"), ("getListData", "([s])"), ("insertData", "(sm)")),
    "ALBehaviorManager": (("stopBehavior", "(s)"), ("isBehaviorRunning", "(s)")),
    "ALAnimationPlayer": (("run", "(s)"),),
}


@dataclass
class ScriptedRobot:
    """`says` by method, such as `ALMotion.getAngles`; nothing for what is not in it."""

    connection: RobotConnection
    published: PublishedMessages
    says: dict[str, Any] = field(default_factory=dict)
    #: What it was called with, by method.
    called: dict[str, list[tuple[Any, ...]]] = field(default_factory=dict)


@asynccontextmanager
async def babbler(folder: Path, kind: str = "pepper") -> AsyncIterator[ScriptedRobot]:
    """Such a robot, and a connection to it."""
    says: dict[str, Any] = {}
    called: dict[str, list[tuple[Any, ...]]] = {}

    def method(name: str, takes: str) -> HostedMethod:
        def answer(*args: Any) -> Any:
            called.setdefault(name, []).append(args)
            said = says.get(name)
            if isinstance(said, Exception):
                raise said
            return said

        return HostedMethod(name.partition(".")[2], takes, "m", answer)

    async def connected() -> None:
        """Nothing is set."""

    server = QiServer()
    for service in sorted(PEPPER.services | _ASKED.keys()):
        asked = _ASKED.get(service, ())
        server.add(service, methods=[method(f"{service}.{one}", takes) for one, takes in asked])
    end = await server.listen("127.0.0.1")
    published = PublishedMessages(folder)
    naoqi_settings = settings_for(kind, f"127.0.0.1:{end.port}")
    connection = RobotConnection(
        naoqi_settings, published.context, on_connected=connected, on_lost=lambda: None
    )
    connection.start()
    try:
        await published.first(DriverConnected)
        yield ScriptedRobot(connection, published, says, called)
    finally:
        await connection.close()
        await server.close()
