"""All messages of a session, for the log, the socket and replays.

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
    CommandMark,
    Dispatched,
    Done,
    End,
    Failed,
    FilledCall,
    MotionArrived,
    MotionInterrupted,
    Progress,
    Refused,
    StopConfirmed,
    Stopped,
    StopPressed,
    StopReleased,
    Superseded,
    TimedOut,
)
from woz_tui.protocol.envelope import Json, Message, RestrictedMessage
from woz_tui.protocol.sentence import Wording
from woz_tui.protocol.study_messages import (
    STUDY_MESSAGES,
    ActionScheduled,
    BreakEnded,
    BreakStarted,
    ConditionsAssigned,
    ExperimentFiles,
    PerceptionChanged,
    PreflightChecked,
    RerunEnded,
    RerunSent,
    RerunSkipped,
    RerunStarted,
    SessionPlan,
    TrialEnded,
    TrialStarted,
)

#: Names that are defined next door and belong to this module's readers.
__all__ = [
    "Ack",
    "ActionDone",
    "ActionEnd",
    "ActionFailed",
    "ActionRefused",
    "ActionRequested",
    "ActionScheduled",
    "ActionStopped",
    "ActionSuperseded",
    "ActionsFilled",
    "BreakEnded",
    "BreakStarted",
    "Command",
    "CommandMark",
    "ConditionsAssigned",
    "Dispatched",
    "Done",
    "End",
    "ExperimentFiles",
    "Failed",
    "FilledCall",
    "Json",
    "Message",
    "MotionArrived",
    "MotionInterrupted",
    "ParticipantWithdrawn",
    "PerceptionChanged",
    "PreflightChecked",
    "Progress",
    "Refused",
    "RerunEnded",
    "RerunSent",
    "RerunSkipped",
    "RerunStarted",
    "RestrictedMessage",
    "SessionPlan",
    "Speech",
    "StopConfirmed",
    "StopPressed",
    "StopReleased",
    "Stopped",
    "Superseded",
    "TimedOut",
    "TrialEnded",
    "TrialStarted",
]

FORMAT = "woz-session"
SCHEMA = 3


# -- the session ----------------------------------------------------------------------------


class SessionStart(Message, frozen=True, kw_only=True, tag="session.start"):
    """First line of a log: who, what, with which software, and how clock and calendar meet.

    `spill`: folders in which the log goes on if its own fails, best first; each as it is on that
    machine and, where that differs, as seen from the log's. `robot`: the robot that plays the
    experiment instead of the one that its file names: a name, or a file as seen from its folder.
    `redacted`: this is a copy (`woz export --to jsonl --redact-text`) without texts and dates.
    `file_sha256` is what `sha256sum` says of the experiment file; `experiment_sha256` covers it and
    its robot files, one behind the other.
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
    clock: dict[str, str | int]
    spill: list[str] = []
    robot: str = ""
    redacted: bool = False
    file_sha256: str = ""


class SessionChanged(Message, frozen=True, kw_only=True, tag="session.changed"):
    """Participant, condition or trial was set during the session; only what changed is there."""

    names_console = True
    participant: str | None = None
    condition: str | None = None
    trial: int | None = None
    console: str = ""


class ParticipantWithdrawn(Message, frozen=True, kw_only=True, tag="participant.withdrawn"):
    """Here lines of somebody who withdrew were taken out, when the session was long over: all
    numbers from this line's to `last_removed`, whose time was `removed_until`. `removed` counts the
    lines of actions among them, `removed_samples` the samples; `day` is the day (UTC) on which
    woz-tui `version` did it. Who it was is not said. `participant`, `condition` and `trial` hold
    from here on, as in `session.changed`.
    """

    last_removed: int
    removed: int
    removed_samples: int = 0
    removed_until: int = -1
    day: str
    version: str = ""
    participant: str | None = None
    condition: str | None = None
    trial: int | None = None


class SessionEnd(RestrictedMessage, frozen=True, kw_only=True, tag="session.end"):
    """Last line of a log. `sha256` covers every line of actions before it, each once and in the
    order of `seq`: in a session of one segment, every byte of the file.
    """

    reason: str
    sha256: str = ""


