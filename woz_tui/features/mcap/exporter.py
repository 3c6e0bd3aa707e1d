"""Sessions as MCAP files: messages as JSON, each kind and each sensor on a channel of its own.

https://mcap.dev/spec; the schemas that begin with `foxglove.` are those of
https://docs.foxglove.dev/docs/visualization/message-schemas.
"""

from __future__ import annotations

import base64
import hashlib
import math
import wave
from collections.abc import Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import msgspec

from woz_tui import __version__
from woz_tui.export.event_model import ExportEvent, ExportSession
from woz_tui.export.exporter import Exporter, ExportOptions
from woz_tui.export.log_sources import ExportError, LogSource, has_private, shown_line
from woz_tui.export.output_folder import OutputFolder
from woz_tui.export.visitor_sound import readable_clips
from woz_tui.log.log_reader import Damage, LogLine
from woz_tui.protocol.kinds import message_kinds
from woz_tui.protocol.messages import Reading
from woz_tui.system.extras import install_command

if TYPE_CHECKING:  # an extra: loaded when something is exported
    from mcap.writer import Writer

_ABOUT = """## Files

For each session one file, `.mcap` (https://mcap.dev), whose messages are JSON:

- `/woz/KIND`: each line of the log, on a channel for its kind (docs/reference/session-log.md);
- `/woz/sensor/NAME`: with `--samples` the values of each sensor, and `/joints` the body's joints
  as `foxglove.JointStates`, in radians, or in metres where they slide;
- `/log`: what happened in words, as `foxglove.Log`;
- `/visitor/sound`: what was recorded of the visitor, as `foxglove.RawAudio`, where it is 16 bit.

Times are those of the wall clock at the session's beginning plus the session's own clock, so they
never jump; of a redacted session they begin at 0. The log itself is attached, with its SHA-256 in
the metadata, except for redacted sessions. Lichtblick and Foxglove show such files; `ros2 bag play`
does not, because the messages are none of ROS."""
#: Bytes of messages that are compressed together, and frames of sound in a message.
_CHUNK, _BLOCK = 1 << 20, 1 << 14
#: From the unit of a joint to radians or metres, as `foxglove.JointStates` has them.
_SCALES = {
    **dict.fromkeys(("", "°", "deg", "degrees"), math.radians(1.0)),
    **{"rad": 1.0, "m": 1.0, "mm": 0.001},
}
#: Levels of `foxglove.Log`.
_INFO, _WARNING, _ERROR = 2, 3, 4

_TIME = {
    "type": "object",
    "title": "time",
    "properties": {
        "sec": {"type": "integer", "minimum": 0},
        "nsec": {"type": "integer", "minimum": 0, "maximum": 999_999_999},
    },
}
_LOG = {
    "title": "foxglove.Log",
    "type": "object",
    "properties": {
        "timestamp": _TIME,
        "level": {"type": "integer"},
        "message": {"type": "string"},
        "name": {"type": "string"},
        "file": {"type": "string"},
        "line": {"type": "integer", "minimum": 0},
    },
}
_AUDIO = {
    "title": "foxglove.RawAudio",
    "type": "object",
    "properties": {
        "timestamp": _TIME,
        "data": {"type": "string", "contentEncoding": "base64"},
        "format": {"type": "string"},
        "sample_rate": {"type": "integer", "minimum": 0},
        "number_of_channels": {"type": "integer", "minimum": 0},
    },
}
_JOINTS = {
    "title": "foxglove.JointStates",
    "type": "object",
    "properties": {
        "timestamp": _TIME,
        "joints": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {"name": {"type": "string"}, "position": {"type": "number"}},
            },
        },
    },
}


class McapExporter(Exporter):
    """Writes one file for each session."""

    meaning = "for Foxglove, Lichtblick and other viewers of recordings (extra mcap)"
    about = _ABOUT
    takes_samples = True

    def __init__(self, folder: OutputFolder, options: ExportOptions) -> None:
        super().__init__(folder, options)
        try:
            import mcap.writer  # noqa: F401, PLC0415 - an extra
        except ImportError as error:
            raise ExportError(
                f"--to mcap needs a package that is not there: {error.name}",
                f"install it: {install_command('mcap')}",
            ) from error

    def add(self, session: ExportSession, source: LogSource) -> list[str]:
        """Write one session. The log is read again: lines that are no events are written too."""
        redact, paths = self._options.redact, source.files.actions
        private, withheld = self._options.private, False
        sums = [] if redact else [*map(_sha256, paths)]
        with (
            self._folder.binary(f"{session.name}.mcap") as file,
            closing(_Channels(file, session, " ".join(sums))) as channels,
        ):
            for line in source.everything(Damage()):
                if line.sample and not self._options.samples:
                    continue
                withheld = withheld or (not private and has_private(line))
                channels.line(shown_line(line, redact=redact, private=private))
            for event in session.events:
                channels.event(event)
            problems = channels.sound(session) if self._options.sound else []
            for path in () if redact or withheld else paths:
                channels.attach(path)
            return problems


