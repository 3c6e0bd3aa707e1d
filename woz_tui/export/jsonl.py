"""A log as one pair of files, segments put together; redacted, what a lab can publish."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from typing import Any, BinaryIO

import msgspec

from woz_tui.export.event_model import ExportSession
from woz_tui.export.exporter import Exporter
from woz_tui.export.log_sources import LogSource, shown_line
from woz_tui.log.log_reader import Damage, LogLine
from woz_tui.protocol.messages import Reading

_encoder = msgspec.json.Encoder()
#: A sample with no other fields needs no redaction, as most.
_NO_WORDS = frozenset({"kind", "seq", "t", "sensor", "value", "unit", "driver", "raw", "bad"})
_ABOUT = """## Files

For each session two files of JSON Lines, as `woz` records them (docs/reference/session-log.md):
`.jsonl` has what people and the program did, `.samples.jsonl` the values of the sensors.
Segments were put together. The sums (SHA-256) in `checkpoint` and `session.end` were computed
anew: they say that this copy is whole, and nothing of the log from which it was made."""


class JsonlExporter(Exporter):
    """Writes two files for each session."""

    meaning = "one log, with its segments joined"
    about = _ABOUT
    takes_samples = True

    def add(self, session: ExportSession, source: LogSource) -> list[str]:
        """Copies one session. The log is read again: lines that are no events are copied too."""
        actions = self._folder.binary(f"{session.name}.jsonl")
        samples = self._folder.binary(f"{session.name}.samples.jsonl")
        with actions, samples:
            copy = LogCopy(actions, samples, self._shown, redacted=self._options.redact)
            for line in source.everything(Damage()):
                copy.add(line)
        return []

    def _shown(self, line: LogLine) -> LogLine:
        return shown_line(line, redact=self._options.redact, private=self._options.private)


class LogCopy:
    """A log being copied into two files. `change`: what the copy has of each line that may have
    words; `redacted`: the copy says that they were taken out.
    """

    def __init__(
        self,
        actions: BinaryIO,
        samples: BinaryIO,
        change: Callable[[LogLine], LogLine],
        *,
        redacted: bool,
    ) -> None:
        self._actions, self._samples = actions, samples
        self._change, self._redacted = change, redacted
        self._sum = hashlib.sha256()
        self._lines = 0

    def add(self, line: LogLine) -> None:
        """The next line of the log."""
        wordless = isinstance(line.message, Reading) and _NO_WORDS.issuperset(line.fields)
        if not wordless:
            line = self._change(line)
        if line.sample:
            self._samples.write(line.raw + b"\n")
            return
        differs: dict[str, Any] = {}
        match line.kind:
            case "session.start" if self._redacted:
                differs = {"redacted": True}
            case "checkpoint":
                differs = {"sha256": self._sum.hexdigest(), "lines": self._lines}
            case "session.end" if line.fields.get("sha256"):
                differs = {"sha256": self._sum.hexdigest()}
        raw = _encoder.encode({**line.fields, **differs}) if differs else line.raw
        self._actions.write(raw + b"\n")
        self._sum.update(raw + b"\n")
        self._lines += 1
