"""The part of the messages that makes the robot act: actions, commands, acknowledgements, the stop.

All others import them from `woz_tui.protocol.messages`.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Literal, get_args

import msgspec

from woz_tui.protocol.envelope import Json, Message, RestrictedMessage
from woz_tui.protocol.sentence import Wording

#: Verbs with which a robot shows by itself how the engagement model stands.
SIGNALS = frozenset({"eyes", "screen", "sound"})
#: Devices that `woz hands` reads, as sources: each says by itself when it is let go.
HAND_DEVICES = ("gamepad", "stream-deck", "spacemouse", "wii-remote", "imu")
#: Sources of what a hand asks for, or a program in its place; `phase` is what begins with a phase
#: that a hand chose. A body that asks for the sound of a move is none.
HANDS = frozenset({"key", "script", "palette", "midi", *HAND_DEVICES, "program", "phase"})
#: The verb by which somebody consents to having their face learnt, or does not any more.
FACE_CONSENT_VERB = "face_consent"
#: Verbs with which a robot speaks, or makes the sounds of a voice.
SPEAKING_VERBS = frozenset({"say", "utter"})
#: Sources of what the robot does by itself, also because a participant chose it on a page, or does
#: again.
BY_ITSELF = frozenset({"engagement", "participant", "replay"})
#: Sources that only a wizard's console has.
OF_CONSOLES = frozenset({"key", "palette", "script"})
#: Sources of what a person wants who is there: at a console, or at a panel that a driver reads by
#: itself. What comes from a program may be its own wish, a gamepad's too (`woz hands`).
BY_PERSON = OF_CONSOLES | {"midi"}


#: On what it stands that something has happened: time has passed and nobody can know more; the
#: device or its program says so; a sensor of the device shows it.
Evidence = Literal["timed", "reported", "measured"]
#: The same, the weakest first.
EVIDENCE: tuple[Evidence, ...] = get_args(Evidence)


def weakest(said: Collection[str]) -> Evidence | Literal[""]:
    """The lowest of several evidences; empty if nobody says any."""
    return next((kind for kind in EVIDENCE if kind in said), "")


def is_by_hand(source: str, key: str) -> bool:
    """Whether a hand, or a program in its place, is behind what was asked for. A driver names the
    key, pad or button behind what it asks for; what it does by itself has none.
    """
    return bool(key) or source in HANDS


class ActionRequested(Message, frozen=True, kw_only=True, tag="action.requested"):
    """Somebody asked for an action by name: one press, from which one or more commands follow.

    `source` is key, script, palette, midi, gamepad, stream-deck, spacemouse, wii-remote, imu,
    program, phase, engagement, participant or replay; `console` names the connection it came over.
    `run` ties the action's commands and its end together. `without`: verbs, and arguments such as
    `play.speed`, that this robot does not do of it. `edited`: its sentence was typed anew before it
    was said, this once.
    """

    run: str
    action: str
    panel: str = ""
    source: str
    key: str = ""
    console: str = ""
    without: list[str] = []
    edited: bool = False


class ActionEnd(RestrictedMessage, frozen=True, kw_only=True):
    """How the run of an action ended; each `action.requested` has exactly one such line. `wording`
    as in `Notice`.
    """

    run: str
    action: str
    reason: str = ""
    wording: dict[str, Wording] = {}


class ActionDone(ActionEnd, frozen=True, kw_only=True, tag="action.done"):
    """Every command of the action was done. `evidence` is the lowest of theirs, as in `Done`."""

    evidence: str = ""


class ActionFailed(ActionEnd, frozen=True, kw_only=True, tag="action.failed"):
    """A command failed, timed out or was refused; `reason` says which."""


class ActionStopped(ActionEnd, frozen=True, kw_only=True, tag="action.stopped"):
    """The stop, the wizard or the end of what it belonged to cut the action short."""


class ActionSuperseded(ActionEnd, frozen=True, kw_only=True, tag="action.superseded"):
    """A newer act of the wizard took the place of what was still to be done; `by` names it."""

    by: str


class ActionRefused(ActionEnd, frozen=True, kw_only=True, tag="action.refused"):
    """Nothing of the action was tried: unknown, locked, stale, stopped, or a value missing."""


class Command(RestrictedMessage, frozen=True, kw_only=True, tag="command.requested"):
    """One verb with its arguments, for one driver, on its way to the bus.

    `deadline_us`, on the session's `t` axis, is the moment after which it may no longer begin
    (0: none). `limit_s` bounds how long it may run once begun. `when_busy`: queue, replace or
    refuse, if its lane is occupied. `unfilled`: those of `args` that tell what `tells` says, with
    such variables left in place: `{greeting}`. `console`: the connection over which it came, if it
    belongs to no action.
    """

    command: str
    run: str = ""
    action: str = ""
    panel: str = ""
    verb: str
    args: dict[str, Json]
    driver: str = ""
    source: str
    key: str = ""
    deadline_us: int = 0
    limit_s: float = 30.0
    when_busy: str = "queue"
    unfilled: dict[str, Json] = {}
    console: str = ""

    @property
    def passing(self) -> bool:
        """A panel's knob or stick on its way, also in a re-run, or what a robot shows of the
        engagement model by itself: logged, but worth no line of its own.
        """
        if self.source == "engagement":
            return not self.run and self.verb in SIGNALS
        if self.source == "gamepad" and "stick" in self.key:
            return True
        return self.source in ("midi", "gamepad", "replay") and self.verb == "control"


class FilledCall(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One verb of an action as it would be sent now; `tells` and `unfilled` as in `Command`."""

    verb: str
    args: dict[str, Json] = {}
    driver: str = ""
    tells: tuple[str, ...] = ()
    unfilled: dict[str, Json] = {}


