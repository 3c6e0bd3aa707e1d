"""The contract between the bus and whatever moves, speaks or senses.

A driver is a subclass of `Driver`, or of `PassiveDriver` if nothing that it does needs a stop. It
is made once a session, opened, asked to perform, and closed; everything it finds out goes through
its `DriverContext`. `drivers/README.md` builds one step by step, `woz_tui.testing` tests it.
"""

from __future__ import annotations

import abc
import enum
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Literal, NamedTuple, Protocol

import msgspec

from woz_tui.drivers.feeds import Feed
from woz_tui.drivers.fields import Range
from woz_tui.protocol.action_messages import FACE_CONSENT_VERB, Evidence
from woz_tui.protocol.markup import for_voice
from woz_tui.protocol.messages import SPEECH_SENSOR, Json, Shown, Speech
from woz_tui.system.clock import Clock

#: An argument's type on the wire: text, number, whole, flag, choice, file, seconds, joints
#: (a mapping joint name -> degrees) or poses (a list of `{joints: ..., seconds: ...}`).
KINDS = ("text", "number", "whole", "flag", "choice", "file", "seconds", "joints", "poses")

#: Among a driver's sensors: it finds out by itself when somebody speaks, and tells of it with
#: `SpeechStarted` and `SpeechEnded`, so that nobody has to guess from its loudness.
SPEECH = SPEECH_SENSOR
#: Among a driver's sensors beside `SPEECH`: it tells what was said, too, with `SpeechText`.
SPEECH_TEXT = "speech.text"
#: Drivers that offer this verb give names to faces; its main argument is the name. The session
#: refuses it before a consent of that name.
LEARN_FACE = "learn_face"
#: The verb by which such a driver is told that somebody consents, or does not: `name`, `given`.
#: Without it nobody can consent, and the driver learns no face. If it is withdrawn the driver
#: deletes what it keeps of that person, also what it is learning at that moment.
FACE_CONSENT = FACE_CONSENT_VERB
#: The verb with which a head looks into a direction: `yaw`, `pitch` in degrees.
GAZE = "gaze"
#: Among a driver's sensors: the direction from which a sound comes, in degrees.
DIRECTION = "direction"
#: Seconds that `rest` may take.
REST_WAIT_S = 10.0


class DriverError(Exception):
    """Something the wizard must know: what is wrong, and what to do about it."""

    def __init__(self, what: str, remedy: str = "") -> None:
        super().__init__(what)
        self.what = what
        self.remedy = remedy


class DeviceLostError(DriverError):
    """The hardware is not there (any more); the driver keeps looking for it by itself."""


class RejectedError(DriverError):
    """The command makes no sense to this driver: refused, nothing was sent."""


class Scope(enum.Enum):
    """What a stop reaches: everything, or what verbs with `drives` do."""

    ALL = "all"
    DRIVE = "drive"


@dataclass(frozen=True, slots=True)
class Argument:
    """One argument of a verb.

    `kind`: one of `KINDS`. `range`: limits of a number, both included; of a text, its longest
    length in characters. `hide`: gives a text back without what nobody may see of it, such as the
    password in an address. What it leaves is all that is recorded, told and given to the driver; an
    experiment file that holds more is refused. Applied twice it gives the same as once.
    """

    name: str
    kind: str
    summary: str = ""
    required: bool = False
    default: Json = None
    range: Range | None = None
    choices: tuple[str, ...] = ()
    hide: Callable[[str], str] | None = None