class ClockTie(Message, frozen=True, kw_only=True, tag="clock"):
    """Ties `t` to the wall clock; one every 30 s, so a step of the wall clock can be seen."""

    wall: str


class Checkpoint(Message, frozen=True, kw_only=True, tag="checkpoint"):
    """Running SHA-256, as in `session.end`, every 10 s while there is something new."""

    sha256: str
    lines: int


class Segment(Message, frozen=True, kw_only=True, tag="segment"):
    """First line of a file in which the log goes on, and last line of one that was left; written by
    the recorder itself. It has no `seq`, because it belongs to the file and not to the session's
    course.

    `log` is the name all files of the session share, `number` counts its segments from 1,
    `previous` is the file before (relative to this one) and `reason` why it was left; with `copied`
    that file was deleted, and this one has all that was in it. In a last line `next_file` is where
    the log goes on. `dropped` and `dropped_samples` count the lines that no file holds. With
    `unwritten_since` no folder took the log from that moment to this line, whose file has what was
    held in memory; the first file of a log has such a line behind that.
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
    unwritten_since: int = -1
    waived_at: int = -1


class RecorderState(Message, frozen=True, kw_only=True, tag="recorder.state"):
    """How well the log keeps up. `level` is ok, warn (lag >= 250 ms), alarm (>= 1 s) or failed: no
    folder takes it, and actions are refused unless the wizard has `waived` the record.
    """

    level: str
    lag_us: int
    path: str
    detail: str = ""
    remedy: str = ""
    waived: bool = False
    wording: dict[str, Wording] = {}


class RecordWaived(Message, frozen=True, kw_only=True, tag="record.waived"):
    """While no folder takes the log the wizard goes on without a record: from here on actions are
    not refused for it. It holds until a folder takes the log. `console`: whose wizard.
    """

    names_console = True
    console: str = ""


class Notice(RestrictedMessage, frozen=True, kw_only=True, tag="notice"):
    """A sentence for the wizard. `level`: info, warning or error; `driver`: whose it is; `wording`:
    code and values of `text` and `remedy`, where they can be worded in another language.
    """

    level: str
    text: str
    remedy: str = ""
    driver: str = ""
    wording: dict[str, Wording] = {}


# -- sensors ----------------------------------------------------------------------------------


class Reading(Message, frozen=True, kw_only=True, tag="sample"):
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
    bad: list[str] = []


class SensorChanged(Message, frozen=True, kw_only=True, tag="sensor.changed"):
    """A sensor's state, not its value, moved: ok, stale, silent, speaking, quiet ...

    `every_s`: from one of its readings to the next, where it is seldom by nature; 0: nobody
    said.
    """

    sensor: str
    state: str
    was: str = ""
    why: str = ""
    every_s: float = 0.0


class ModeChanged(Message, frozen=True, kw_only=True, tag="mode.changed"):
    """The robot's mode (normal, demo ...) changed."""

    driver: str
    was: str
    now: str
    why: str = ""


# -- drivers --------------------------------------------------------------------------------------


class DriverHealth(RestrictedMessage, frozen=True, kw_only=True):
    """How a driver is. Only the subclasses are sent."""

    driver: str
    detail: str = ""
    remedy: str = ""


class DriverConnecting(DriverHealth, frozen=True, kw_only=True, tag="driver.connecting"):
    """It is looking for its hardware."""


class DriverConnected(DriverHealth, frozen=True, kw_only=True, tag="driver.connected"):
    """It is ready; `detail` says with what (port, models found)."""


class DriverLost(DriverHealth, frozen=True, kw_only=True, tag="driver.lost"):
    """Its hardware went away; it looks for it by itself."""


class DriverFaulted(DriverHealth, frozen=True, kw_only=True, tag="driver.faulted"):
    """A part of it does not answer or reports an alarm; `detail` names the part."""


class VerbsUnable(Message, frozen=True, kw_only=True, tag="verbs.unable"):
    """Verbs that a driver's hardware cannot carry out at the moment, and why, though it is
    connected: a servo without torque takes no pose. All such verbs; none when it can again.
    """

    driver: str
    unable: list[str] = []
    why: str = ""


class LaneFaulted(Message, frozen=True, kw_only=True, tag="lane.faulted"):
    """A job outlived its limit and its cancelling; its lane takes nothing until it has ended."""

    driver: str
    lane: str
    command: str


