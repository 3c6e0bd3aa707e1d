"""Where a Furhat looks: at a place, at somebody, or at nobody.

The robot has no joints in its API: it is told places in metres, and turns eyes and neck to them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from woz_drivers.furhat.link import Exchange, FurhatLink, FurhatPart
from woz_drivers.furhat.realtime_events import AttendStatus, Place
from woz_drivers.furhat.settings import SETTINGS, FurhatSettings
from woz_tui.drivers.argument_values import number, text
from woz_tui.drivers.contract import DriverContext, Job, Offer, Scope, Verb
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_parts import Pending
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

#: How far it turns its gaze: in degrees to a side, and up or down.
YAW, PITCH = Range(-75, 75, "degrees"), Range(-45, 45, "degrees")
#: How far away a place lies that is given as a direction, in metres.
_FAR_M = 1.5
LANE = "head"


def within(yaw: float, pitch: float) -> tuple[float, float]:
    """The direction, in degrees, as far as it can turn."""
    yaw = min(max(yaw, YAW.low or 0.0), YAW.high or 0.0)
    return yaw, min(max(pitch, PITCH.low or 0.0), PITCH.high or 0.0)


class FurhatHead(FurhatPart):
    """`gaze`, `nudge`, `follow`; the place that a gesture of ours looks at."""

    name = "gaze"
    SETTINGS = (SETTINGS["attends"], SETTINGS["seen"])

    def __init__(self, link: FurhatLink, settings: FurhatSettings, context: DriverContext) -> None:
        super().__init__(link, settings, context)
        self._yaw = self._pitch = 0.0
        #: Whom it looks at; empty: at a place.
        self._followed = ""
        #: What the robot was asked for last: user, location or nobody.
        self._asked = ""
        self._status = "nobody"
        self._seen: Mapping[str, Place] = {}
        self._turn: Exchange[AttendStatus] | None = None
        link.on(AttendStatus, self._attended)

    @classmethod
    def offer(cls, settings: FurhatSettings) -> Offer:
        """Directions in degrees, and people."""
        return Offer(
            verbs=(
                common_verb("gaze"),
                common_verb("nudge"),
                Verb(
                    "follow",
                    "look at somebody wherever they go",
                    (SETTINGS["attends"].taken(default="closest"),),
                    lane=LANE,
                    limit_s=5.0,
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Send it; the robot tells when it attends, not when its neck has turned."""
        match job.verb:
            case "gaze":
                yaw = number(job.args, "yaw", self._yaw)
                return await self._look(yaw, number(job.args, "pitch", self._pitch))
            case "nudge":
                yaw, pitch = self.direction()
                return await self._look(
                    yaw + number(job.args, "yaw"), pitch + number(job.args, "pitch")
                )
            case "follow":
                return await self._follow(text(job.args, "user").strip() or "closest")
        return await super().perform(job)

    async def _look(self, yaw: float, pitch: float) -> dict[str, Json]:
        yaw, pitch = await self.look(yaw, pitch)
        return {"yaw": round(yaw, 2), "pitch": round(pitch, 2)}

    async def _follow(self, user: str) -> dict[str, Json]:
        self._followed = user
        if user == "nobody":
            await self._attend("nobody")
        else:
            await self._attend("user", user_id=user)
        return {"user": user}

    async def look(self, yaw: float, pitch: float) -> tuple[float, float]:
        """Look in a direction, within what it can; returns that."""
        yaw, pitch = within(yaw, pitch)
        place = place_of(yaw, pitch, mirrored=self._settings.attention.mirrored)
        self._yaw, self._pitch, self._followed = yaw, pitch, ""
        await self._attend("location", x=place.x, y=place.y, z=place.z)
        return yaw, pitch

    def direction(self) -> tuple[float, float]:
        """Where it looks, in degrees: of somebody whom it follows, where they were seen last."""
        seen = self._seen.get(self._status) if self._followed else None
        if seen is None:
            return self._yaw, self._pitch
        return direction_of(seen, mirrored=self._settings.attention.mirrored)

    @property
    def turned_to(self) -> tuple[str, float, float]:
        """Whom it follows (empty: nobody), and the direction in which it looks else, in degrees."""
        return self._followed, self._yaw, self._pitch

    async def turn_back(self, to: tuple[str, float, float]) -> None:
        """Look again as it did when `turned_to` was `to`."""
        followed, yaw, pitch = to
        if followed:
            await self._follow(followed)
        else:
            await self.look(yaw, pitch)

    def want(self, to: tuple[str, float, float]) -> None:
        """Have a robot that is lost look as it did when `turned_to` was `to`, once it is back."""
        self._followed, self._yaw, self._pitch = to

    def sees(self, users: Mapping[str, Place]) -> None:
        """Who is there now, by id."""
        self._seen = users

    def hold(self, scope: Scope) -> None:
        """Whom it follows it follows no further, also when the robot is back."""
        if self._followed and self._followed != "nobody":
            self._yaw, self._pitch = self.direction()
            self._followed = ""

    async def halt(self, scope: Scope) -> Pending:
        """Hold the gaze of a robot that follows somebody."""
        if self._asked != "user":
            return []
        await self.look(self._yaw, self._pitch)
        assert self._turn is not None
        return [self._turn.over]

    async def connected(self) -> None:
        """Look where it was told to last."""
        if self._followed:
            await self._follow(self._followed)
        # Not `else`: a stop may have come meanwhile. A robot that was away still looks where it
        # did, straight on is a direction as well.
        if not self._followed and self._asked:
            await self.look(self._yaw, self._pitch)

    def shown(self) -> Mapping[str, Json]:
        """Whom it looks at, and who could be followed."""
        shown: dict[str, Json] = {"attends": self._status}
        if self._settings.senses.users:
            shown["seen"] = ", ".join(sorted(self._seen)) or "nobody"
        return shown

    async def _attend(self, kind: str, **fields: Any) -> None:
        self._asked = kind
        attention = self._settings.attention
        if kind != "nobody":
            fields |= {
                "speed": attention.speed,
                "slack_yaw": attention.slack_yaw,
                "slack_pitch": attention.slack_pitch,
                "slack_timeout": round(attention.slack_timeout * 1000),
            }
        if self._turn is not None:
            self._link.forget(self._turn)
        self._turn = await self._link.begin(f"request.attend.{kind}", AttendStatus, **fields)

    def _attended(self, status: AttendStatus) -> None:
        self._status = status.current or status.target or "nobody"


def place_of(yaw: float, pitch: float, *, mirrored: bool = False) -> Place:
    """The place in a direction, in metres."""
    side, down = math.radians(-yaw if mirrored else yaw), math.radians(pitch)
    return Place(
        round(_FAR_M * math.cos(down) * math.sin(side), 4),
        round(-_FAR_M * math.sin(down), 4),
        round(_FAR_M * math.cos(down) * math.cos(side), 4),
    )


def direction_of(place: Place, *, mirrored: bool = False) -> tuple[float, float]:
    """Degrees to the left and down at which a place lies."""
    yaw = math.degrees(math.atan2(place.x, place.z))
    pitch = -math.degrees(math.atan2(place.y, math.hypot(place.x, place.z)))
    return (-yaw if mirrored else yaw), pitch