@dataclass(frozen=True, slots=True)
class Verb:
    """Something a driver can do.

    `arguments[0]` is the main one: `say: "Hello"` gives it directly. Commands in one `lane` run
    one after the other, those in different lanes together. `stream`: only the newest setpoint
    counts. The verb has a lane of its own beside `lane`: a newer command replaces the one that
    waits, the one that runs goes on. `drives`: it moves the robot through the room, or lets
    somebody talk through it, and must end when nobody watches. `limit_s`: seconds that it may take
    at most. `brief`: it is done at once, so that a burst of it may wait in its lane without anybody
    noticing.
    `waits`: it may be queued; else it is refused while its lane is busy. `arrives`: it moves
    something to a goal, and the log says when that is there (`motion.arrived`): when `perform`
    returns, unless the driver says that it goes on (`Job.goes_on`). `together`: its commands do not
    wait for each other. `evidence`: on what its end usually stands (`Evidence`): measured, reported
    or timed, which is what is assumed of a driver that says nothing; empty: it reaches no hardware.
    `markup`: what its main argument, a text to be spoken, may have of `protocol.markup.ABILITIES`;
    the rest is taken out before the driver gets it. None: every text is given as it is written.
    `needs_consent`: it has something remember the person whose name is the main argument, so that
    it is refused until they have consented (`FACE_CONSENT`); `learn_face` always does.
    `by_mood`: it has the arguments `emotion`, `intensity`, `valence`, `arousal` and `seed` of the
    common verb `utter`, and the session fills in what is missing before the command is recorded:
    the mood of its emotion, or of the robot's face; a seed of its own.
    """

    name: str
    summary: str
    arguments: tuple[Argument, ...] = ()
    lane: str = "main"
    stream: bool = False
    drives: bool = False
    limit_s: float = 30.0
    brief: bool = False
    waits: bool = True
    arrives: bool = False
    together: bool = False
    needs_consent: bool = False
    by_mood: bool = False
    evidence: Evidence | Literal[""] = "timed"
    markup: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        if self.name == LEARN_FACE:  # a driver that forgets to say so learns nobody either
            object.__setattr__(self, "needs_consent", True)

    def spoken(self, args: Mapping[str, Json]) -> Mapping[str, Json]:
        """`args` as the driver gets them: without the `markup` that its voice cannot do."""
        if self.markup is None or not self.arguments:
            return args
        text = args.get(name := self.arguments[0].name)
        return {**args, name: for_voice(text, self.markup)} if isinstance(text, str) else args


def gives_consent(verb: str, args: Mapping[str, Json]) -> bool:
    """Whether this command says that somebody consents, and does not withdraw it."""
    return verb == FACE_CONSENT and args.get("given") is not False


class Job(Protocol):
    """What a driver is given to perform: one command, and a way to report on it."""

    @property
    def command(self) -> str:
        """The command's id."""

    @property
    def verb(self) -> str:
        """Which verb."""

    @property
    def args(self) -> Mapping[str, Any]:
        """Checked arguments, defaults filled in: of the types that the verb's arguments have."""

    @property
    def source(self) -> str:
        """Who asked for it: see `source` in `messages.ActionRequested`; also `driver`."""

    def expects(self, seconds: float) -> None:
        """Say that it will take `seconds` more from now; the console counts down."""

    def goes_on(self) -> Callable[[str], None]:
        """Say that the motion goes on when `perform` returns, of a verb that `arrives`.

        Call what is returned once, from any thread: with an empty text when the motion has arrived,
        or with the reason why it will not. A stop and a lost device need not be told.
        """

    def mark(self, sort: str, text: str = "") -> None:
        """Tell of a point within the command, now; see `messages.CommandMark`. From any thread."""

    def evidence(self, kind: Evidence) -> None:
        """Say on what the end of this command stands, where it is not the verb's `evidence`.

        Call it before `perform` returns. Of a motion that goes on, say it again before it is told
        that it has arrived: then it is that of the arrival.
        """


class Health(enum.Enum):
    """How a driver is."""

    CONNECTING = "connecting"
    CONNECTED = "connected"
    LOST = "lost"
    FAULTED = "faulted"


@dataclass(frozen=True, slots=True)
class Ask:
    """What a driver asks of the session: for the hand on its knobs, or for a move with sounds.

    `what` is verb, action, key, stop, release, script, mark, cancel or halt; `name` the verb, the
    action, the key of the experiment's panels (`h`, `f13`), the mark. `cancel` cuts the last verb
    short that was asked for with the same `key`, `halt` ends whatever drives through the room;
    their `name` says why. `on` names a driver of the same robot. `source` and `key` go into the
    log: whose hand it was, and the control it lay on. `when_busy` (queue, replace, refuse; empty:
    queue) says what a verb does while another one of its lane is under way. `age_us`: how long ago
    the hand moved, where the driver knows it; too old, it is refused like a key press.
    """

    what: str
    name: str = ""
    args: Mapping[str, Json] = field(default_factory=dict)
    on: str = ""
    source: str = "driver"
    key: str = ""
    when_busy: str = ""
    age_us: int = 0


