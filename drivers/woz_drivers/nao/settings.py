"""The settings of a NAO in a robot file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, ClassVar

from woz_drivers.nao.model import CAMERAS, NAO
from woz_drivers.naoqi_robot.address import parse
from woz_drivers.naoqi_robot.model import RobotModel
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.fields import Doc, OneOf, Range, Section
from woz_tui.drivers.robot_settings import problem_at


@dataclass(frozen=True, slots=True)
class FilesSettings:
    """Where the robot fetches sound files of this machine from."""

    address: Annotated[
        str, Doc("this machine's address as the robot reaches it; empty: found out")
    ] = ""
    port: Annotated[int, Range(0, 65535), Doc("where sounds are served; 0: any")] = 0


@dataclass(frozen=True)
class _Address(Section):
    """What stands before the settings of all robots with NAOqi."""

    address: Annotated[
        str, Doc("simulated, a host name, tcp://HOST:9559, or tcps://USER@HOST:9503")
    ] = "simulated"


@dataclass(frozen=True)
class NaoSettings(NaoqiSettings, _Address):
    """One NAO."""

    model: ClassVar[RobotModel] = NAO
    serving_section: ClassVar[str] = "files"

    password: Annotated[
        str, Doc("name of the environment variable that holds the password for tcps")
    ] = "WOZ_NAO_PASSWORD"
    camera: Annotated[str, OneOf(CAMERAS), Doc("which camera is looked through")] = CAMERAS[0]
    files: Annotated[FilesSettings, Doc("sound files of this machine")] = field(
        default_factory=FilesSettings
    )

    def problems(self) -> list[tuple[str, str]]:
        """See `NaoqiSettings.problems`; this robot has one address, which has to be one."""
        found = super().problems()
        if self.address and not any(path == "address" for path, _ in found):
            with problem_at("address", found):
                parse(self.address)
        return found

    @property
    def addresses(self) -> Mapping[str, str]:
        """See `NaoqiSettings.addresses`."""
        return {"address": self.address} if self.address else {}

    @property
    def serving(self) -> FilesSettings:
        """The player of sounds fetches them."""
        return self.files
