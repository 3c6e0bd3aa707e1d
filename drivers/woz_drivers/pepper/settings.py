"""The settings of a Pepper in a robot file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from woz_drivers.naoqi_robot.model import RobotModel
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.pepper.model import PEPPER
from woz_tui.drivers.fields import Doc, OneOf, Range, Section

#: What a file may name as its client from the time when there were two.
CLIENTS = ("auto", "qi", "own")


@dataclass(frozen=True, slots=True)
class TabletSettings:
    """The tablet at its chest."""

    root: Annotated[str, Doc("folder of its files, relative to the experiment file")] = ""
    default: Annotated[str, Doc("shown on connect and when nothing else is")] = ""
    address: Annotated[
        str, Doc("this machine's address as the robot reaches it; empty: found out")
    ] = ""
    port: Annotated[int, Range(0, 65535), Doc("where pictures are served; 0: any")] = 0


@dataclass(frozen=True)
class _Robots(Section):
    """What stands before the settings of all robots with NAOqi."""

    robots: Annotated[
        tuple[str, ...],
        Doc(
            "addresses of robots; the first one is used at the start: a host name, tcp://HOST:9559,"
            " tcps://USER@HOST:9503, or simulated"
        ),
    ]
    client: Annotated[str, OneOf(CLIENTS), Doc("without effect: there is one client")] = "auto"


@dataclass(frozen=True)
class PepperSettings(NaoqiSettings, _Robots):
    """One Pepper, or several of which one is played at a time."""

    model: ClassVar[RobotModel] = PEPPER
    serving_section: ClassVar[str] = "tablet"

    password: Annotated[
        str, Doc("name of the environment variable that holds the password for tcps")
    ] = "WOZ_PEPPER_PASSWORD"
    tablet: Annotated[TabletSettings, Doc("its tablet")] = field(default_factory=TabletSettings)

    @property
    def addresses(self) -> Mapping[str, str]:
        """See `NaoqiSettings.addresses`."""
        return {f"robots[{index}]": robot for index, robot in enumerate(self.robots)}

    @property
    def serving(self) -> TabletSettings:
        """The tablet fetches them, and the player of sounds."""
        return self.tablet

    def warnings(self) -> list[tuple[str, str]]:
        """What is not as it is written, by the setting's path."""
        if self.client != "qi":
            return []
        return [("client", "the package qi is not used: woz-tui's own client is; remove this line")]