@dataclass(frozen=True, slots=True)
class HandInput:
    """What a hand does at a panel's controls, from a program that reads them (`woz hands`).

    Attributes:
        client: The connection it came over.
        values: All controls that are not at rest: a button 1, a trigger 0 to 1, a stick's axis -1
            (left, down) to 1. What is not named has been let go.
        device: What lies under the hand; empty: it was unplugged; None: as before.
        take_over: Whether the hand of another client loses the panel.
        age_us: How long ago the hand moved, at most.
        stale: Whether that is too long ago to move anything.
    """

    client: str
    values: Mapping[str, float] = field(default_factory=dict)
    device: str | None = None
    take_over: bool = False
    age_us: int = 0
    stale: bool = False


class DriverStatement(msgspec.Struct, frozen=True, tag_field="is"):
    """Something that a driver says of itself: see the method of `DriverContext` of each."""


class ReadingStatement(DriverStatement, frozen=True, tag="reading"):
    """`DriverContext.reading`."""

    sensor: str
    value: float | None
    text: str = ""
    unit: str = ""
    raw: float | None = None


class SensorStatement(DriverStatement, frozen=True, tag="sensor"):
    """`DriverContext.sensor`."""

    sensor: str
    state: str
    why: str = ""
    every: float = 0.0


class HealthStatement(DriverStatement, frozen=True, tag="health"):
    """`DriverContext.health`; `tells`: as of a notice."""

    health: Health
    detail: str = ""
    remedy: str = ""
    tells: tuple[str, ...] = ()


class ModeStatement(DriverStatement, frozen=True, tag="mode"):
    """`DriverContext.mode`."""

    mode: str
    why: str = ""


class UnableStatement(DriverStatement, frozen=True, tag="unable"):
    """`DriverContext.unable`."""

    verbs: tuple[str, ...]
    why: str = ""


class NoticeStatement(DriverStatement, frozen=True, tag="notice"):
    """`DriverContext.notice`."""

    level: str
    text: str
    remedy: str = ""
    tells: tuple[str, ...] = ()


class DriverContext(abc.ABC):
    """Everything a driver may tell. Safe to call from any thread."""

    @property
    @abc.abstractmethod
    def clock(self) -> Clock:
        """The session's clock."""

    @property
    @abc.abstractmethod
    def folder(self) -> Path:
        """The experiment file's folder: relative paths start there."""

    @property
    @abc.abstractmethod
    def media(self) -> Path:
        """The folder beside the log for files of this session, such as recorded speech.

        Whoever writes the first of them makes it. It moves with the log when a disk is full, so
        ask each time; `<media.name>/<file>` is what a message says.
        """

    @abc.abstractmethod
    def t(self, clock_us: int) -> int:
        """A time of `clock` in microseconds on the axis of the messages' `t`."""

    @abc.abstractmethod
    def publish(self, statement: DriverStatement | Shown | Speech) -> None:
        """Tell it. Drivers call the methods below."""

    def reading(
        self,
        sensor: str,
        value: float | None,
        *,
        text: str = "",
        unit: str = "",
        raw: float | None = None,
    ) -> None:
        """A sensor's value; non-finite numbers become null and are marked."""
        self.publish(ReadingStatement(sensor, value, text, unit, raw))

    def sensor(self, sensor: str, state: str, why: str = "", *, every: float = 0.0) -> None:
        """A sensor's state moved (ok, stale, silent, speaking, quiet ...).

        `every`: seconds from one reading to the next, where that is more than one: so that the
        last one does not look old meanwhile.
        """
        self.publish(SensorStatement(sensor, state, why, every))

    def health(self, health: Health, detail: str = "", remedy: str = "") -> None:
        """The driver's own state moved; saying the same again is free."""
        self.publish(HealthStatement(health, detail, remedy))

    def mode(self, mode: str, why: str = "") -> None:
        """The robot's mode (normal, demo ...) is now `mode`; saying the same again is free."""
        self.publish(ModeStatement(mode, why))

    def unable(self, verbs: Iterable[str], why: str = "") -> None:
        """The hardware is there and cannot carry these verbs out now: consoles grey what plays
        them. All such verbs at a time, none when it can again; saying the same again is free.
        """
        self.publish(UnableStatement(tuple(verbs), why))

    def notice(
        self, level: str, text: str, remedy: str = "", *, tells: tuple[str, ...] = ()
    ) -> None:
        """A sentence for the wizard; `level` is info, warning or error. `tells`: `request` if it
        quotes what was asked for, and each sensor whose values it tells (`loudness`): it is not
        shown to a wizard from whom that is kept.
        """
        self.publish(NoticeStatement(level, text, remedy, tells))

    def show(self, shown: Shown) -> None:
        """What there is to be seen now: a face, a body's settings, knobs. Say it on a change."""
        self.publish(shown)

    def tell(self, speech: Speech) -> None:
        """What somebody says: where it begins and ends, and its text. Never left out."""
        self.publish(speech)

    @abc.abstractmethod
    def feed(self, topic: str, of: str = "") -> Feed:
        """A latest value shared with other drivers of the same robot: your own feed `topic`, or
        that of the driver `of`.
        """

    @abc.abstractmethod
    def ask(self, ask: Ask, done: Callable[[bool, str], None] | None = None) -> None:
        """Ask the session, as the wizard's keys do. `done` is called in the event loop, once:
        whether it was carried out (or an action begun), and why not.
        """


