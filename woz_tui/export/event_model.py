"""A session as other programs see it: what happened, from when to when. Times in microseconds."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from woz_tui.analysis.figure_counting import figures_of
from woz_tui.analysis.figures import SessionFigures
from woz_tui.analysis.tables import wall_time
from woz_tui.protocol.messages import Json, SessionStart
from woz_tui.timeline.timeline import timeline_of


def letters(text: str, otherwise: str) -> str:
    """The ASCII letters and digits of `text`; `otherwise` if there are none."""
    return re.sub("[^A-Za-z0-9]", "", text) or otherwise


#: Of a session of which nothing is known.
NO_FIGURES = figures_of(timeline_of(()))
#: The outcome of what had not ended when the log did.
OPEN = "open"
#: The number of what stands in no line of the log.
NO_LINE = -1


@dataclass(slots=True, kw_only=True)
class InContext:
    """Something that belongs to a participant, a condition, a trial and a phase, or to none.
    `counted`: somebody took part, and in no trial that was aborted or excluded.
    """

    participant: str = ""
    condition: str = ""
    trial: int | None = None
    phase: str = ""
    counted: bool = True


@dataclass(slots=True, kw_only=True)
class ExportEvent(InContext):
    """Something that happened at a moment, or lasted.

    Attributes:
        seq: Number of the line with which it began; orders what happened at the same time.
        begin: When it began, on the session's axis.
        end: When it ended; None: it was a moment.
        kind: action, command, engagement, trial, phase, break, stop, speech, echo (the robot's own
            voice, as a microphone heard it), questionnaire,
            difference (a robot's setting was other than asked for), conflict (of settings), code
            (a coder set it in a replay); for moments the kind of the line (marker, note,
            sensor.changed ...).
        label: What of its kind it is: an action's name, a state, a trial's number.
        text: What was said, typed or recognised.
        outcome: How it ended; `open`: the log ended first.
        evidence: For actions and commands, on what it stands that it was done.
        latency: For actions and commands, from the request to the driver's start.
        acted: When the driver started, for commands.
        mistake: The wizard labelled it as one.
        edited: Of an action: its sentence was typed anew before it was said.
        details: Everything else that the log says of it.
    """

    seq: int
    begin: int
    kind: str
    end: int | None = None
    label: str = ""
    text: str = ""
    panel: str = ""
    action: str = ""
    verb: str = ""
    driver: str = ""
    source: str = ""
    key: str = ""
    outcome: str = ""
    evidence: str = ""
    reason: str = ""
    run: str = ""
    command: str = ""
    latency: int | None = None
    acted: int | None = None
    mistake: bool = False
    edited: bool = False
    details: dict[str, Json] = field(default_factory=dict)

    @property
    def duration(self) -> int:
        """How long it lasted; 0 for a moment."""
        return 0 if self.end is None else self.end - self.begin


@dataclass(frozen=True, slots=True)
class SoundClip:
    """A sound file of the visitor, and where on the session's axis it begins."""

    path: Path
    begin: int


@dataclass(frozen=True, slots=True)
class JoinedRecording:
    """How a session lies in another program's recording.

    Attributes:
        name: Of the recording's file.
        stream: The stream whose first value is 0 of its time.
        offset: The session's beginning on that axis.
        notes: What there is to know of the join, in sentences.
    """

    name: str
    stream: str
    offset: int
    notes: tuple[str, ...] = ()


@dataclass(slots=True, kw_only=True)
class ExportSession:
    """A session without its samples.

    Attributes:
        name: Of its own among all sessions of an export; its files are called so.
        folders: Where the log's files lie, and what they name.
        start: What the first line says; None if that line is lost.
        events: By time of beginning.
        figures: What the report computes of it.
        clips: Recorded sound that is there still.
        clips_missing: How many recorded sentences are not.
        duration: Time of the last line.
        end_reason: What the last line says; empty if it is lost.
        damage: What is wrong with the log, in sentences; empty: nothing.
        lines: How many lines were read, samples not counted.
        redacted: Whether texts and dates were taken out.
        recording: Another program's recording, on whose time events are to be; None: on their own.
    """

    name: str
    folders: tuple[Path, ...] = ()
    start: SessionStart | None = None
    events: list[ExportEvent] = field(default_factory=list)
    figures: SessionFigures = NO_FIGURES
    clips: list[SoundClip] = field(default_factory=list)
    clips_missing: int = 0
    duration: int = 0
    end_reason: str = ""
    damage: list[str] = field(default_factory=list)
    lines: int = 0
    redacted: bool = False
    recording: JoinedRecording | None = None

    @property
    def code(self) -> str:
        """The session's code; empty if the log does not say."""
        return self.start.session if self.start else ""

    @property
    def wizard(self) -> str:
        """The wizard's code; empty if the log does not say."""
        return self.start.wizard if self.start else ""

    @property
    def clock(self) -> Mapping[str, str | int]:
        """Where the axis of time comes from."""
        return self.start.clock if self.start else {}

    @property
    def started(self) -> datetime | None:
        """The wall clock at 0, in UTC; None if the log does not say or dates were taken out."""
        return wall_time(str(self.clock.get("wall_at_t0", "")))

    @property
    def participants(self) -> list[str]:
        """Codes of all who took part, as the report decides it; if nobody did, all that were
        given. In order of appearance.
        """
        if self.figures.participants:
            return list(self.figures.participants)
        first = self.start.participant if self.start else ""
        codes = (first, *(event.participant for event in self.events))
        return list(dict.fromkeys(filter(None, codes)))
