"""What a console or any other program may ask of the robot process, and the answers.

Requests travel from the client to the host, one JSON object a line; `ref` is a number the client
chooses, repeated in the `reply`. Unknown fields are refused, so that a misspelt one is noticed.
"""

from __future__ import annotations

from typing import Literal

import msgspec

from woz_tui.core.messages import Json

PROTOCOL = 1


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
    """What all requests carry."""

    ref: int = 0


class Hello(Request, frozen=True, kw_only=True, omit_defaults=True, tag="hello"):
    """First line of a client. `role`: wizard (one at a time), watcher or program.

    A wizard must send a `beat` at least every second; when three seconds pass without one, driving
    stops. `stream`: everything, actions (no samples) or nothing. While a wizard is attached a
    second one becomes a watcher, unless it says `take_over`: then the first one does.
    """

    role: str
    name: str = ""
    protocol: int = PROTOCOL
    stream: str = "everything"
    take_over: bool = False


class AskAction(Request, frozen=True, kw_only=True, omit_defaults=True, tag="action"):
    """Play an action of the experiment by name.

    `key` is the chord that was pressed, if one was. `age_us`: how old the press already is.
    `stale`: the console decided not to play it; it is logged as refused.
    """

    action: str
    source: str = "program"
    key: str = ""
    age_us: int = 0
    stale: bool = False
    when_busy: WhenBusy = ""


class AskVerb(Request, frozen=True, kw_only=True, omit_defaults=True, tag="verb"):
    """Send one verb with its arguments; `on` names the driver where several offer it.

    Variables in braces (`{participant}`) are filled in, in arguments that are texts.

    `key`, `age_us` and `stale` as for an action.
    """

    verb: str
    args: dict[str, Json] = {}
    on: str = ""
    source: str = "program"
    key: str = ""
    age_us: int = 0
    stale: bool = False
    when_busy: WhenBusy = ""


class AskStop(Request, frozen=True, kw_only=True, omit_defaults=True, tag="stop"):
    """Stop everything, now."""

    source: str = "program"


class AskRelease(Request, frozen=True, kw_only=True, omit_defaults=True, tag="release"):
    """Release the stop."""

    source: str = "program"


class AskScript(Request, frozen=True, kw_only=True, omit_defaults=True, tag="script"):
    """Play the script's next line (`play`), or move its position to `to` without playing.

    `key`, `age_us` and `stale` as for an action.
    """

    play: bool = True
    to: int | None = None
    key: str = ""
    age_us: int = 0
    stale: bool = False


class AskCancel(Request, frozen=True, kw_only=True, omit_defaults=True, tag="cancel"):
    """Cut one running or queued action short."""

    run: str


class AskSet(Request, frozen=True, kw_only=True, omit_defaults=True, tag="set"):
    """Set the participant, the condition or the trial."""

    participant: str | None = None
    condition: str | None = None
    trial: int | None = None


class AskMarker(Request, frozen=True, kw_only=True, omit_defaults=True, tag="marker"):
    """Put a marker into the log."""

    text: str = ""


class AskNote(Request, frozen=True, kw_only=True, omit_defaults=True, tag="note"):
    """Put a note into the log."""

    text: str


class AskMistake(Request, frozen=True, kw_only=True, omit_defaults=True, tag="mistake"):
    """Label a run as a mistake; an empty `run` means the last action."""

    run: str = ""
    text: str = ""


class AskLock(Request, frozen=True, kw_only=True, omit_defaults=True, tag="lock"):
    """Lock or unlock a panel."""

    panel: str
    locked: bool


class AskProfile(Request, frozen=True, kw_only=True, omit_defaults=True, tag="profile"):
    """Play with what a profile of the experiment allows; an empty one allows everything."""

    profile: str = ""
    source: str = "program"


class AskReload(Request, frozen=True, kw_only=True, omit_defaults=True, tag="reload"):
    """Read the experiment file again. `dry_run` only tells the differences or errors."""

    dry_run: bool = False


