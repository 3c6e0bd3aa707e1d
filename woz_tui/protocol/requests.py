"""What a console or any other program may ask of the robot process, and the answers.

Requests travel from the client to the host, one JSON object a line; `ref` is a number the client
chooses, repeated in the `reply`. Unknown fields are refused, so that a misspelt one is noticed.
"""

from __future__ import annotations

from typing import ClassVar, Literal, Protocol

import msgspec

from woz_tui.protocol.camera_pictures import PictureFormat, PictureShown
from woz_tui.protocol.envelope import Answer, Json
from woz_tui.protocol.live_sound import SoundHeard
from woz_tui.protocol.panels import ActionView, PanelView, PhaseView
from woz_tui.protocol.sentence import Wording
from woz_tui.protocol.welcome import (
    Allowance,
    ModelLimits,
    SlotView,
    StudySettings,
    WelcomeSettings,
)

#: The version of the protocol. Whoever says another one is refused.
PROTOCOL = 2


#: What becomes of a command whose lane is occupied; empty: what the experiment says.
WhenBusy = Literal["", "queue", "replace", "refuse"]


class Request(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    omit_defaults=True,
    forbid_unknown_fields=True,
    tag_field="kind",
):
    """What all requests carry.

    `sent_us`: CLOCK_BOOTTIME in microseconds when it was sent, from clients with the `boot_id` of
    the welcome; 0: unknown.
    """

    #: Whether its `source` says what of a console a person used; of a program it is `program`.
    sourced: ClassVar[bool] = False
    #: Whether it is an `AgedRequest`.
    aged: ClassVar[bool] = False
    #: Whether it plays something, so that the reply to a refusal names what is in the log.
    plays: ClassVar[bool] = False
    #: Its field that names a condition, or several; a blind wizard's has labels.
    conditions_in: ClassVar[str] = ""
    ref: int = 0
    sent_us: int = 0


class AgedRequest(Protocol):
    """A request that says how old the press behind it is already, and whether it is too old."""

    @property
    def age_us(self) -> int:
        """In microseconds."""

    @property
    def stale(self) -> bool:
        """Whether it counts as too old, whatever its age."""


class Hello(Request, frozen=True, kw_only=True, tag="hello"):
    """First line of a client. `role`: wizard (one at a time of each part), watcher, program, or
    participant, who may do nothing but answer questionnaires (and stop). `part`: which the wizard
    plays of those that the experiment's panels name; a watcher, which it would take over.

    A wizard must send a `beat` at least every second; when three seconds pass without one, driving
    stops. `stream`: everything, actions (no samples) or nothing. While a wizard is attached a
    second one of the same part becomes a watcher, unless it says `take_over`: then the first one
    does. `sees`: a program sees `all`, also what is kept from the wizard, unless it says `wizard`.
    `protocol`: the version that the client speaks, if it is not 2: such a one is refused.
    `via`: set for clients from other machines, by the process that has examined their certificate.
    `line`: what stands between a console and its terminal and answers in the terminal's place
    (tmux, screen or mosh): there a lost line is seen late or never, and keys drive while they are
    held. `unattended`: nobody sits at this client, as with a server of pages, so that it does not
    keep up a session that everybody has left (`abandon_after`).
    """

    role: str
    name: str = ""
    line: Literal["", "tmux", "screen", "mosh"] = ""
    protocol: int = PROTOCOL
    stream: str = "everything"
    take_over: bool = False
    sees: Literal["", "all", "wizard"] = ""
    via: str = ""
    part: str = ""
    unattended: bool = False


class AskAction(Request, frozen=True, kw_only=True, tag="action"):
    """Play an action of the experiment by name.

    `key` is the chord that was pressed, if one was. `age_us`: how old the press may be already.
    `stale`: the console decided not to play it; it is logged as refused. `at`: the moment on the
    axis of `t` at which it is to begin, in microseconds (0: now); one that has passed is refused.

    `slots`: what is to stand in the slots of its sentences, by name; where one is empty that is not
    kept, the reply `needs` it. `slot_sources`: where a wizard has it from (typed, offered, heard),
    `slots_took_us`: how long that took.
    """

    sourced = True
    aged = True
    plays = True
    action: str
    source: str = "program"
    key: str = ""
    age_us: int = 0
    stale: bool = False
    when_busy: WhenBusy = ""
    at: int = 0
    slots: dict[str, str] = {}
    slot_sources: dict[str, str] = {}
    slots_took_us: int = 0


class AskVerb(Request, frozen=True, kw_only=True, tag="verb"):
    """Send one verb with its arguments; `on` names the driver where several offer it.

    Variables in braces (`{participant}`) are filled in, in arguments that are texts.

    `key`, `age_us`, `stale` and `at` as for an action.
    """

    sourced = True
    aged = True
    plays = True
    verb: str
    args: dict[str, Json] = {}
    on: str = ""
    source: str = "program"
    key: str = ""
    age_us: int = 0
    stale: bool = False
    when_busy: WhenBusy = ""
    at: int = 0