class LaneRecovered(Message, frozen=True, kw_only=True, tag="lane.recovered"):
    """The job of a faulted lane has ended at last."""

    driver: str
    lane: str


# -- what a body or a panel shows -----------------------------------------------------------------


class Shown(Message, frozen=True, kw_only=True):
    """Something to be seen at `driver`. Only the subclasses are sent."""

    driver: str = ""


class FaceShown(Shown, frozen=True, kw_only=True, tag="face.shown"):
    """The face changed: exactly the picture that the device gets.

    `rows` are the matrix's rows from the top, blank between them, each in hexadecimal with the
    leftmost light as its highest bit; `width` lights a row. `brightness` is 0..1.
    """

    width: int
    rows: str
    emotion: str
    intensity: float
    brightness: float = 1.0


class BodyChanged(Shown, frozen=True, kw_only=True, tag="body.changed"):
    """What a body is doing and how it does it; `values` has all of its settings and states."""

    values: dict[str, Json]


class ControlsMoved(Shown, frozen=True, kw_only=True, tag="controls.moved"):
    """Knobs, sliders and buttons of a panel: name -> 0..127, only those that moved.

    `waiting` names all controls that do not count yet, because the robot's value is another than
    the hand's (soft take-over); `targets` tells where some of them begin to count, 0..127. `lit`
    names all buttons whose light is on.
    """

    values: dict[str, int]
    waiting: list[str] = []
    targets: dict[str, int] = {}
    lit: list[str] = []


class SettingsShown(Shown, frozen=True, kw_only=True, tag="settings.shown"):
    """A robot's settings as it has them now, read back from it; said on a change.

    `values` has all of them by name; `wanted` what was asked for, of those that are otherwise (the
    robot changed them by itself, or has not done so yet); `conflicts` sentences about settings that
    work against each other.
    """

    values: dict[str, Json]
    wanted: dict[str, Json] = {}
    conflicts: list[str] = []


class AddressedChanged(Shown, frozen=True, kw_only=True, tag="addressed.changed"):
    """Of several people before a camera somebody else is addressed: whose signs count.

    `face` is the number of the face, null while nobody is; `chosen` by rule or by hand.
    """

    face: int | None = None
    chosen: str = "rule"


# -- the visitor ----------------------------------------------------------------------------------


class EngagementChanged(Message, frozen=True, kw_only=True, tag="engagement.changed"):
    """The engagement machine moved; `why` gives the reason in words, `wording` their code.

    `verdicts`: presence, gaze, distance (near) as 0, 1 or null, identity as text. `visitor` is the
    code of whoever is known. `forced`: the wizard did it, or a verdict it rests on is the wizard's.
    """

    was: str
    now: str
    outcome: str
    why: str
    verdicts: dict[str, Json]
    visitor: str = ""
    forced: bool = False
    wording: dict[str, Wording] = {}


class EngagementAdopted(Message, frozen=True, kw_only=True, tag="engagement.settings"):
    """The model goes by these settings from here on: all that the experiment's section says, with
    the defaults, but without the path `visitors`. Told when the session begins and when a reload
    changes them; an empty object: the section is gone, and the model with it.
    """

    settings: dict[str, Json]


