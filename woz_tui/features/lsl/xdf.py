"""Joins a session with a recording of the Lab Streaming Layer (XDF), line by line.

Lines meet by their number, not by their time: what the times differ by is found, not assumed.
"""

from __future__ import annotations

import json
import logging
import statistics
import struct
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from woz_tui.analysis.text_format import counted
from woz_tui.export.event_model import ExportSession, JoinedRecording
from woz_tui.export.log_sources import ExportError
from woz_tui.export.other_recording import OtherRecording, RecordingReader
from woz_tui.features.lsl.kinds import LslAdopted
from woz_tui.features.lsl.shared_lines import SharedLines
from woz_tui.log.log_reader import LogLine
from woz_tui.protocol import messages as m
from woz_tui.protocol.kinds import closed_kinds
from woz_tui.system.extras import install_command

#: Offsets of a clock that moved by more than this drifted: one offset does not hold for all.
_DRIFT_S = 0.001


@dataclass(frozen=True, slots=True)
class XdfStream:
    """A stream of a recording, with its stamps on the sender's clock, in seconds.

    `offset`: what the recorder added to them to have its own clock, and `drift`: by how much that
    changed; None: it measured none.
    """

    name: str
    type: str
    rate: float
    host: str
    stamps: Sequence[float]
    values: Sequence[Any]
    woz: Mapping[str, str]
    offset: float | None
    drift: float


class XdfReader(RecordingReader):
    """Reads what LabRecorder and other recorders write."""

    def join(
        self, recording: OtherRecording, session: ExportSession, lines: Iterable[LogLine]
    ) -> JoinedRecording:
        """By the stream of the log's lines, or where it was not recorded by the clock's zero."""
        name = recording.path.name
        streams = _read(recording)
        log = [line for line in lines if line.seq >= 0]
        found = [(_matches(stream, log), stream) for stream in streams if stream.woz]
        ours = max(found, key=lambda each: len(each[0]), default=None)
        if ours is None:
            raise ExportError(
                f"{name} has no stream of a session", "record woz-events beside the others"
            )
        matches, stream = ours
        if matches:
            begin = statistics.median(stamp - t for _, t, stamp in matches)
            notes = [*_differences(name, matches, begin, log)]
        else:
            stream, begin = _by_clock(name, session, [each for _, each in found], log)
            notes = [f"{name} has no line of the log: joined by the zero of its clock"]
        other = _other(recording, streams)
        apart, said = _between(stream, other)
        offset = begin + apart - other.stamps[0]
        word = "after" if offset >= 0 else "before"
        notes += [
            f"onset 0 is the first value of the stream {other.name} ({other.type}); the session"
            f" began {abs(offset):.3f} s {word} it",
            *said,
        ]
        return JoinedRecording(name, other.name, round(offset * 1e6), tuple(notes))


READERS = {".xdf": XdfReader()}


def _read(recording: OtherRecording) -> list[XdfStream]:
    try:
        import pyxdf  # noqa: PLC0415 - an extra
    except ImportError as error:
        raise ExportError(
            "a recording of the Lab Streaming Layer needs the package pyxdf", install_command("lsl")
        ) from error
    logging.getLogger("pyxdf").setLevel(logging.ERROR)
    try:
        # Of a stream with a rate they are smoothed, as programs for EEG have them; ours has none.
        read, _ = pyxdf.load_xdf(recording.path, synchronize_clocks=False)
    except (OSError, ValueError, KeyError, IndexError, EOFError, struct.error) as error:
        raise ExportError(
            f"{recording.path.name} cannot be read: {error}", "is it a recording (XDF)?"
        ) from error
    return [_stream(each) for each in read]


def _stream(read: Mapping[str, Any]) -> XdfStream:
    info = read["info"]

    def field(name: str) -> str:
        return str((info.get(name) or [""])[0] or "")

    described = (info.get("desc") or [None])[0]
    woz = described.get("woz") if isinstance(described, Mapping) else None
    about = woz[0] if woz else None
    offsets = [*_offsets(read)]
    return XdfStream(
        name=field("name"),
        type=field("type"),
        rate=float(field("nominal_srate") or 0),
        host=field("hostname"),
        stamps=[*map(float, read["time_stamps"])],
        values=read["time_series"],
        woz={name: str(texts[0] or "") for name, texts in about.items()} if about else {},
        offset=statistics.median(offsets) if offsets else None,
        drift=max(offsets) - min(offsets) if offsets else 0.0,
    )


