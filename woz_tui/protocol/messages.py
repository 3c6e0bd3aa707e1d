"""Everything that is ever said in a session: to the log, over the socket, in a replay.

A message is one JSON object on one line. Its `kind` names the class, `seq` its place in the
session, `t` whole microseconds since the session began (monotonic clock), `ts` the wall clock.
The hub fills these three in; whoever makes a message leaves them alone. Fields that hold their
default are left out of the line, so a field has one JSON type wherever it appears.
"""

from __future__ import annotations

import math

import msgspec

from woz_tui.protocol.action_messages import (
    Ack,
    ActionDone,
    ActionEnd,
    ActionFailed,
    ActionRefused,
    ActionRequested,
    ActionsFilled,
    ActionStopped,
    ActionSuperseded,
    Command,
    Dispatched,
    Done,
    End,
    Failed,
    FilledCall,
    Progress,
    Refused,
    StopConfirmed,
    Stopped,
    StopPressed,
    StopReleased,
    Superseded,
    TimedOut,
)
from woz_tui.protocol.body_messages import (
    BodyChanged,
    ControlsMoved,
    FaceShown,
    SettingsShown,
    Shown,
)
from woz_tui.protocol.driver_health import (
    DriverConnected,
    DriverConnecting,
    DriverFaulted,
    DriverHealth,
    DriverLost,
    LaneFaulted,
    LaneRecovered,
)
from woz_tui.protocol.envelope import Json, Message, RestrictedMessage
from woz_tui.protocol.study_messages import (
    ActionHeld,
    BreakEnded,
    BreakStarted,
    ConditionsAssigned,
    CueAnswered,
    CueGiven,
    ExperimentFiles,
    PerceptionChanged,
    PreflightChecked,
    QuestionnaireAnswered,
    QuestionnaireEnded,
    QuestionnaireStarted,
    RerunEnded,
    RerunSent,
    RerunSkipped,
    RerunStarted,
    SessionPlan,
    ShapingChanged,
    StudyMessage,
    TrainingChanged,
    TrialEnded,
    TrialStarted,
)
from woz_tui.protocol.visitor_messages import (
    EngagementAdopted,
    EngagementChanged,
    EngagementShown,
    SignShown,
    Speech,
    SpeechEnded,
    SpeechStarted,
    SpeechText,
    VisitorChanged,
)
from woz_tui.protocol.wizard_messages import (
    ConsoleAttached,
    ConsoleLost,
    ExperimentReloaded,
    Marker,
    Mistake,
    Note,
    PanelLocked,
    PhaseChanged,
    ProfileChanged,
    ScriptMoved,
)

#: Names that are defined next door and belong to this module's readers.
__all__ = [
    "Ack",
    "ActionDone",
    "ActionEnd",
    "ActionFailed",
    "ActionHeld",
    "ActionRefused",
    "ActionRequested",
    "ActionStopped",
    "ActionSuperseded",
    "ActionsFilled",
    "BodyChanged",
    "BreakEnded",
    "BreakStarted",
    "Command",
    "ConditionsAssigned",
    "ConsoleAttached",
    "ConsoleLost",
    "ControlsMoved",
    "CueAnswered",
    "CueGiven",
    "Dispatched",
    "Done",
    "DriverConnected",
    "DriverConnecting",
    "DriverFaulted",
    "DriverHealth",
    "DriverLost",
    "End",
    "EngagementAdopted",
    "EngagementChanged",
    "EngagementShown",
    "ExperimentFiles",
    "ExperimentReloaded",
    "FaceShown",
    "Failed",
    "FilledCall",
    "Json",
    "LaneFaulted",
    "LaneRecovered",
    "Marker",
    "Message",
    "Mistake",
    "Note",
    "PanelLocked",
    "PerceptionChanged",
    "PhaseChanged",
    "PreflightChecked",
    "ProfileChanged",
    "Progress",
    "QuestionnaireAnswered",
    "QuestionnaireEnded",
    "QuestionnaireStarted",
    "Refused",
    "RerunEnded",
    "RerunSent",
    "RerunSkipped",
    "RerunStarted",
    "RestrictedMessage",
    "ScriptMoved",
    "SessionPlan",
    "SettingsShown",
    "ShapingChanged",
    "Shown",
    "SignShown",
    "Speech",
    "SpeechEnded",
    "SpeechStarted",
    "SpeechText",
    "StopConfirmed",
    "StopPressed",
    "StopReleased",
    "Stopped",
    "Superseded",
    "TimedOut",
    "TrainingChanged",
    "TrialEnded",
    "TrialStarted",
    "VisitorChanged",
]

FORMAT = "woz-session"
SCHEMA = 3


# -- the session ----------------------------------------------------------------------------


class SessionStart(Message, frozen=True, kw_only=True, omit_defaults=True, tag="session.start"):
    """First line of a log: who, what, with which software, and how clock and calendar meet.

    `spill`: folders in which the log goes on if its own fails, best first; each as it is on that
    machine and, where that differs, as seen from the log's.
    """

    format: str = msgspec.field(default_factory=lambda: FORMAT)
    schema: int = msgspec.field(default_factory=lambda: SCHEMA)
    session: str
    participant: str
    condition: str
    wizard: str
    software: dict[str, str]
    experiment: str
    experiment_sha256: str
    seed: int
    clock: dict[str, str]
    spill: list[str] = msgspec.field(default_factory=list)