class AskLetGo(Request, frozen=True, kw_only=True, tag="let_go"):
    """The key `key` is up, from a console whose terminal says so: what it drove ends. Elsewhere it
    ends when no further press of the key has come for a moment.
    """

    key: str


class AskControls(Request, frozen=True, kw_only=True, tag="controls"):
    """What a hand does at the controls of the panel `panel`, a driver of the type `hands`.

    `values`: all controls that are not at rest, a button 1, a trigger 0 to 1, a stick's axis -1
    (left, down) to 1; what is not named has been let go. While anything is held it has to be said
    again within the panel's `hold` (seconds, in its outline), or counts as let go.
    `device`: what lies under the hand; empty: it was unplugged; null: as before. `take_over`: the
    hand of another client loses the panel.

    `pulse` is `t` of the last `pulse` or `welcome` that the client had when the hand moved, and
    `since_us` the microseconds from then to the movement: with both the host knows how old it is
    at most, also where the clocks are two.
    """

    panel: str
    values: dict[str, float] = {}
    device: str | None = None
    take_over: bool = False
    pulse: int = 0
    since_us: int = 0


class AskStop(Request, frozen=True, kw_only=True, tag="stop"):
    """Stop everything, now."""

    source: str = "program"


class AskRelease(Request, frozen=True, kw_only=True, tag="release"):
    """Release the stop. `missing`: drivers of which whoever asks knows that they have not confirmed
    it. It is refused, by name, while there are others.
    """

    sourced = True
    source: str = "program"
    missing: list[str] = []


class AskCancel(Request, frozen=True, kw_only=True, tag="cancel"):
    """Cut one running or queued action short. Without a `run`: withdraw this client's request with
    the number `asked`, if it still waits for somebody who approves it.
    """

    run: str = ""
    asked: int = 0


class AskEmptyQueue(Request, frozen=True, kw_only=True, tag="empty-queue"):
    """End everything that waits in a queue; what runs goes on, and nothing is stopped."""


class AskTakeOver(Request, frozen=True, kw_only=True, tag="take-over"):
    """A console that watches plays its part from now on; refused while another one plays that part
    and responds.
    """


class AskAbout(Request, frozen=True, kw_only=True, tag="about"):
    """Which session is this? It needs no hello, and the log does not tell who asked. The reply's
    `data` has `session`, `title` and `participant`.
    """


class AskDescribe(Request, frozen=True, kw_only=True, tag="describe"):
    """What can be asked for? The reply's `data` is a `description.Description`."""


class AskPredict(Request, frozen=True, kw_only=True, tag="predict"):
    """How long would it take, and when would what happen? Nothing moves. An action, or a verb with
    its arguments. The reply's `data` is a `description.Prediction`.
    """

    action: str = ""
    verb: str = ""
    args: dict[str, Json] = {}
    on: str = ""


class AskSet(Request, frozen=True, kw_only=True, tag="set"):
    """Set the participant, the condition or the trial."""

    conditions_in = "condition"
    participant: str | None = None
    condition: str | None = None
    trial: int | None = None


class AskMarker(Request, frozen=True, kw_only=True, tag="marker"):
    """Put a marker into the log. `at`: the moment that it marks, in microseconds on the axis of
    `t`, if that was before the request; -1: now.
    """

    text: str = ""
    at: int = -1


class AskNote(Request, frozen=True, kw_only=True, tag="note"):
    """Put a note into the log."""

    text: str


class AskMistake(Request, frozen=True, kw_only=True, tag="mistake"):
    """Label a run as a mistake; an empty `run` means what a hand asked for and was heard or seen
    last: nothing that waits or was refused.
    """

    run: str = ""
    text: str = ""


class AskLock(Request, frozen=True, kw_only=True, tag="lock"):
    """Lock or unlock a panel."""

    panel: str
    locked: bool


class AskReload(Request, frozen=True, kw_only=True, tag="reload"):
    """Read the experiment file again. `dry_run` only tells the differences or errors."""

    dry_run: bool = False


class AskKeepTyped(Request, frozen=True, kw_only=True, tag="keep-typed"):
    """Write the sentences that were typed into a copy of the experiment file, as the panel `Typed`.

    `dry_run` only shows it. The reply's `data` has `sentences`: how many, `file`: the copy, `diff`:
    the lines that come in, and `written`. No sentences: there is nothing new since `file`.
    """

    dry_run: bool = False


class AskPreflight(Request, frozen=True, kw_only=True, tag="preflight"):
    """Run the robot side's checks; the reply's `data` lists them."""