class SignShown(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A sign of the visitor: what was sensed last, and what the filter makes of it.

    `raw` is the last sample (0/1, metres), `raw_name` an identity. `verdict` is 0, 1 or null (no
    verdict yet), `name` that of an identity. `count` of `places` samples speak for it, `needed` of
    them suffice; a joint filter has places 100 and counts per cent. `forced`: it is the wizard's.
    """

    raw: float | None = None
    raw_name: str = ""
    verdict: int | None = None
    name: str = ""
    count: int = 0
    needed: int = 0
    places: int = 0
    filter: str = ""
    stale: bool = False
    forced: bool = False


class EngagementShown(Message, frozen=True, kw_only=True, tag="engagement.shown"):
    """The model as it stands; told when something of it changes, at most some times a second.

    `since` and `waits_since` are times `t` in microseconds: when the state was entered, and since
    when the visitor waits for an answer (-1: nobody does). `trail` has the last states, oldest
    first, the present one at its end. `run` is run, hold or off; `next` is where a held machine
    would go.
    `uses` names the signs of the condition. `attempt` counts a handshake's questions.
    """

    state: str
    since: int
    trail: list[str]
    signs: dict[str, SignShown]
    run: str
    uses: list[str]
    social_distance: float
    engaged: bool
    next: str = ""
    waits_since: int = -1
    visitor: str = ""
    attempt: int = 0
    attention: str = ""


class SpeechStarted(Message, frozen=True, kw_only=True, tag="speech.started"):
    """Somebody speaks. `segment` counts from 1; `began` is where it begins, pre-roll included, in
    microseconds on the axis of `t`. `own`: it is the robot's own voice out of its loudspeaker, and
    no visitor's (None: nobody has judged); `overlap`: a visitor's, who spoke into the robot's
    sentence.
    """

    driver: str
    segment: int
    began: int
    own: bool | None = None
    overlap: bool = False


class SpeechEnded(Message, frozen=True, kw_only=True, tag="speech.ended"):
    """They have stopped. `began` and `ended` in microseconds on the axis of `t`, pre-roll and
    trailing silence included; `file` is relative to the log's folder (empty: nothing was kept, and
    `detail` says why where that was not wanted). `loudest` is an RMS, 0..1 of full scale. `own` and
    `overlap` as in `speech.started`.
    """

    driver: str
    segment: int
    began: int
    ended: int
    file: str = ""
    loudest: float | None = None
    detail: str = ""
    own: bool | None = None
    overlap: bool = False


class SpokenWord(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A word of what somebody says: when, in microseconds on the axis of `t`, and how sure the
    program is, 0 to 1.
    """

    text: str
    began: int
    ended: int
    confidence: float | None = None


class SpeechText(Message, frozen=True, kw_only=True, tag="speech.text"):
    """What a segment says, as a program understood it. An empty text means that nothing
    was understood, or that it failed: then `detail` says why. `took_us`: from the end of speech.
    `words`, `confidence` (0 to 1) and `language` are there if the program tells them. `own` and
    `overlap` as in `speech.started`, by the words. Of texts so far, which are shown and not kept:
    how many there were (`partials`), how many of them took back a word of the one before
    (`revised`), and how long after the speech began the first came (`first_us`).
    """

    driver: str
    segment: int
    text: str
    took_us: int = 0
    detail: str = ""
    words: list[SpokenWord] = msgspec.field(default_factory=list)
    confidence: float | None = None
    own: bool | None = None
    overlap: bool = False
    language: str = ""
    partials: int = 0
    revised: int = 0
    first_us: int | None = None


#: The sensor of a driver that finds out by itself when somebody speaks.
SPEECH_SENSOR = "speech"
#: What such a driver, which cuts speech into segments, tells of them.
Speech = SpeechStarted | SpeechEnded | SpeechText


class VisitorChanged(Message, frozen=True, kw_only=True, tag="visitor.changed"):
    """The store of visitors changed. `what`: met, learnt, profile, renamed (then `was` is the old
    code) or forgotten. `about` has what is known of them (age_group, address), nothing else.
    """

    visitor: str
    what: str
    was: str = ""
    about: dict[str, str] = {}


# -- the wizard and their consoles ----------------------------------------------------------------


#: Sources of markers that no human set: they are no cues.
AUTOMATIC_MARKERS = frozenset({"action", "preflight", "lsl"})


class Marker(RestrictedMessage, frozen=True, kw_only=True, tag="marker"):
    """A moment worth finding again. `at`: the moment itself on the axis of `t`, where a program
    that measured it says so; -1: this line's.
    """

    names_console = True
    text: str = ""
    at: int = -1
    source: str = msgspec.field(default_factory=lambda: "key")
    console: str = ""

    @property
    def moment(self) -> int:
        """The moment that it marks; a program cannot have measured a later one than its line's."""
        return min(self.at, self.t) if self.at >= 0 else self.t


class Note(RestrictedMessage, frozen=True, kw_only=True, tag="note"):
    """A sentence that a wizard, a watcher or a program typed."""

    names_console = True
    text: str
    console: str = ""


class Mistake(RestrictedMessage, frozen=True, kw_only=True, tag="mistake"):
    """The wizard says that the run `run` of `action` was a mistake."""

    names_console = True
    run: str
    action: str = ""
    text: str = ""
    console: str = ""