class _Channels:
    """The channels of one file; each is declared when it gets its first message."""

    def __init__(self, file: BinaryIO, session: ExportSession, sha256: str) -> None:
        from mcap.writer import CompressionType, Writer  # noqa: PLC0415 - an extra

        self._writer: Writer = Writer(
            file, chunk_size=_CHUNK, compression=CompressionType.ZSTD, use_statistics=True
        )
        self._writer.start(profile="", library=f"woz-tui {__version__}")
        self._redacted = session.redacted
        started = None if session.redacted else session.started
        self._zero_ns = 0 if started is None else round(started.timestamp() * 1e6) * 1000
        self._channels: dict[str, int] = {}
        self._schemas = {str(kind.__struct_config__.tag): kind for kind in message_kinds()}
        self._encoder = msgspec.json.Encoder()
        start, zero = session.start, session.figures.monotonic_us
        about = {
            "session": session.code,
            "wizard": session.wizard,
            "experiment": start.experiment if start else "",
            "experiment_sha256": start.experiment_sha256 if start else "",
            "redacted": str(session.redacted).lower(),
            "sha256": sha256,
            # Like a sum of the log, it would tell which one that is.
            "monotonic_us": "" if zero is None or session.redacted else str(zero),
            "software": " ".join(start.software.values()) if start else "",
        }
        self._writer.add_metadata("woz", {name: str(value) for name, value in about.items()})

    def close(self) -> None:
        """Write the index."""
        self._writer.finish()  # type: ignore[no-untyped-call]

    def line(self, line: LogLine) -> None:
        """A line of the log. Lines about a file, not about the session, have no time."""
        if line.t < 0:
            return
        message = line.message
        if not isinstance(message, Reading):
            self._add_line(f"/woz/{line.kind.replace('.', '/')}", line)
            return
        self._add_line(f"/woz/sensor/{message.sensor.replace('.', '/')}", line)
        robot, joint, name = message.sensor.rpartition("joint.")
        scale = _SCALES.get(message.unit)
        if joint and message.value is not None and scale is not None:
            state = {"name": name, "position": message.value * scale}
            of = f"/{robot.rstrip('.').replace('.', '/')}" if robot else ""
            self._add(f"{of}/joints", line.t, _JOINTS, {"joints": [state]}, line.seq)

    def event(self, event: ExportEvent) -> None:
        """What happened, in words."""
        level = _WARNING if event.outcome in ("refused", "stopped") else _INFO
        level = _ERROR if event.outcome in ("failed", "timed_out") else level
        words = (event.kind, event.label, event.text and f'"{event.text}"', event.outcome)
        value = {
            "level": level,
            "message": " ".join(filter(None, words)),
            "name": event.driver or event.panel or event.kind,
            "file": "",
            "line": max(0, event.seq),
        }
        self._add("/log", event.begin, _LOG, value, max(0, event.seq))

    def sound(self, session: ExportSession) -> list[str]:
        """What was recorded of the visitor; returns what was left out, in sentences."""
        clips, problems = readable_clips(session)
        for clip, shape in clips:
            if shape.sampwidth != 2:
                problems.append(f"{clip.path.name} has no samples of 16 bit and is left out")
                continue
            for at_us, block in _blocks(clip.path, shape.framerate):
                value = {
                    "data": base64.b64encode(block).decode(),
                    "format": "pcm-s16",
                    "sample_rate": shape.framerate,
                    "number_of_channels": shape.nchannels,
                }
                self._add("/visitor/sound", clip.begin + at_us, _AUDIO, value)
        return problems

    def attach(self, path: Path) -> None:
        """The log itself."""
        data = path.read_bytes()
        when = self._zero_ns
        self._writer.add_attachment(when, when, path.name, "application/x-ndjson", data)

    def _add_line(self, topic: str, line: LogLine) -> None:
        if topic not in self._channels:
            self._declare(topic, self._schema(line))
        raw = line.raw
        if self._redacted and line.kind in ("checkpoint", "session.end"):
            # A sum of the log that this was made from would tell which one that is.
            raw = self._encoder.encode({**line.fields, "sha256": ""})
        self._write(topic, line.t, raw, line.seq)

    def _add(
        self, topic: str, t: int, schema: Mapping[str, Any], value: Mapping[str, Any], seq: int = 0
    ) -> None:
        if topic not in self._channels:
            self._declare(topic, schema)
        self._write(topic, t, self._encoder.encode({"timestamp": self._time(t), **value}), seq)

    def _declare(self, topic: str, schema: Mapping[str, Any]) -> None:
        text = self._encoder.encode(schema)
        number = self._writer.register_schema(str(schema["title"]), "jsonschema", text)
        self._channels[topic] = self._writer.register_channel(topic, "json", number)

    def _write(self, topic: str, t: int, data: bytes, seq: int) -> None:
        at = self._zero_ns + max(0, t) * 1000
        self._writer.add_message(self._channels[topic], at, data, at, seq)

    def _schema(self, line: LogLine) -> dict[str, Any]:
        """Viewers offer the fields that a schema lists."""
        kind = self._schemas.get(line.kind)
        if kind is None:
            return {"title": f"woz.{line.kind}", "type": "object", "properties": {}}
        (reference,), parts = msgspec.json.schema_components([kind], ref_template="#/$defs/{name}")
        own = parts.pop(reference["$ref"].rpartition("/")[2])
        return {**own, "title": f"woz.{line.kind}", "$defs": parts}

    def _time(self, t: int) -> dict[str, int]:
        seconds, nanoseconds = divmod(self._zero_ns + max(0, t) * 1000, 1_000_000_000)
        return {"sec": seconds, "nsec": nanoseconds}


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _blocks(path: Path, rate: int) -> Iterator[tuple[int, bytes]]:
    """A recording in pieces, each with its beginning in microseconds from the recording's."""
    with wave.open(str(path)) as file:
        at = 0
        while block := file.readframes(_BLOCK):
            yield at * 1_000_000 // rate, block
            at += len(block) // (file.getnchannels() * file.getsampwidth())


EXPORTERS = {"mcap": McapExporter}