class AskUnrecorded(Request, frozen=True, kw_only=True, tag="unrecorded"):
    """Go on without a record while no folder takes the log; only a wizard may say so."""


class AskEnd(Request, frozen=True, kw_only=True, tag="end"):
    """End the session: rest pose, drivers closed, log finished, process gone."""

    reason: str = "wizard"


class Beat(Request, frozen=True, kw_only=True, tag="beat"):
    """The wizard's console lives, and so does the line to its terminal if `line_ok`."""

    line_ok: bool = True


class AskCheck(Request, frozen=True, kw_only=True, tag="check"):
    """Tick an item of the preflight list that only a human can see to, or take the tick away."""

    check: str
    ok: bool = True
    text: str = ""


class AskReplay(Request, frozen=True, kw_only=True, tag="replay"):
    """Move through a log that is being replayed; a robot process refuses it.

    `pause` stands still, or goes on; `hold` stands still and replies whether it played (`plays`).
    `seek` goes `by_s` seconds on or back, `go` to a time (`12:34`, `754.2`) or to the marker with
    the text `to`.
    """

    what: Literal["pause", "hold", "step", "faster", "slower", "seek", "go"]
    by_s: float = 0.0
    to: str = ""


class AskPicture(Request, frozen=True, kw_only=True, tag="picture"):
    """The newest picture of the camera of `driver` (empty: of the first one) that is not number
    `after`, in at most `width` x `height` pixels; the answer is a `camera_pictures.PictureShown`.
    """

    driver: str = ""
    width: int = 320
    height: int = 240
    format: PictureFormat = "rgb"
    after: int = 0
    rate: float = 5.0


class AskSound(Request, frozen=True, kw_only=True, tag="sound"):
    """The newest sound of the microphone of `driver` (empty: of the first one), after frame `after`
    of it; the answer is a `live_sound.SoundHeard`. Who is far away asks for several pieces at once,
    up to 32; an `after` of -1 means what follows the piece before. From the first to the last of
    them the log says that somebody listens.
    """

    driver: str = ""
    after: int = 0


class AskTalk(Request, frozen=True, kw_only=True, tag="talk"):
    """Somebody's voice for the loudspeaker of `driver` (empty: of the first that takes one): `data`
    in base64, S16_LE, one channel, at `rate` frames a second. It is heard while `talk` is played.

    `age_us`: how long ago the first sample came to the sender; `lost_s`: what the sender has
    dropped so far, in seconds. The reply's `data` has `driver`, the `rate` that it takes, `on`:
    whether it is heard, and `late_s`: what has come too late to be heard so far, in seconds. An
    empty `data` only asks for that.
    """

    driver: str = ""
    rate: int = 0
    data: str = ""
    age_us: int = 0
    lost_s: float = 0.0


REQUESTS: tuple[type[Request], ...] = (
    Hello,
    AskAction,
    AskVerb,
    AskControls,
    AskLetGo,
    AskStop,
    AskRelease,
    AskCancel,
    AskEmptyQueue,
    AskTakeOver,
    AskAbout,
    AskDescribe,
    AskPredict,
    AskSet,
    AskMarker,
    AskNote,
    AskMistake,
    AskLock,
    AskReload,
    AskKeepTyped,
    AskPreflight,
    AskEnd,
    AskCheck,
    AskReplay,
    AskPicture,
    AskSound,
    AskTalk,
    AskUnrecorded,
    Beat,
)


class Reply(Answer, frozen=True, kw_only=True, tag="reply"):
    """The answer to one request; not part of the session's stream and never logged.

    `run` names what was started, or what was refused. `reason` says why not, `hint` what would
    help, and `command` which of the console's own keys (its id). `needs`: what has to be given with
    the request (slots); `wording`: code and values of `reason`, `hint` and lines of `data`
    (`data.0`), where they can be worded in another language. `data` carries what the request asked
    for. `ended`: the kind of the message with which the run has ended already, so that nobody waits
    for it. `recorded`: whether every line so far was given to the kernel, so that it is in the log
    whatever becomes of the robot process.
    """

    ref: int
    ok: bool
    reason: str = ""
    hint: str = ""
    command: str = ""
    needs: list[str] = []
    wording: dict[str, Wording] = {}
    run: str = ""
    data: Json = None
    ended: str = ""
    recorded: bool = True