class PanelLocked(Message, frozen=True, kw_only=True, tag="panel.locked"):
    """A panel was locked or unlocked while running; `source` is phase where that did it."""

    names_console = True
    panel: str
    locked: bool
    source: str = msgspec.field(default_factory=str)
    console: str = ""


class ExperimentReloaded(Message, frozen=True, kw_only=True, tag="experiment.reloaded"):
    """The experiment file was read again; `changes` lists the differences in words, `telling` those
    of them that may tell which condition is which.
    """

    experiment_sha256: str
    changes: list[str]
    telling: list[str] = []
    file_sha256: str = ""


class ConsoleAttached(Message, frozen=True, kw_only=True, tag="console.attached"):
    """A console or program connected. `role`: wizard, watcher, program or participant; `name`: how
    it calls itself (a program, or a client at which nobody sits). `sees` is `all` for a program
    that gets what is kept from the wizard. `via`: the name of the access file with which it came
    from another machine. `part`: which a wizard plays of those that the experiment has, or a
    watcher would. `line`: what stands between a console and its terminal (tmux, screen or mosh;
    empty: nothing that it knows of); `driving`: whether a wizard's keys drive while they are
    `held`, or as far as one press says (`pressed`).
    """

    console: str
    role: str
    name: str = ""
    sees: str = ""
    via: str = ""
    part: str = ""
    line: str = ""
    driving: str = ""


class ConsoleLost(Message, frozen=True, kw_only=True, tag="console.lost"):
    """It left (`why`: left) or died (closed, silent). `part`: which the wizard played."""

    console: str
    role: str
    why: str
    part: str = ""


class ListenerJoined(Message, frozen=True, kw_only=True, tag="listener.joined"):
    """The client `console` hears the microphone of `driver` live from now on."""

    console: str
    driver: str


class ListenerLeft(Message, frozen=True, kw_only=True, tag="listener.left"):
    """It has heard it for `duration_us`; of that `lost_us` were dropped, so as not to be late."""

    console: str
    driver: str
    duration_us: int
    lost_us: int = 0


class ProcessStalled(Message, frozen=True, kw_only=True, tag="process.stalled"):
    """The robot process stood still for `duration_us`, and is over it: meanwhile no key, stop or
    reading counted. `cause`: blocked (by the code of `driver`, in its `call` if it is in one, at
    `place`; without a driver by the process's own), starved (no processor was free for it) or
    stopped (from outside, as by a signal).
    """

    duration_us: int
    driver: str = ""
    call: str = ""
    place: str = ""
    cause: str = msgspec.field(default_factory=lambda: "blocked")


#: Every message that may stand in a log or on the stream.
MESSAGES: tuple[type[Message], ...] = (
    SessionStart,
    SessionChanged,
    ParticipantWithdrawn,
    SessionEnd,
    ClockTie,
    Checkpoint,
    Segment,
    RecorderState,
    RecordWaived,
    Notice,
    ActionRequested,
    ActionDone,
    ActionFailed,
    ActionStopped,
    ActionSuperseded,
    ActionRefused,
    ActionsFilled,
    Command,
    Dispatched,
    Progress,
    Done,
    Failed,
    TimedOut,
    Refused,
    Stopped,
    Superseded,
    MotionArrived,
    MotionInterrupted,
    CommandMark,
    StopPressed,
    StopConfirmed,
    StopReleased,
    DriverConnecting,
    DriverConnected,
    DriverLost,
    DriverFaulted,
    LaneFaulted,
    LaneRecovered,
    Reading,
    SensorChanged,
    EngagementAdopted,
    EngagementChanged,
    EngagementShown,
    SpeechStarted,
    SpeechEnded,
    SpeechText,
    VisitorChanged,
    ModeChanged,
    VerbsUnable,
    FaceShown,
    BodyChanged,
    ControlsMoved,
    SettingsShown,
    AddressedChanged,
    Marker,
    Note,
    Mistake,
    PanelLocked,
    ExperimentReloaded,
    ConsoleAttached,
    ConsoleLost,
    ListenerJoined,
    ListenerLeft,
    ProcessStalled,
    *STUDY_MESSAGES,
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
