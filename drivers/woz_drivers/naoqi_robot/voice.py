"""The voice: speaking with gestures or without, reading a text out, and how it sounds.

`say` ends when the robot has finished speaking: the call itself returns then. The event
`ALTextToSpeech/TextDone` would tell the same later and not reliably: subscribing to it fails with
NAOqi 2.5.8 to 2.5.10, and asking for it over and over costs calls that a stop had to wait behind.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any

from woz_drivers.naoqi_robot import tags
from woz_drivers.naoqi_robot.parts import (
    LONG_S,
    NaoqiPart,
    RobotCalls,
    apply,
    read_back,
    write_setting,
)
from woz_drivers.naoqi_robot.robot_settings import SETTINGS, TTS, of_section
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.naoqi_robot.tags import problems
from woz_tui.drivers.argument_values import number, text
from woz_tui.drivers.contract import (
    Argument,
    DriverContext,
    DriverError,
    Forecast,
    Job,
    Offer,
    RejectedError,
    Scope,
    Verb,
)
from woz_tui.drivers.robot_parts import Pending
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.protocol.messages import Json

LANE, SETTINGS_LANE = "voice", "voice-settings"
SOUNDS = tuple(of_section("Voice"))


class VoicePart(NaoqiPart):
    """Text to speech; one utterance at a time."""

    name = "speech"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        #: Asked for last, by the robot file or by a command: set again after a loss.
        self._desired = settings.initial_values(SOUNDS)
        #: In per cent, as last read; only the expected duration depends on it.
        self._speed = settings.voice.speed or 100.0

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`say` and `read`, and the three settings of the voice."""
        plain = Argument("plain", "flag", "without gestures", default=False)
        return Offer(
            verbs=(
                common_verb(
                    "say",
                    "speak a sentence; tags for voice and gestures count",
                    plain,
                    limit_s=300.0,
                    markup=("tags", "gestures"),
                ),
                Verb(
                    "read",
                    "read a text file out, paragraph by paragraph",
                    (
                        Argument("file", "file", "a text file, relative to the experiment", True),
                        plain,
                    ),
                    lane=LANE,
                    limit_s=3600.0,
                ),
                *(
                    setting.changed_by(
                        f"set {setting.what}", lane=SETTINGS_LANE, limit_s=5.0, brief=True
                    )
                    for setting in SOUNDS
                ),
            )
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Speak, or change how it speaks."""
        match job.verb:
            case "say":
                return await self._speak(job)
            case "read":
                return await self._read(job)
        return await self._set(job)

    async def halt(self, scope: Scope) -> Pending:
        """Fall silent."""
        await self._link.call(TTS, "stopAll")
        return ()

    async def connected(self) -> None:
        """Apply what the robot file says of the voice, or the wizard since."""
        await apply(
            self._context,
            {
                name.replace("_", " "): write_setting(self._link, SETTINGS[name], to)
                for name, to in self._desired.items()
            },
        )

    async def read(self) -> Mapping[str, Json]:
        """Volume (0 to 1), speed (per cent) and pitch as the robot has them."""
        before = self._speed
        read = await read_back(self._link, SOUNDS)
        speed, allowed = read.get("speech_speed"), SETTINGS["speech_speed"].range
        if self._speed == before and isinstance(speed, float) and allowed.contains(speed):
            self._speed = speed  # else it was set while the robot was asked
        return read

    # -- speaking --------------------------------------------------------------------------------

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """About: the robot says neither how long a text takes nor when its words come."""
        spoken = ""
        if verb == "say":
            spoken = text(args, "text")
        elif verb == "read":
            spoken = await asyncio.to_thread(
                tags.read_text, self._context.folder / text(args, "file")
            )
        parts = tags.paragraphs(spoken)
        return Forecast(sum(tags.seconds(part, self._speed) for part in parts) if parts else None)

    async def _speak(self, job: Job) -> dict[str, Json]:
        spoken = text(job.args, "text")
        if not spoken.strip():
            raise RejectedError("there is nothing to say", "write a text")
        self._warn(spoken)
        await self._cleaned_up()
        job.expects(tags.seconds(spoken, self._speed))
        await self._utter(spoken, job.args.get("plain") is True)
        return {"text": spoken}

    async def _read(self, job: Job) -> dict[str, Json]:
        path = self._context.folder / text(job.args, "file")
        content = await asyncio.to_thread(tags.read_text, path)
        parts = tags.paragraphs(content)
        if not parts:
            raise RejectedError(f"{path} has no text in it", "write something into it")
        self._warn(content)
        await self._cleaned_up()
        for position, part in enumerate(parts):
            job.expects(sum(tags.seconds(left, self._speed) for left in parts[position:]))
            try:
                await self._utter(part, job.args.get("plain") is True)
            except DriverError as error:
                where = f"paragraph {position + 1} of {len(parts)}"
                raise type(error)(f"{where}: {error.what}", error.remedy) from error
        return {"file": str(job.args["file"]), "paragraphs": len(parts)}

    async def _utter(self, spoken: str, plain: bool) -> None:
        # Who must not move speaks without gestures.
        still = plain or self._link.refused("ALAnimatedSpeech.say") is not None
        service = TTS if still else "ALAnimatedSpeech"
        try:
            await self._link.call(service, "say", spoken, within=LONG_S)
        except asyncio.CancelledError:
            self._clean_up.start(self._link.call(TTS, "stopAll"))
            raise

    def _warn(self, spoken: str) -> None:
        """Tags that the robot will not understand; what is said stays as it was written."""
        for problem in problems(spoken):
            remedy = "correct the tag in the text"
            self._context.notice("warning", problem, remedy, tells=("request",))

    async def _set(self, job: Job) -> dict[str, Json]:
        setting = SETTINGS[job.verb]
        value = number(job.args, setting.argument)
        if not setting.allows(value):
            raise RejectedError(f"{job.verb} takes {setting.numbers}, not {value:g}", setting.what)
        await write_setting(self._link, setting, value)
        self._desired[setting.name] = value
        if setting.name == "speech_speed":
            self._speed = value
        return {setting.argument: value}
