"""ALAudioPlayer and ALAudioRecorder."""

from __future__ import annotations

import asyncio
import io
import itertools
import wave
from dataclasses import dataclass
from typing import Any

from naoqi_simulator.audio import block
from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.web import fetch
from naoqi_simulator.world import SimulatedWorld, flat

#: Sounds that come with the stand-in, with seconds: `set("sounds", ...)` adds others.
FILES = {
    "/home/nao/sounds/beep.wav": 0.4,
    "/home/nao/sounds/applause.wav": 3.0,
    "/home/nao/sounds/music.mp3": 30.0,
}


#: How long a stream lasts whose length cannot be read, in seconds.
STREAM_S = 3.0


class RobotDisk:
    """The robot's files, and no others: a table of sounds, and the folder that is its root, if it
    was given one. Files of the machine that it runs on are not its own.
    """

    def __init__(self, world: SimulatedWorld) -> None:
        self._world = world
        self.table = dict(FILES)

    def seconds(self, path: str) -> float | None:
        """How long a sound is, or None when there is no such file."""
        root = self._world.options.files
        if path in self.table or root is None:
            return self.table.get(path)
        try:
            return _wav_seconds((root / path.lstrip("/")).read_bytes())
        except OSError:
            return None

    def write(self, path: str, content: bytes) -> None:
        """Write a WAV file, with its folders. Without a root only its length is kept.

        Raises OSError.
        """
        root = self._world.options.files
        if root is None:
            self.table[path] = _wav_seconds(content) or 0.0
            return
        place = root / path.lstrip("/")
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_bytes(content)


def _wav_seconds(content: bytes) -> float | None:
    """How long a WAV file is; None for what is none."""
    try:
        with wave.open(io.BytesIO(content)) as sound:
            width = sound.getsampwidth() * sound.getnchannels()
            # The header of a file that was written to a pipe names no true length.
            data = sound.readframes(sound.getnframes())
            return float(len(data) / width / sound.getframerate())
    except (wave.Error, EOFError, ZeroDivisionError):
        return None


@dataclass(slots=True)
class _Loaded:
    path: str
    seconds: float
    volume: float = 1.0


class AudioPlayer(Service):
    """Plays files of the robot."""

    name = "ALAudioPlayer"

    def __init__(self, world: SimulatedWorld, disk: RobotDisk) -> None:
        super().__init__()
        self._world, self._disk = world, disk
        self._numbers = itertools.count(1)
        self._loaded: dict[int, _Loaded] = {}
        self.master = 1.0
        #: What was played from an address.
        self.streamed: list[dict[str, Any]] = []

    @offers("loadFile(s)i")
    def load_file(self, path: str) -> int:
        """Make a file ready; its number."""
        seconds = self._disk.seconds(path)
        if seconds is None:
            raise CallRefusedError(f"ALAudioPlayer::loadFile\n\tcannot find or open file {path}")
        number = next(self._numbers)
        self._loaded[number] = _Loaded(path, seconds)
        return number

    @offers("play(i)v")
    async def play(self, number: int) -> None:
        """Play it; returns when it is over or ended."""
        await self._play("play", number)

    @offers("play(iff)v")
    async def play_at(self, number: int, volume: float, _pan: float) -> None:
        """As play, with a volume of its own."""
        self.set_volume(number, volume)
        await self._play("play", number)

    @offers("playFile(s)v")
    async def play_file(self, path: str) -> None:
        """Load, play, unload."""
        number = self.load_file(path)
        await self._play("playFile", number)
        self._loaded.pop(number, None)

    @offers("playWebStream(sff)v")
    async def play_web_stream(self, url: str, _volume: float, _pan: float) -> None:
        """Fetch a sound from an address and play it; returns when it is over or ended."""
        fetched, content = await asyncio.to_thread(fetch, url)
        if fetched.error:
            self._world.note(f"sound: {url}: {fetched.error}")
            raise CallRefusedError(
                f"ALAudioPlayer::playWebStream\n\tcannot open {url}: {fetched.error}"
            )
        self.streamed.append({"url": url, "type": fetched.type, "size": fetched.size})
        await self._world.going.last("sound", _wav_seconds(content) or STREAM_S, url)

    @offers("stop(i)v")
    def stop(self, number: int) -> None:
        self._world.going.end("sound", about=self._file("stop", number).path)

    @offers("stopAll()v")
    def stop_all(self) -> None:
        self._world.going.end("sound")

    @offers("setVolume(if)v")
    def set_volume(self, number: int, volume: float) -> None:
        """0 to 1."""
        if not 0 <= volume <= 1:
            raise CallRefusedError("ALAudioPlayer::setVolume\n\tvolume must be within [0.0, 1.0]")
        self._file("setVolume", number).volume = volume

    @offers("getVolume(i)f")
    def get_volume(self, number: int) -> float:
        """0 to 1."""
        return self._file("getVolume", number).volume

    @offers("setMasterVolume(f)v")
    def set_master_volume(self, volume: float) -> None:
        """Of all files, 0 to 1."""
        self.master = min(1.0, max(0.0, volume))

    @offers("getMasterVolume()f")
    def get_master_volume(self) -> float:
        """Of all files, 0 to 1."""
        return self.master

    @offers("getFileLength(i)f")
    def get_file_length(self, number: int) -> float:
        """Seconds."""
        return self._file("getFileLength", number).seconds

    @offers("getCurrentPosition(i)f")
    def get_current_position(self, number: int) -> float:
        """Seconds; 0 while it is not played."""
        path = self._file("getCurrentPosition", number).path
        playing = [one for one in self._world.going.of("sound") if one.about == path]
        return self._world.time.now() - playing[0].begun if playing else 0.0

    @offers("unloadFile(i)v")
    def unload_file(self, number: int) -> None:
        self._file("unloadFile", number)
        del self._loaded[number]

    @offers("unloadAllFiles()v")
    def unload_all_files(self) -> None:
        self.stop_all()
        self._loaded.clear()

    @offers("getLoadedFilesIds()[s]")
    def get_loaded_files_ids(self) -> list[str]:
        """Numbers, as text: so does NAOqi (`std::vector<std::string>` in alaudioplayerproxy.h)."""
        return [str(number) for number in self._loaded]

    @offers("getLoadedFilesNames()m")
    def get_loaded_files_names(self) -> list[str]:
        """Paths."""
        return [one.path for one in self._loaded.values()]

    async def _play(self, method: str, number: int) -> None:
        file = self._file(method, number)
        await self._world.going.last("sound", file.seconds, file.path)

    def _file(self, method: str, number: int) -> _Loaded:
        if number not in self._loaded:
            raise CallRefusedError(f"ALAudioPlayer::{method}\n\tno file is loaded under {number}")
        return self._loaded[number]

    def state(self) -> list[dict[str, Any]]:
        """Files that are ready."""
        return [
            {"id": number, "path": one.path, "volume": one.volume}
            for number, one in self._loaded.items()
        ]