class Welcome(Answer, frozen=True, kw_only=True, tag="welcome"):
    """First line to a client that said hello: the whole state, so any console can begin here.

    `state` are messages of the stream that still hold (session start and changes, health of each
    driver, stop if pressed, commands and actions not yet ended, last reading of each sensor,
    recorder state, position of each script, phase, locks); a client treats them like any other.
    `recent` is the tail of the log, oldest first, for the console's list. `seq` is the last one
    contained.
    `settings`: `stale_after`, `dead_man` and `abandon_after` in seconds, `driving` (whether keys of
    this console drive while they are `held`, or as far as one press says, `pressed`),
    `participant_pattern`, and `joints`: joint -> [lowest, highest angle] in degrees, for those
    whose driver tells them, `outlines`: driver -> what it looks like (see
    `docs/reference/protocol.md`), `moves`: driver -> all names that its verb `play` takes, where
    its class tells them and its outline does not, `values`: variable -> its value at this moment,
    `steps`: how far one press of an arrow goes (`head`, `hip`, `turn` in degrees, `drive` in m),
    `lanes`: driver -> verb -> the lane in which it is queued, `repairs`: moves that save a
    dialogue, actions of their own, `profiles`: their names, `profile`: the one in use, or nothing,
    and `allows`: profile -> what it names (`panels`, `actions`, `controls`, `verbs`), and `hide`
    where the rest is not shown; `engagement`, in a session with that model: its `timeouts`
    (seconds, or null), the seconds of a whole `handshake` and how many `attempts` it has; `phases`:
    those of the file;
    `study`: what the file says of the study, and how it stands (see `docs/reference/protocol.md`).
    `boot_id`: of the robot process's machine; a client with the same one may stamp its requests
    with `sent_us`. `clock_us`: CLOCK_MONOTONIC of that machine at `t` = 0, in microseconds. `part`:
    as in the hello; who plays which is in the lines `console.attached` of `state`. `robot_at`: the
    address of the robot's computer, in a session that was joined from another machine.
    """

    protocol: int
    console: str
    role: str
    seq: int
    t: int
    title: str
    log: str
    panels: list[PanelView]
    script: list[str] = msgspec.field(default_factory=lambda: [])
    verbs: dict[str, list[str]]
    variables: list[str]
    conditions: list[str]
    keyboard: str
    drivers: list[str]
    state: list[msgspec.Raw] = []
    recent: list[msgspec.Raw] = []
    settings: WelcomeSettings = WelcomeSettings()
    boot_id: str = ""
    clock_us: int = 0
    part: str = ""
    robot_at: str = ""


class Pulse(Answer, frozen=True, kw_only=True, tag="pulse"):
    """Once a second from the host to every client: it lives; `dropped` readings were left out.

    `rate`: how fast `t` goes on from here; a replay stands still (0) or hurries.
    """

    t: int
    dropped: int = 0
    rate: float = 1.0


class Replaying(Answer, frozen=True, kw_only=True, tag="replaying"):
    """How a replay stands: at `t` of `length_us`, at `rate` times its real speed, or still.

    `marks` are times of markers and what they say, oldest first, for the time line; only in the
    first one, and when it begins anew. `sorts`: what each of them is (marker, note, mistake, stop,
    trial, phase, break, questionnaire, lost, engagement, end, code). `cut_us`: how much of idle
    gaps has been left out so far.
    """

    t: int
    length_us: int
    rate: float
    paused: bool
    ended: bool = False
    cut_us: int = 0
    marks: list[tuple[int, str]] | None = None
    sorts: list[str] = []


class PanelsChanged(Answer, frozen=True, kw_only=True, tag="panels"):
    """After a reload or a change of profile: the panels and the script as they are now, and the
    variables' present values. A field of `WelcomeSettings` (`PANEL_SETTINGS`) replaces what the
    welcome had there; null: as before.
    """

    title: str
    panels: list[PanelView]
    script: list[str] = msgspec.field(default_factory=lambda: [])
    verbs: dict[str, list[str]]
    conditions: list[str]
    keyboard: str
    variables: list[str] | None = None
    values: dict[str, str] = {}
    steps: dict[str, float] | None = None
    repairs: list[ActionView] = []
    profiles: list[str] = []
    profile: str = ""
    allows: dict[str, Allowance] = {}
    engagement: ModelLimits = ModelLimits()
    phases: list[PhaseView] = []
    slots: dict[str, SlotView] = {}
    participant_fields: dict[str, list[str]] = {}
    sensors: list[str] = []
    study: StudySettings | None = None
    stale_after: float | None = None
    dead_man: float | None = None
    abandon_after: float | None = None
    driving: str | None = None
    participant_pattern: str | None = None


#: The settings that may be others after a reload.
PANEL_SETTINGS = tuple(
    name for name in PanelsChanged.__struct_fields__ if name in WelcomeSettings.__struct_fields__
)


#: Lines from the host that are not messages of the session.
ANSWERS: tuple[type[Answer], ...] = (
    Reply,
    Welcome,
    Pulse,
    PanelsChanged,
    Replaying,
    PictureShown,
    SoundHeard,
)