class AskPreflight(Request, frozen=True, kw_only=True, omit_defaults=True, tag="preflight"):
    """Run the robot side's checks; the reply's `data` lists them."""


class AskEnd(Request, frozen=True, kw_only=True, omit_defaults=True, tag="end"):
    """End the session: rest pose, drivers closed, log finished, process gone."""

    reason: str = "wizard"


class Beat(Request, frozen=True, kw_only=True, omit_defaults=True, tag="beat"):
    """The wizard's console lives, and so does the line to its terminal if `line_ok`."""

    line_ok: bool = True


AnyRequest = (
    Hello
    | AskAction
    | AskVerb
    | AskStop
    | AskRelease
    | AskScript
    | AskCancel
    | AskSet
    | AskMarker
    | AskNote
    | AskMistake
    | AskLock
    | AskProfile
    | AskReload
    | AskPreflight
    | AskEnd
    | Beat
)


class Reply(
    msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, tag_field="kind", tag="reply"
):
    """The answer to one request; not part of the session's stream and never logged.

    `run` names what was started. `reason` says why not, `hint` what would help. `data` carries
    what the request asked for.
    """

    ref: int
    ok: bool
    reason: str = ""
    hint: str = ""
    run: str = ""
    data: Json = None


class ActionView(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """An action as the console shows it; `key` is the chord as the experiment file has it, in the
    normal form of `woz_tui.experiment.keys`; `verbs` what it does, for icons and search.
    """

    name: str
    label: str
    key: str = ""
    help: str = ""
    verbs: list[str] = []
    utterances: list[str] = []
    locked: bool = False


class PanelView(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A panel as the console shows it."""

    title: str
    actions: list[ActionView]
    locked: bool = False


class Welcome(
    msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, tag_field="kind", tag="welcome"
):
    """First line to a client that said hello: the whole picture, so any console can begin here.

    `state` are messages of the stream that still hold (session start and changes, health of each
    driver, stop if pressed, commands and actions not yet ended, last reading of each sensor,
    recorder state, script position, locks); a client treats them like any other. `recent` is the
    tail of the log, oldest first, for the console's list. `seq` is the last one contained.
    `settings`: `stale_after` and `dead_man` in seconds, `participant_pattern`, and `joints`: joint
    -> [lowest, highest angle] in degrees, for those whose driver tells them, `outlines`: driver ->
    what it looks like (see `docs/protocol.md`), `values`: variable -> its value at this moment,
    `profiles`: their names, `profile`: the one in use, or nothing, and `allows`: profile -> what it
    names (`panels`, `actions`, `controls`, `verbs`), and `hide` where the rest is not shown;
    `engagement`, in a session with that model: its `timeouts` (seconds, or null), the seconds of a
    whole `handshake` and how many `attempts` it has.
    """

    protocol: int
    console: str
    role: str
    seq: int
    t: int
    title: str
    log: str
    panels: list[PanelView]
    script: list[str]
    verbs: dict[str, list[str]]
    variables: list[str]
    conditions: list[str]
    keyboard: str
    drivers: list[str]
    state: list[msgspec.Raw] = []
    recent: list[msgspec.Raw] = []
    settings: dict[str, Json] = {}


class Pulse(
    msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, tag_field="kind", tag="pulse"
):
    """Once a second from the host to every client: it lives; `dropped` readings were left out."""

    t: int
    dropped: int = 0


class PanelsChanged(
    msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, tag_field="kind", tag="panels"
):
    """After a reload or a change of profile: the panels and the script as they are now, and the
    variables' present values. `profiles`, `profile`, `allows` and `engagement` as in the welcome's
    `settings`.
    """

    title: str
    panels: list[PanelView]
    script: list[str]
    verbs: dict[str, list[str]]
    conditions: list[str]
    keyboard: str
    values: dict[str, str] = {}
    profiles: list[str] = []
    profile: str = ""
    allows: dict[str, Json] = {}
    engagement: dict[str, Json] = {}


#: Lines from the host that are not messages of the session.
AnyAnswer = Reply | Welcome | Pulse | PanelsChanged