@dataclass(frozen=True, slots=True)
class _OpenRecording:
    path: str
    rate: int
    channels: int
    begun: float


class AudioRecorder(Service):
    """Records the microphones into a file."""

    name = "ALAudioRecorder"

    def __init__(self, world: SimulatedWorld, disk: RobotDisk) -> None:
        super().__init__()
        self._world, self._disk = world, disk
        self._recording: _OpenRecording | None = None

    @offers("startMicrophonesRecording(ssim)v")
    def start(self, path: str, kind: str, rate: int, channels: Any) -> None:
        """Begin; channels are flags for left, right, front, rear."""
        method = "ALAudioRecorder::startMicrophonesRecording"
        if self._recording is not None:
            raise CallRefusedError(f"{method}\n\talready recording")
        if kind not in ("wav", "ogg"):
            raise CallRefusedError(f"{method}\n\tunknown type {kind}")
        flags = flat(channels)
        if len(flags) != 4 or not any(flags):
            raise CallRefusedError(
                f"{method}\n\tchannels must be four flags, one of them at least set"
            )
        if rate not in (16_000, 48_000):
            raise CallRefusedError(f"{method}\n\tsample rate must be 16000 or 48000")
        # All four come at 48 kHz or 16 kHz, as the documentation's examples have it.
        self._recording = _OpenRecording(
            path, rate, sum(bool(one) for one in flags), self._world.time.now()
        )

    @offers("stopMicrophonesRecording()v")
    def stop(self) -> None:
        """End, and write the file; a file that cannot be written is noted in the robot's log."""
        recording, self._recording = self._recording, None
        if recording is None:
            raise CallRefusedError("ALAudioRecorder::stopMicrophonesRecording\n\tnot recording")
        try:
            self._disk.write(recording.path, self._content(recording))
        except OSError as error:
            self._world.note(f"recording {recording.path}: {error}")
        else:
            self._world.note(f"recorded {recording.path}")

    @property
    def path(self) -> str:
        """The file that is being recorded, or nothing."""
        return self._recording.path if self._recording else ""

    def _content(self, recording: _OpenRecording) -> bytes:
        passed = self._world.time.now() - recording.begun
        samples = round(min(passed, 600.0) * recording.rate)
        sound = block(
            *(self._world.person(), recording.begun, samples),
            *(recording.rate, recording.channels),
        )
        content = io.BytesIO()
        with wave.open(content, "wb") as file:
            file.setnchannels(recording.channels)
            file.setsampwidth(2)
            file.setframerate(recording.rate)
            file.writeframes(sound.tobytes())
        return content.getvalue()