def _offsets(read: Mapping[str, Any]) -> Iterator[float]:
    """What the recorder measured, from the stream's footer."""
    with suppress(KeyError, IndexError, TypeError, ValueError):
        for each in read["footer"]["info"]["clock_offsets"][0]["offset"]:
            yield float(each["value"][0])


#: A line that is in both: its number, its time in the log and its stamp, in seconds.
Match = tuple[int, float, float]


def _matches(stream: XdfStream, log: Sequence[LogLine]) -> list[Match]:
    """The lines of the log that a stream has: with the same number, kind and time."""
    known = {line.seq: line for line in log}
    found = []
    for value, stamp in zip(stream.values, stream.stamps, strict=True):
        try:
            sent = json.loads(value[0])
            line = known.get(sent["seq"])
            if line is not None and (line.kind, line.t) == (sent["kind"], sent["t"]):
                found.append((line.seq, line.t / 1e6, stamp))
        except (ValueError, KeyError, TypeError):
            continue  # a marker, or a line of ours that is none of the log
    return found


def _differences(
    name: str, matches: Sequence[Match], begin: float, log: Sequence[LogLine]
) -> Iterator[str]:
    """What recording and log do not have alike."""
    first, last = matches[0][0], max(seq for seq, _, _ in matches)
    there = {seq for seq, _, _ in matches}
    adopted = [line.message for line in log if isinstance(line.message, LslAdopted)]
    shares = adopted[-1].shares if adopted else []
    shared = SharedLines(shares)
    kept = () if "conditions" in shares else tuple(closed_kinds())
    sent = [
        line
        for line in log
        if first <= line.seq <= last
        and line.message is not None
        and not line.sample
        and not isinstance(line.message, kept)
        and shared.line(line.message) is not None
    ]
    missing = [line for line in sent if line.seq not in there]
    off = max(abs(stamp - t - begin) for _, t, stamp in matches) * 1e6
    yield (
        f"{name}: of numbers {first} to {last}, {len(there)} of {counted(len(sent), 'line')} that"
        f" were sent are recorded; their times differ from the log by {off:.1f} µs at the most"
    )
    if missing:
        kinds = Counter(line.kind for line in missing)
        words = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())
        yield f"{name} lacks {words}; the first is number {missing[0].seq}"
    if twice := len(matches) - len(there):
        yield f"{name} has {counted(twice, 'line')} twice"


def _by_clock(
    name: str, session: ExportSession, streams: Sequence[XdfStream], log: Sequence[LogLine]
) -> tuple[XdfStream, float]:
    """The session's stream, and its beginning on the sender's clock, as both say it."""
    starts = (line.message for line in log if isinstance(line.message, m.SessionStart))
    zero = next((start.clock.get("monotonic_us") for start in starts), None)
    for stream in streams:
        if zero is not None and stream.woz.get("monotonic_us") == str(zero):
            return stream, int(zero) / 1e6
    others = ", ".join(sorted({each.woz.get("session", "?") for each in streams}))
    raise ExportError(
        f"{name} has no line of the session {session.code or session.name}",
        f"it is of the session {others}",
    )


def _other(recording: OtherRecording, streams: Sequence[XdfStream]) -> XdfStream:
    """The stream whose first value is the recording's 0."""
    others = [each for each in streams if not each.woz and len(each.stamps)]
    known = ", ".join(each.name for each in others)
    if recording.stream:
        named = [each for each in others if each.name == recording.stream]
        if not named:
            raise ExportError(
                f"{recording.path.name} has no other stream {recording.stream!r} with values",
                f"there are {known}" if known else "there is none",
            )
        return named[0]
    if not others:
        raise ExportError(
            f"{recording.path.name} has no values of another program", "record its stream too"
        )
    return max(others, key=lambda each: (each.type.upper() == "EEG", each.rate))


def _between(ours: XdfStream, other: XdfStream) -> tuple[float, list[str]]:
    """What to add to our stamps to have the other's clock, and what is to be said of it."""
    if ours.host == other.host:  # one clock: what is measured there is an error of the measurement
        return 0.0, []
    if ours.offset is None or other.offset is None:
        return 0.0, [
            f"{ours.host} and {other.host} have clocks of their own, and the recorder measured no"
            " offsets: onsets may be wrong"
        ]
    apart, drift = ours.offset - other.offset, ours.drift + other.drift
    notes = [f"the clock of {other.host} is {apart * 1e3:+.3f} ms from that of {ours.host}"]
    if drift > _DRIFT_S:
        notes.append(f"that changed by {drift * 1e3:.1f} ms meanwhile: onsets are as wrong")
    return apart, notes