@dataclass(frozen=True, slots=True)
class VoiceFound:
    """A voice: the program that has it, the name that `say` takes, its language."""

    engine: str
    name: str
    language: str = ""
    detail: str = ""


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of a preflight or of `woz doctor`; `level`: ok, info, warning or error."""

    level: str
    subject: str
    text: str
    remedy: str = ""


#: What is told of people's data (`Driver.people_data`): what leaves the computer of the session and
#: whither, what is kept, who decides what a robot says.
LEAVES, KEPT, DECIDES = "leaves", "kept", "decides"


#: Stands in a `Written` command for what only the session knows: a participant's code, the trial.
UNKNOWN = "\ufffc"


@dataclass(frozen=True, slots=True)
class Written:
    """A command as an experiment file has it, for `Driver.remarks`.

    `args`: those that are written, checked; variables are filled in, for each condition anew. For
    those that only the session knows each stands `UNKNOWN`: nothing is to be said of it. `folder`:
    the experiment file's, where relative paths start.
    """

    verb: str
    args: Mapping[str, Json]
    folder: Path


@dataclass(frozen=True, slots=True)
class Probe:
    """What `woz doctor` hands to a driver class: settings, and where relative paths start."""

    name: str
    settings: Any
    folder: Path = field(default_factory=Path)

    #: Drivers of the same robot at this computer, by the names by which settings call them.
    others: Mapping[str, OtherDriver] = field(default_factory=dict)


class OtherDriver(NamedTuple):
    """What a driver's examination may use of another driver: its class and its settings."""

    kind: type[Driver]
    settings: Any


class HeardSound(NamedTuple):
    """Some live sound: frames a second, and samples (S16_LE, one channel)."""

    rate: int
    pcm: bytes


@dataclass(frozen=True, slots=True)
class StopReport:
    """What a driver of several parts says of its stop: which of them confirmed, and which did not
    (`speech`, `motion` ...). With something missing the driver counts as not confirmed.
    """

    confirmed: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class DriverFacts:
    """What a lab wants to know before it chooses a robot, for `woz robots`.

    Attributes:
        robot: Whether it is a whole robot and not a part of one.
        needs: The hardware and programs that it needs.
        simulated: What stands in for the hardware, and how; empty: nothing does.
        stop: What confirms its stop; empty: nobody says, or it is a `PassiveDriver`.
        page: Its page in the source tree.
        example: The settings of the simulated one, as `woz new` writes them: `address: simulated`.
        shown: Which of `SHOWN` its tests show with a device (`testing.DriverTests`, which finds a
            word that they do not show).
    """

    robot: bool = False
    needs: str = ""
    simulated: str = ""
    stop: str = ""
    page: str = ""
    example: str = ""
    shown: tuple[str, ...] = ()


#: What tests with a device can show of a driver, by the words of `DriverFacts.shown`.
SHOWN = {
    "stop": "it stands still when its stop returns, and from then on",
    "loss": "it notices a pulled cable, also in the middle of a command",
    "return": "it finds its device again, and nothing moves by itself then",
    "errors": "an error of the device ends the command",
    "units": "numbers reach the device, or come from it, in metres and degrees",
}


@dataclass(frozen=True, slots=True)
class Forecast:
    """How a command would go, in seconds from its beginning; None: the driver does not know.

    `marks`: time, sort and text of each (see `messages.CommandMark`).
    """

    seconds: float | None = None
    marks: tuple[tuple[float, str, str], ...] | None = None