class SessionChanged(Message, frozen=True, kw_only=True, omit_defaults=True, tag="session.changed"):
    """Participant, condition or trial was set during the session; only what changed is there."""

    participant: str | None = None
    condition: str | None = None
    trial: int | None = None


class SessionEnd(
    RestrictedMessage, frozen=True, kw_only=True, omit_defaults=True, tag="session.end"
):
    """Last line of a log. `sha256` covers every line of actions before it, each once and in the
    order of `seq`: in a session of one segment, every byte of the file.
    """

    reason: str
    sha256: str = ""


class ClockTie(Message, frozen=True, kw_only=True, omit_defaults=True, tag="clock"):
    """Ties `t` to the wall clock; one every 30 s, so a step of the wall clock can be seen."""

    wall: str


class Checkpoint(Message, frozen=True, kw_only=True, omit_defaults=True, tag="checkpoint"):
    """Running SHA-256, as in `session.end`, every 10 s while there is something new."""

    sha256: str
    lines: int


class Segment(Message, frozen=True, kw_only=True, omit_defaults=True, tag="segment"):
    """First line of a file in which the log goes on, and last line of one that was left; written by
    the recorder itself. It has no `seq`, because it belongs to the file and not to the session's
    course.

    `log` is the name all files of the session share, `number` counts its segments from 1,
    `previous` is the file before (relative to this one) and `reason` why it was left; with `copied`
    that file was deleted, and this one has all that was in it. In a last line `next_file` is where
    the log goes on. `dropped` and `dropped_samples` count the lines that no file holds.
    """

    log: str
    session: str
    number: int
    previous: str = ""
    copied: bool = False
    next_file: str = ""
    reason: str = ""
    dropped: int = 0
    dropped_samples: int = 0


class RecorderState(Message, frozen=True, kw_only=True, omit_defaults=True, tag="recorder.state"):
    """How well the log keeps up. `level` is ok, warn (lag >= 250 ms), alarm (>= 1 s) or failed."""

    level: str
    lag_us: int
    path: str
    detail: str = ""
    remedy: str = ""


class Notice(RestrictedMessage, frozen=True, kw_only=True, omit_defaults=True, tag="notice"):
    """A sentence for the wizard. `level`: info, warning or error; `driver`: whose it is."""

    level: str
    text: str
    remedy: str = ""
    driver: str = ""


# -- sensors ----------------------------------------------------------------------------------


class Reading(Message, frozen=True, kw_only=True, omit_defaults=True, tag="sample"):
    """One value of one sensor.

    `sensor` names the quantity: distance (m), loudness (RMS, 0..1 of full scale), presence (0/1),
    gaze (0/1), identity (in `text`), direction (degrees), `joint.<name>` and `setpoint.<name>`
    (degrees). A missing or non-finite value is null, and `bad` names the field. `raw` is what the
    device said, in its own unit. `text` holds what is not a number (an identity).
    """

    sensor: str
    value: float | None
    text: str = ""
    driver: str = ""
    unit: str = ""
    raw: float | None = None
    bad: list[str] = msgspec.field(default_factory=list)


class SensorChanged(Message, frozen=True, kw_only=True, omit_defaults=True, tag="sensor.changed"):
    """A sensor's state, not its value, moved: ok, stale, silent, speaking, quiet ..."""

    sensor: str
    state: str
    was: str = ""
    why: str = ""


class ModeChanged(Message, frozen=True, kw_only=True, omit_defaults=True, tag="mode.changed"):
    """The robot's mode (normal, demo ...) changed."""

    driver: str
    was: str
    now: str
    why: str = ""


#: Every message that may stand in a log or on the stream.
AnyMessage = (
    SessionStart
    | SessionChanged
    | SessionEnd
    | ClockTie
    | Checkpoint
    | Segment
    | RecorderState
    | Notice
    | ActionRequested
    | ActionDone
    | ActionFailed
    | ActionStopped
    | ActionSuperseded
    | ActionRefused
    | ActionsFilled
    | Command
    | Dispatched
    | Progress
    | Done
    | Failed
    | TimedOut
    | Refused
    | Stopped
    | Superseded
    | StopPressed
    | StopConfirmed
    | StopReleased
    | DriverConnecting
    | DriverConnected
    | DriverLost
    | DriverFaulted
    | LaneFaulted
    | LaneRecovered
    | Reading
    | SensorChanged
    | EngagementAdopted
    | EngagementChanged
    | EngagementShown
    | SpeechStarted
    | SpeechEnded
    | SpeechText
    | VisitorChanged
    | ModeChanged
    | FaceShown
    | BodyChanged
    | ControlsMoved
    | SettingsShown
    | Marker
    | Note
    | Mistake
    | ScriptMoved
    | PhaseChanged
    | PanelLocked
    | ProfileChanged
    | ExperimentReloaded
    | ConsoleAttached
    | ConsoleLost
    | StudyMessage
)


def reading(
    sensor: str,
    value: float | None,
    *,
    text: str = "",
    driver: str = "",
    unit: str = "",
    raw: float | None = None,
) -> Reading:
    """A `Reading` whose non-finite numbers have become null and are named in `bad`."""
    bad = []
    if value is not None and not math.isfinite(value):
        value = None
        bad.append("value")
    if raw is not None and not math.isfinite(raw):
        raw = None
        bad.append("raw")
    return Reading(
        sensor=sensor, value=value, text=text, driver=driver, unit=unit, raw=raw, bad=bad
    )
