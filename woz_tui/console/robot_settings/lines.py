"""The lines of a robot's settings: its own settings, its connection, the arrow keys."""

from __future__ import annotations

import enum
from collections.abc import Collection
from dataclasses import dataclass

from woz_tui.config.screen_language import say
from woz_tui.console.robot_settings.step_sizes import steps_offered
from woz_tui.protocol.robot_outline import RobotOutline, Setting
from woz_tui.protocol.sentence import Sentence

CONNECTION = Sentence("settings.connection", "Connection")
#: Where NAOqi listens, plain and secured; drivers leave them out where they name a robot.
_USUAL_PORTS = ("9559", "9503")


class LineKind(enum.Enum):
    """What a line is about."""

    SETTING = "setting"
    ROBOT = "robot"
    ADDRESS = "address"
    DISCONNECT = "disconnect"
    STEP = "step"


#: How ids of lines of the connection begin.
CONNECTING = tuple(kind.value for kind in (LineKind.ROBOT, LineKind.ADDRESS, LineKind.DISCONNECT))


@dataclass(frozen=True, slots=True)
class SettingLine:
    """One line. `setting` says how it is called and what may be set, whatever it is about."""

    kind: LineKind
    setting: Setting

    @property
    def id(self) -> str:
        """Its name among the lines of its robot."""
        return f"{self.kind.value} {self.setting.name}"

    @property
    def is_set(self) -> bool:
        """Whether it has a value that can be changed, here or at the robot. Which robot it is has
        none: an arrow key too many would let go of it in mid-session.
        """
        by_hand = self.setting.verb not in ("", "connect")
        return self.kind is LineKind.STEP or (self.kind is LineKind.SETTING and by_hand)

    @property
    def is_typed(self) -> bool:
        """Whether enter opens a field for it."""
        kinds = ("number", "color", "text")
        return self.kind is LineKind.ADDRESS or (self.is_set and self.setting.kind in kinds)


def lines_of(outline: RobotOutline, verbs: Collection[str]) -> list[SettingLine]:
    """All lines of a robot that offers `verbs`, section after section."""
    sections: dict[str, list[SettingLine]] = {}
    for setting in outline.settings:
        sections.setdefault(setting.section, []).append(SettingLine(LineKind.SETTING, setting))
    found = [line for lines in sections.values() for line in lines]
    if "connect" in verbs:
        found += [
            SettingLine(LineKind.ROBOT, _link(name, name, "connect", "robot"))
            for name in dict.fromkeys(outline.robots)
        ]
        addresses = say(
            "settings.addresses", "a host name, tcp://HOST:PORT or tcps://USER@HOST:PORT"
        )
        another = say("settings.another_address", "Another address")
        other = _link("", another, "connect", "robot", hint=addresses)
        found.append(SettingLine(LineKind.ADDRESS, other))
    if "disconnect" in verbs:
        lets_go = _link("", say("settings.disconnect", "Disconnect"), "disconnect")
        found.append(SettingLine(LineKind.DISCONNECT, lets_go))
    return found + [SettingLine(LineKind.STEP, setting) for setting in steps_offered(verbs)]


def _link(name: str, label: str, verb: str, argument: str = "", hint: str = "") -> Setting:
    return Setting(
        name=name, section=CONNECTION, label=label, verb=verb, argument=argument, help=hint
    )


def bare_address(address: str) -> str:
    """Where an address leads to, without scheme, user and one of NAOqi's usual ports:
    `tcps://nao@10.0.0.7:9503` -> `10.0.0.7`, `127.0.0.1:9561` as it is. Two robots behind one host
    differ by their ports.
    """
    bare = address.strip().rpartition("://")[2].rpartition("@")[2].removesuffix("/").casefold()
    host, colon, port = bare.rpartition(":")
    usual = colon and port in _USUAL_PORTS and (":" not in host or host.endswith("]"))
    return host if usual else bare