@dataclass(frozen=True, slots=True)
class Offer:
    """What a driver offers with its settings, as `woz check` reads it before anything is opened.

    Attributes:
        verbs: What it can do.
        sensors: Names of all readings and sensor states that it may publish.
        lacks: Verbs that it does not have, though people may expect them of it: each with why, or
            what to do. `woz check` says it where a file wants one.
        joints: Its joints with their ranges in degrees; None if nobody knows them beforehand.
            `woz check` finds poses outside of them, the console draws each between its limits.
        asks: What its settings have it ask of the session (`DriverContext.ask`): pairs of a
            setting's path and the request. `woz check` finds those that nobody could carry out.
        part: The part of the panels (`for:` in an experiment) whose wizard's hands lie on it;
            empty: everybody's.
        outline: What a console needs to draw it and never changes; empty: nothing.
            `docs/reference/protocol.md` has the keys.
    """

    verbs: tuple[Verb, ...] = ()
    sensors: tuple[str, ...] = ()
    lacks: Mapping[str, str] = field(default_factory=dict)
    joints: Mapping[str, Range] | None = None
    asks: tuple[tuple[str, Ask], ...] = ()
    part: str = ""
    outline: dict[str, Json] = field(default_factory=dict)


class Performer(Protocol):
    """The part of a driver that the bus knows. Both run in the event loop, each call in a task of
    its own.
    """

    #: Whether another program carries commands out: files of woz-tui itself are those of there.
    elsewhere: ClassVar[bool] = False

    @abc.abstractmethod
    async def perform(self, job: Job) -> Mapping[str, Json]:
        """Carry out one command; end when it has happened, and return what was really sent.

        One at a time in each lane. It is cancelled by the stop, by the time limit (`Verb.limit_s`)
        and by a command that replaces it: then make the hardware safe without waiting for it, and
        re-raise within 0.25 s; a lane that takes longer is faulted.

        Raises:
            RejectedError: The command makes no sense, whether the hardware is there or not; nothing
                was sent.
            DeviceLostError: The hardware is not there, or went away meanwhile.
            DriverError: It was tried and did not work.
        """

    @abc.abstractmethod
    async def stop(self, scope: Scope) -> StopReport | None:
        """Stand still, fall silent; return when it has really happened, within 0.5 s.

        Called at once, whatever else is under way; jobs are being cancelled at the same time. With
        `Scope.DRIVE`, while nobody watches, only what verbs with `drives` do ends: it stops driving
        through the room, and nobody talks through it live; what it says and plays itself goes on. A
        driver of one part returns nothing; one of several may report each. It may come before
        `open`: then nothing moves by itself, and no torque goes on, before `resume`.

        Raises:
            DriverError: It did not stop, or nobody knows.
        """


class FileTranscriber(Protocol):
    """Turns recorded speech into text, for `woz dictate`."""

    async def text_of(self, file: Path) -> str:
        """What is said in a WAV file; empty: nothing was understood. Raises `DriverError`."""

    async def close(self) -> None:
        """End it."""


