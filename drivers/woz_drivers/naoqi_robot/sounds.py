"""Sounds, played by the robot's own player: files on the robot, files of this machine, addresses.

A path that begins with / is the robot's: it has no other. What is relative is looked for below the
experiment's folder here, and fetched by the robot from `served_files`.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from woz_drivers.naoqi_robot.eyes import GLOW_S, EyesPart
from woz_drivers.naoqi_robot.memory import within
from woz_drivers.naoqi_robot.parts import (
    LONG_S,
    NaoqiPart,
    RobotCalls,
    ServiceAbsentError,
)
from woz_drivers.naoqi_robot.served_files import is_address
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_drivers.sound.emotion_sound import voiced_level
from woz_drivers.speech.uttering import forecast, told, uttered
from woz_tui.drivers.argument_values import number, sound_seconds, text
from woz_tui.drivers.contract import (
    Argument,
    DeviceLostError,
    DriverContext,
    DriverError,
    Forecast,
    Job,
    Offer,
    RejectedError,
    Scope,
)
from woz_tui.drivers.fields import Range
from woz_tui.drivers.robot_parts import Pending
from woz_tui.drivers.robot_verbs import common_verb
from woz_tui.motion.emotions import FEELINGS
from woz_tui.protocol.messages import Json

PLAYER = "ALAudioPlayer"
#: Reading a long file takes the robot a moment.
LOAD_S = 15.0
#: What no sound lasts longer than, in seconds, and the largest number of a file.
_LONGEST_S, _LARGEST_ID = 86_400.0, 2**31 - 1
_FILE = "its path from the experiment's folder, or its whole path on the robot, or http://..."


def local_file(path: str, folder: Path) -> Path | None:
    """The file of this machine that a `sound` means; None for one on the robot, and an address."""
    if not path.strip() or path.startswith("/") or is_address(path):
        return None
    try:
        local = folder / path
        return local if local.is_file() else None
    except (OSError, ValueError):  # no name that a file can have
        return None


class SoundsPart(NaoqiPart):
    """One sound at a time; a file is loaded once."""

    name = "sounds"

    def __init__(self, robot: RobotCalls, settings: NaoqiSettings, context: DriverContext) -> None:
        super().__init__(robot, settings, context)
        self._folder = context.folder
        self._ids: dict[str, int] = {}
        self._playing = ""
        self._eyes: EyesPart | None = None

    def light_up(self, eyes: EyesPart) -> None:
        """Have these eyes show how loud a sound is that was made here."""
        self._eyes = eyes

    @classmethod
    def offer(cls, settings: NaoqiSettings) -> Offer:
        """`sound`."""
        loud = Argument("volume", "number", "0 mute, 1 full", False, 1.0, Range(0, 1))
        return Offer(
            verbs=(
                common_verb("sound", "", Argument("file", "text", _FILE, required=True), loud),
                common_verb("utter", choices=FEELINGS, lane="sound"),
            )
        )

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """Of a file of this machine, and of what is made here."""
        if verb == "utter":
            return forecast(args)
        local = local_file(text(args, "file"), self._folder)
        seconds = None if local is None else sound_seconds(str(local))
        return Forecast() if seconds is None else Forecast(seconds, ())

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Play it; ends when the sound has ended."""
        if job.verb == "utter":
            return await self._utter(job)
        path = text(job.args, "file")
        volume = min(max(number(job.args, "volume", 1.0), 0.0), 1.0)
        await self._cleaned_up()
        local = local_file(path, self._folder)
        if local is not None or is_address(path):
            await self._stream(job, path, local, volume)
        else:
            await self._play(job, path, volume)
        return {"file": path, "volume": volume}

    async def halt(self, scope: Scope) -> Pending:
        """Fall silent, whoever began the sound."""
        try:
            await self._link.call(PLAYER, "stopAll")
        except ServiceAbsentError:
            if self._playing:
                raise
            return None  # a robot without a player: a stop that always complains is not looked at
        return ()

    async def connected(self) -> None:
        """The robot may have been started anew: what was loaded is not known any more."""
        self._ids.clear()

    def lost(self) -> None:
        """Its ids mean nothing any more."""
        self._ids.clear()

    async def read(self) -> Mapping[str, Json]:
        """The file being played, empty if none. What the robot has unloaded is loaded anew."""
        loaded = await self._link.ask(PLAYER, "getLoadedFilesIds")
        if isinstance(loaded, list | tuple):
            # `loadFile` gives a number, this gives the same numbers as text.
            loaded_ids = {str(sound_id) for sound_id in loaded}
            self._ids = {
                path: sound for path, sound in self._ids.items() if str(sound) in loaded_ids
            }
        return {"sound": self._playing}

    async def close(self) -> None:
        """Free the robot's memory of the files."""
        await super().close()
        if self._ids and self._link.ready:
            self._ids.clear()
            with contextlib.suppress(DriverError):
                await self._link.call(PLAYER, "unloadAllFiles")

    async def _play(self, job: Job, path: str, volume: float) -> None:
        """A file on the robot."""
        sound = await self._loaded(path)
        with contextlib.suppress(DriverError):  # how long it is is only for the countdown
            seconds = within(await self._link.call(PLAYER, "getFileLength", sound), 0.0, _LONGEST_S)
            if seconds is not None:
                job.expects(seconds)
        await self._link.call(PLAYER, "setVolume", sound, volume)
        await self._until_over(path, "play", sound)

    async def _stream(self, job: Job, path: str, local: Path | None, volume: float) -> None:
        """A file of this machine, or an address: the robot fetches it."""
        address = path
        if local is not None:
            address = await self._link.files.address(local)
            if (seconds := sound_seconds(str(local))) is not None:
                job.expects(seconds)
        await self._fetched(path, address, volume)

    async def _utter(self, job: Job) -> dict[str, Json]:
        """A sound of a mood, made here and fetched by the robot; the eyes are as bright as it is
        loud.
        """
        sound = await uttered(job.args, self._folder)
        await self._cleaned_up()
        levels = await asyncio.to_thread(voiced_level, sound, GLOW_S)
        with self._link.files.sound(await asyncio.to_thread(sound.to_bytes)) as address:
            job.expects(sound.seconds)
            async with self._eyes.glowing(levels) if self._eyes else contextlib.nullcontext():
                await self._fetched("utter", address, 1.0)
        return told(job.args, sound)

    async def _fetched(self, path: str, address: str, volume: float) -> None:
        try:
            await self._until_over(path, "playWebStream", address, volume, 0.0)
        except DeviceLostError:
            raise
        except DriverError as error:
            section = self._settings.serving_section
            raise DriverError(
                f"the robot could not play {path}: {error.what}",
                f"can it reach this machine ({section}.address, {section}.port)? else copy the file"
                " onto the robot, and give its whole path there",
            ) from error

    async def _until_over(self, path: str, method: str, *words: object) -> None:
        """Play it to its end; cut short, it ends on the robot, too."""
        self._playing = path
        try:
            await self._link.call(PLAYER, method, *words, within=LONG_S)
        except asyncio.CancelledError:
            self._clean_up.start(self._link.call(PLAYER, "stopAll"))
            raise
        finally:
            self._playing = ""

    async def _loaded(self, path: str) -> int:
        if not path.strip():
            raise RejectedError("no sound file was named", _FILE)
        if path not in self._ids:
            try:
                sound = await self._link.call(PLAYER, "loadFile", path, within=LOAD_S)
            except DeviceLostError:
                raise
            except DriverError as error:
                raise DriverError(
                    f"the robot could not load {path}: {error.what}",
                    "copy it there, and give its whole path; one of this machine is named by its"
                    " way from the experiment's folder",
                ) from error
            number = within(sound, 0, _LARGEST_ID)
            if number is None:
                raise DriverError(
                    f"the robot has not said under which number it has loaded {path}",
                    "play it again; else restart the robot",
                )
            self._ids[path] = int(number)
        return self._ids[path]
