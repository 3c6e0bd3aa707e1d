"""A session with the engagement model on a robot that does as told, and a visitor on demand."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

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
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.experiment import Action, DriverSpec, Engagement, Experiment, Panel
from woz_tui.drivers.contract import Argument, Driver, DriverError, Job, Offer, Verb
from woz_tui.drivers.fields import Range
from woz_tui.gate.questions import RequestOrigin
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json
from woz_tui.session.participant_identity import SessionIdentity

WIZARD = RequestOrigin("key", "k", "con1")
SENSORS = ("presence", "gaze", "distance", "identity", "loudness", "direction")
#: Seconds between two samples of a camera, as in the paper.
PERIOD = 1 / 3
#: The section of most tests: what is shown by itself is tested by itself.
PLAIN = EngagementSettings(signals="none")

_SHOWS = ("eyes", "screen", "sound")


class GuideDriver(ScriptedDriver):
    """Speaks (one second), shows, looks; what it is told to break fails."""

    broken = ""

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        angle = Range(-60, 60, "degrees")
        return replace(
            super().offer(settings),
            verbs=(
                Verb("say", "", (Argument("text", "text", required=True),), lane="voice"),
                Verb("eyes", "", (Argument("color", "text", required=True),), lane="face"),
                Verb("screen", "", (Argument("file", "file", required=True),), lane="screen"),
                Verb("sound", "", (Argument("file", "file", required=True),), lane="sound"),
                Verb("play", "", (Argument("move", "text"),), lane="body"),
                Verb(
                    "gaze",
                    "",
                    (
                        Argument("yaw", "number", range=angle),
                        Argument("pitch", "number", range=angle),
                    ),
                    lane="head",
                    stream=True,
                ),
            ),
            sensors=SENSORS,
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        self.calls.append((job.verb, dict(job.args)))
        if job.verb == self.broken:
            raise DriverError(f"no {job.verb} today", "look at the cable")
        if job.verb in ("say", "play"):
            await asyncio.sleep(1.0)
        return dict(job.args)


def guided(
    tmp_path: Path,
    settings: EngagementSettings = PLAIN,
    effects: Mapping[str, Action] | None = None,
    plays: Mapping[str, tuple[str, ...]] | None = None,
) -> Experiment:
    """An experiment with the section `engagement`, and keys for its verbs."""
    bare = experiment(tmp_path)
    robot = DriverSpec("robot", "guide", NoSettings(), GuideDriver.offer(None), HERE)
    panel = Panel(
        "Model",
        (
            action("Looks", together(call("toggle", "engagement", sign="gaze")), panel="Model"),
            action("Greet", together(call("say", text="Hello {visitor}")), panel="Model"),
        ),
        HERE,
    )
    return replace(
        bare,
        drivers=(robot,),
        panels=(*bare.panels, panel),
        engagement=Engagement(settings, effects or {}, plays or {}),
    )


def effect(state: str, *steps: Any) -> dict[str, Action]:
    """What the file says under `on_enter` for one state."""
    return {state: replace(action(f"on {state}", *steps, panel=""), key="")}


class EngagementRig(SessionRig):
    """A session with the engagement model, and a visitor in front of the robot."""

    def __init__(
        self,
        folder: Path,
        experiment: Experiment,
        kind: type[Driver] = GuideDriver,
        identity: SessionIdentity | None = None,
    ) -> None:
        catalogue = dict.fromkeys((spec.type for spec in experiment.drivers), kind)
        super().__init__(folder, identity=identity, catalogue=catalogue, made=experiment)

    @property
    def robot(self) -> GuideDriver:
        driver = self.session.drivers["robot"]
        assert isinstance(driver, GuideDriver)
        return driver

    async def visit(
        self,
        seconds: float,
        presence: float | None = 1,
        gaze: float | None = 1,
        distance: float | None = 1.0,
        identity: str | None = "Unknown",
    ) -> None:
        """For so long the sensors say this; None: they say nothing."""
        for _ in range(round(seconds / PERIOD)):
            if identity is not None:
                known = identity != "Unknown"
                name = identity if known else ""
                self.robot.context.reading("identity", 0.9 if known else 0.0, text=name)
            self.sense(presence=presence, gaze=gaze, distance=distance)
            await asyncio.sleep(PERIOD)

    def sense(self, **values: float | None) -> None:
        """One sample of each sensor named."""
        for sensor, value in values.items():
            self.robot.context.reading(sensor, value)

    def tell(self, verb: str, **args: Json) -> str:
        """A verb by itself, as from the console."""
        return self.session.send(verb, args, "", WIZARD)

    def stands_there(self, name: str = "V1") -> None:
        """The wizard says that somebody is engaged, and who."""
        self.tell("sense", sign="identity", value=name)
        self.tell("sense", sign="all", value="on")

    async def hears(self, segment: int, seconds: float = 1.0) -> None:
        """The visitor says something."""
        publish = self.session.hub.publish
        began = self.session.hub.now()
        publish(m.SpeechStarted(driver="robot", segment=segment, began=began))
        await asyncio.sleep(seconds)
        ended = self.session.hub.now()
        publish(m.SpeechEnded(driver="robot", segment=segment, began=began, ended=ended))
        await asyncio.sleep(0)

    # -- what came of it ---------------------------------------------------------------------------

    @property
    def path(self) -> list[str]:
        """The states, from the first change on."""
        return [change.now for change in self.of(m.EngagementChanged)]

    @property
    def outcomes(self) -> list[str]:
        return [change.outcome for change in self.of(m.EngagementChanged)]

    @property
    def commands(self) -> list[tuple[str, dict[str, Json]]]:
        """What was sent by the model, in order."""
        return [
            (line.verb, line.args) for line in self.of(m.Command) if line.source == "engagement"
        ]

    @property
    def notices(self) -> list[str]:
        return [line.text for line in self.of(m.Notice)]

    @property
    def engagement_shown(self) -> m.EngagementShown:
        return self.of(m.EngagementShown)[-1]


def in_room(
    tmp_path: Path,
    scenario: Callable[[EngagementRig], Awaitable[None]],
    experiment: Experiment | None = None,
    *,
    kind: type[Driver] = GuideDriver,
    linger: float = 3.0,
) -> EngagementRig:
    """Play `scenario` in virtual time; the session is closed at the end."""
    return EngagementRig(tmp_path, experiment or guided(tmp_path), kind).run(scenario, linger)