class ActionsFilled(Message, frozen=True, kw_only=True, tag="actions.filled"):
    """What actions would do if they were played now: texts chosen, variables filled in.

    `actions`: name -> its steps, one after the other: a pause in seconds, or verbs that begin
    together, each with its `verb`, `args` and `driver`, and `tells` and `unfilled` as a command has
    them. A variable that has no value yet stands as it is written. What is not named is as before.
    """

    actions: dict[str, list[list[FilledCall] | float]]

    def after(self, before: ActionsFilled | None) -> ActionsFilled:
        """With what was known before."""
        known = before.actions if before is not None else {}
        return msgspec.structs.replace(self, actions={**known, **self.actions})


class Ack(RestrictedMessage, frozen=True, kw_only=True):
    """What became of a command. Only the subclasses are sent."""

    command: str
    driver: str = ""


class Dispatched(Ack, frozen=True, kw_only=True, tag="command.dispatched"):
    """The driver's `perform` was called. `latency_us` counts from the request."""

    latency_us: int


class Progress(Ack, frozen=True, kw_only=True, tag="command.progress"):
    """The driver now knows how long it will take: `expected_us` more from this line's `t`."""

    kept_whole = True
    expected_us: int


class End(Ack, frozen=True, kw_only=True):
    """How a command ended; each `command.requested` has exactly one such line. `wording` as in
    `Notice`.
    """

    reason: str = ""
    remedy: str = ""
    wording: dict[str, Wording] = {}


class Done(End, frozen=True, kw_only=True, tag="command.done"):
    """It was carried out. `sent` is what really went to the hardware, after clamping.

    `evidence`, on what that stands: measured (a sensor of the device shows it), reported (the
    device or its program says so), timed (it was sent; nobody can know more). Empty: it reaches no
    hardware, or an older log, which does not say.
    """

    sent: dict[str, Json]
    latency_us: int
    duration_us: int
    evidence: str = ""


class Failed(End, frozen=True, kw_only=True, tag="command.failed"):
    """The driver raised; `reason` says what, `remedy` what to do."""


class TimedOut(End, frozen=True, kw_only=True, tag="command.timed_out"):
    """It ran longer than `limit_s`; its lane is faulted until the job really ends."""


class Refused(End, frozen=True, kw_only=True, tag="command.refused"):
    """It never began: `code` is stopped, ended, late, stale, profile, locked, full, busy, faulted,
    unknown, unwatched, unrecorded (no folder takes the log), part (another wizard plays it),
    consent (nobody has given one), args or unchecked (a check of the program itself failed);
    or a word of a feature.
    """

    code: str


class Stopped(End, frozen=True, kw_only=True, tag="command.stopped"):
    """The stop, or the loss of the wizard while driving, ended it."""


class Superseded(End, frozen=True, kw_only=True, tag="command.superseded"):
    """A newer setpoint or a replacing command replaced it; `by` names that one."""

    by: str


class MotionArrived(Ack, frozen=True, kw_only=True, tag="motion.arrived"):
    """The motion that a command began has really arrived. It comes after `command.done`, which of
    some verbs (a gaze) says only that the goal was taken; `describe` names the verbs that have it.
    `evidence` as in `Done`.
    """

    evidence: str = ""


class MotionInterrupted(Ack, frozen=True, kw_only=True, tag="motion.interrupted"):
    """The motion that a command began will not arrive; `by` names a command that took its place.

    `stopped`: the stop, or the end of the session, cut it short.
    """

    reason: str
    by: str = msgspec.field(default_factory=str)
    stopped: bool = False


class CommandMark(Ack, frozen=True, kw_only=True, tag="command.mark"):
    """A command comes to a point of its own. `sort`: word (one begins; `text` has it), bookmark
    (a mark in the text that was said; `text` is its name), stroke (the gesture is where its
    meaning lies) or sync (a sync point of a block of BML; `text` is `behaviour:point`,
    and empty when the block begins).
    """

    kept_whole = True
    sort: str
    text: str = ""


#: A stop is confirmed so soon after its key, in seconds.
STOP_PROMISE_S = 0.5


class StopPressed(Message, frozen=True, kw_only=True, tag="stop.pressed"):
    """The stop latched. `source` is key, program, console-lost ...; `scope` all or drive.
    `console`: the connection over which it came. `pressed`: when the key was pressed or the robot
    process itself found it necessary, on the axis of `t`; 0: nobody said (and older logs).
    """

    names_console = True
    source: str
    scope: str = msgspec.field(default_factory=lambda: "all")
    console: str = ""
    pressed: int = 0
    wording: dict[str, Wording] = {}


class StopConfirmed(Message, frozen=True, kw_only=True, tag="stop.confirmed"):
    """Which drivers confirmed within 0.5 s of being told and which did not, by name. Those of which
    nothing moves or sounds are in neither (older logs have them).

    `elapsed_us`: from `pressed` of the stop, where that is known, else (and in older logs) from its
    message.
    `scope`: of the stop that they confirm, as there; empty in older logs.
    `unreached`: those of `missing` whose hardware was not connected, so that no stop came to it.
    `parts` and `missing_parts` tell of drivers that have several: driver -> speech, motion ...
    """

    confirmed: list[str]
    missing: list[str]
    elapsed_us: int
    parts: dict[str, list[str]] = {}
    missing_parts: dict[str, list[str]] = {}
    unreached: list[str] = []
    scope: str = ""

    @property
    def late(self) -> bool:
        """Whether all confirmed, and longer after the key than was promised."""
        return not self.missing and self.elapsed_us > STOP_PROMISE_S * 1_000_000


class StopReleased(Message, frozen=True, kw_only=True, tag="stop.released"):
    """A wizard released the stop on purpose. `console`: the connection over which it came."""

    names_console = True
    source: str
    console: str = ""