class Driver(Performer):
    """One piece of hardware, or several behind one wire. Only `Settings`, `summary`, `perform` and
    `stop` are needed: everything else has a harmless default.

    `offer` and `remarks` are called without an instance, when a file is read: they depend on the
    settings alone and touch no hardware. The coroutines run in the event loop of the robot process,
    which all drivers share: they must not block it.
    """

    #: A frozen dataclass; its annotations (`drivers.fields`) are decoded from the robot file.
    Settings: ClassVar[type]
    #: What it is, in one line.
    summary: ClassVar[str]
    #: What `woz robots` tells of it beside its verbs and sensors.
    facts: ClassVar[DriverFacts] = DriverFacts()
    #: Whether it has to be at the computer of its hardware (`at:` in a robot file).
    needs_hardware: ClassVar[bool] = True

    def __init__(self, name: str, settings: Any, context: DriverContext) -> None:
        """Keep what it is made with; hardware is opened in `open`."""
        self.name = name
        self.settings = settings
        self.context = context

    # -- what it offers ----------------------------------------------------------------------------

    @classmethod
    def offer(cls, settings: Any) -> Offer:
        """What it can do with these settings (a head of three joints offers three)."""
        return Offer()

    @classmethod
    def remarks(cls, settings: Any, written: Written) -> Iterable[Finding]:
        """What is odd about a command of an experiment file: what `perform` would complain of, or
        what is probably not what was meant.

        Called for each command of its own when a file is read. It must not raise, write or wait; it
        may look at files. A finding's `subject` is the name of the argument that it is about. A
        `warning` lets the file pass, an `error` does not; others are not shown.
        """
        return ()

    @classmethod
    def people_data(cls, settings: Any) -> Iterable[tuple[str, str]]:
        """What becomes of what people say and show with these settings, as an ethics board asks:
        pairs of `LEAVES` or `KEPT` and a sentence. What the settings do not say is called that.
        """
        return ()

    @classmethod
    def transcriber(cls, settings: Any, folder: Path) -> FileTranscriber | None:
        """What turns recorded speech into text with these settings, apart from any session; None:
        nothing does. `folder`: where it works.
        """
        return None

    @classmethod
    async def voices(cls, probe: Probe) -> list[VoiceFound]:
        """`woz voices`: which voices its `say` may be given. Never raises."""
        return []

    @classmethod
    async def examine(cls, probe: Probe) -> list[Finding]:
        """`woz doctor`: look at the hardware without moving it. Never raises."""
        return []

    @classmethod
    async def hear(cls, probe: Probe, seconds: float) -> HeardSound | None:
        """`woz doctor`: so much of its live sound, without moving it, for a microphone that takes
        it. None: that can be had in a session alone. Raises `DriverError`.
        """
        return None

    # -- what happens in a session -----------------------------------------------------------------

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """How a command with these checked arguments would go if it came now, without moving or
        sounding. It may take its time. The default knows nothing.

        Raises:
            RejectedError: It would be rejected.
            DriverError: It cannot be found out.
        """
        return Forecast()

    async def open(self) -> None:
        """Begin to look for the hardware, once at the start; return at once. Missing hardware is no
        error: say so through `DriverContext.health` and keep looking. The default reports CONNECTED
        at once.
        """
        self.context.health(Health.CONNECTED)

    async def prepare(self, utterances: list[str]) -> None:
        """Make ready what will probably be said, so that it is heard at once at its key; a task of
        its own, cancelled when the list changes. For drivers that offer `say`.
        """

    async def prepare_say(self, utterances: list[Mapping[str, Json]]) -> None:
        """As `prepare`, with all arguments of each `say`, for drivers whose `say` has more of them
        than `text`. The default calls `prepare` with the texts.
        """
        await self.prepare(list(dict.fromkeys(str(args["text"]) for args in utterances)))

    async def resume(self) -> None:
        """The stop was released: whatever moves by itself (breathes, follows another driver) may
        move again. Return at once.
        """

    def reread(self, settings: Any, *, dry_run: bool) -> list[str]:
        """The experiment is read again: `settings` are those it has, but the files that they name
        may hold other things now.

        Return what is different, in words, and take it over unless `dry_run`. Called in a thread of
        its own, after everything was found to be right.
        """
        return []

    def take_hand(self, hand: HandInput) -> None:
        """A hand moved controls that lie in front of this driver. Return at once.

        Raises `RejectedError`, in a sentence, if this cannot be taken; then nothing of it counts.
        """
        raise RejectedError(f"{self.name} has no controls", "name a driver of the type hands")

    def lose_hand(self, client: str) -> None:
        """The connection `client` has ended, and with it whatever it held."""

    async def rest(self) -> None:
        """Take the safe pose in which the robot may be left alone. Cancelled by the stop, and after
        `REST_WAIT_S`.
        """

    async def close(self) -> None:
        """Let go of the hardware, once or more at the end: torque off, ports closed, tasks, threads
        and children ended. Nothing is published afterwards. Never raises.
        """


class PassiveDriver(Driver):
    """A driver that only senses or shows: nothing moves or sounds, so a stop has nothing to do, and
    nobody waits for its confirmation.
    """

    async def perform(self, job: Job) -> Mapping[str, Json]:
        """It offers no verbs. Raises `RejectedError`."""
        raise RejectedError(f"{self.name} cannot {job.verb}: {type(self).summary}")

    async def stop(self, scope: Scope) -> StopReport | None:
        """There is nothing to stop."""
        return None
