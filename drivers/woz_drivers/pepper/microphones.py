"""The robot's microphones: recordings on the robot, and its sound as a file on this machine."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath

from woz_drivers.pepper.camera_files import stamp
from woz_drivers.pepper.microphones_listening import Listening
from woz_drivers.pepper.parts import Part, Robot
from woz_drivers.pepper.settings import PepperSettings
from woz_tui.core.driver import Argument, DriverError, Job, Outlet, Rejected, Verb
from woz_tui.core.messages import Json

#: Of the recordings on the robot.
_RECORDED_HZ = 16000
#: Left, right, front, rear: all four.
_ALL = [1, 1, 1, 1]
_FAREWELL_S = 0.5
_ON = Argument("on", "flag", "begin or end", required=True)


@dataclass(slots=True)
class _Recording:
    """One on the robot."""

    path: str
    t_us: int


class Microphones(Part):
    """`record_sound` has the robot write a file of its own, `listen` brings its sound here."""

    name = "microphones"

    def __init__(self, robot: Robot, settings: PepperSettings, outlet: Outlet) -> None:
        super().__init__(robot, settings, outlet)
        self._folder = settings.recordings
        self._recording: _Recording | None = None
        self._listening: Listening | None = None
        #: Those that ended without being waited for.
        self._left: list[Listening] = []

    @classmethod
    def verbs(cls, settings: PepperSettings) -> tuple[Verb, ...]:
        """Recording there, listening here."""
        return (
            Verb("record_sound", "record its microphones to a file on the robot", (_ON,), "watch"),
            Verb("listen", "its front microphone to a WAV file beside the log", (_ON,), "watch"),
        )

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Begin or end one of the two. `file`, `t` (of its beginning), and `seconds` at its end."""
        on = bool(job.args["on"])
        match job.verb:
            case "record_sound":
                return await (self._record() if on else self._end_record())
            case "listen":
                return await (self._listen() if on else self._end_listen())
        raise Rejected(f"the microphones cannot {job.verb}")

    def lost(self) -> None:
        """A recording may go on without us; the file here ends."""
        recording, self._recording = self._recording, None
        if recording is not None:
            self._tell_left(recording)
        listening, self._listening = self._listening, None
        if listening is not None:
            self._leave(listening)
            text = f"the robot's sound in {listening.file} ends here: the robot is gone"
            self._outlet.notice("warning", text, "play listen again when it is there")

    async def read(self) -> Mapping[str, Json]:
        """What is under way."""
        under_way = [
            *([f"recording {self._recording.path}"] if self._recording else []),
            *([f"listening to {self._listening.file}"] if self._listening else []),
        ]
        return {"microphones": ", ".join(under_way) or "off"}

    async def close(self) -> None:
        """End both; a robot that does not confirm it may record on, which is told."""
        if self._listening is not None:
            with contextlib.suppress(DriverError):  # it is written as far as it came
                await self._end_listen()
        for left in self._left:
            await left.close()
        recording = self._recording
        if recording is not None:
            try:
                await self._end_record(within=_FAREWELL_S)
            except DriverError:
                self._recording = None
                self._tell_left(recording)

    # -- on the robot --------------------------------------------------------------------------

    async def _record(self) -> Mapping[str, Json]:
        if self._recording is not None:
            raise Rejected(
                f"it is recording already, to {self._recording.path}", "end that one first"
            )
        name = f"woz-{stamp(self._outlet.clock.wall())}.wav"
        path = str(PurePosixPath(self._folder) / name)
        t_us = self._outlet.clock.now_us()
        try:
            await self._robot.call(
                "ALAudioRecorder", "startMicrophonesRecording", path, "wav", _RECORDED_HZ, _ALL
            )
        except Rejected:
            raise
        except DriverError as error:
            remedy = error.remedy or "record_sound off ends what it may be recording still"
            raise type(error)(f"no recording was begun: {error.what}", remedy) from None
        self._recording = _Recording(path, t_us)
        return {"file": path, "t": self._outlet.t(t_us)}

    async def _end_record(self, within: float = 2.0) -> Mapping[str, Json]:
        """Also without one of ours: an earlier program may have left one."""
        await self._robot.call("ALAudioRecorder", "stopMicrophonesRecording", within=within)
        recording, self._recording = self._recording, None
        if recording is None:
            return {"file": ""}
        seconds = (self._outlet.clock.now_us() - recording.t_us) / 1_000_000
        start = self._outlet.t(recording.t_us)
        return {"file": recording.path, "t": start, "seconds": round(seconds, 3)}

    def _tell_left(self, recording: _Recording) -> None:
        text = f"the robot may still be recording to {recording.path}"
        self._outlet.notice("warning", text, "when it is there again: record_sound off")

    # -- here ----------------------------------------------------------------------------------

    async def _listen(self) -> Mapping[str, Json]:
        if self._listening is not None:
            raise Rejected(f"it is listening already, to {self._listening.file}", "end it first")
        listening = Listening(self._robot, self._outlet)
        self._listening = listening
        try:
            return await listening.begin()
        except BaseException:
            if self._listening is listening:
                self._listening = None
            self._leave(listening)
            raise

    async def _end_listen(self) -> Mapping[str, Json]:
        listening, self._listening = self._listening, None
        if listening is None:
            return {"file": ""}
        return await listening.end()

    def _leave(self, listening: Listening) -> None:
        listening.abandon()
        self._left.append(listening)
