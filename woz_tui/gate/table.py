"""Every reason for which something may not happen now, in the order in which they are looked at.

`TABLE` is read from above: of the rows for what is asked about (`questions.py`), the first that
answers decides. A row is a plain function of what holds (`facts.py`) and the question: it waits for
nothing, changes nothing, and can only forbid.

The gate is asked at three moments and nowhere else: when something is requested, when what was
requested for later is due, and just before a command goes to its driver. The stop, its confirmation
and the end of driving never ask it. What becomes of a command whose lane is occupied is the lane's
own affair.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

from woz_tui.config.performers import ENGAGEMENT
from woz_tui.feature import pieces
from woz_tui.gate.facts import Facts, console_of
from woz_tui.gate.questions import (
    ClientRequest,
    DispatchCommand,
    PlayAction,
    PlayEffect,
    Question,
    ReleaseStop,
    SendOwnVerb,
    SendVerb,
    SubmitCommand,
)
from woz_tui.protocol import requests as r
from woz_tui.protocol.action_messages import BY_PERSON, FACE_CONSENT_VERB, HAND_DEVICES
from woz_tui.protocol.messages import Command, Json
from woz_tui.protocol.panel_players import panel_players, player_names, verb_players
from woz_tui.protocol.panels import covers_verb
from woz_tui.protocol.refusal import Refusal
from woz_tui.protocol.sentence import Sentence

log = logging.getLogger(__name__)

#: What somebody who only watches may ask for.
WATCHER_MAY = (
    *(r.AskDescribe, r.AskPreflight, r.AskMarker, r.AskNote, r.AskPicture, r.AskSound),
    r.AskTakeOver,
)
#: What is for some roles alone: which, and what others are told. A program does not see the room.
#: Pictures and live sound are of people, and a program can ask a device itself. Whoever may play
#: the robot may talk through it.
FOR_ROLES: dict[type, tuple[tuple[str, ...], Sentence, str]] = {
    r.AskUnrecorded: (
        ("wizard",),
        Sentence("gate.only_wizard", "only a wizard can go on without a record"),
        "",
    ),
    r.AskPicture: (
        ("wizard", "watcher"),
        Sentence("gate.no_pictures", "only wizards, and who watches, see camera pictures"),
        Sentence("gate.watch", "start `woz attach --watch` to see them"),
    ),
    r.AskSound: (
        ("wizard", "watcher"),
        Sentence("gate.no_sound", "only wizards, and who watches, hear the robot's microphone"),
        "",
    ),
    r.AskTalk: (
        ("wizard", "program"),
        Sentence("gate.no_talk", "only wizards and programs can talk through the robot"),
        "",
    ),
}
#: What may be asked while the session ends, as far as this row goes: it has rows of its own, or
#: moves nothing. Whatever is not named here is refused then.
WHILE_ENDING = (
    *(r.AskAction, r.AskVerb, r.AskRelease, r.AskReload, r.AskPredict),
    *(r.AskDescribe, r.AskPreflight, r.AskKeepTyped, r.AskPicture, r.AskSound),
    *(r.AskTalk, r.AskLetGo, r.AskControls, r.AskCancel, r.AskEmptyQueue, r.AskSet, r.AskMarker),
    *(r.AskNote, r.AskMistake, r.AskLock, r.AskUnrecorded, r.AskEnd),
)
#: What is not done if a request is too old: it would let something move, or mean another thing by
#: now. Records, and whatever takes away, are taken all the same.
UNDONE: dict[type, str] = {
    r.AskUnrecorded: Sentence("gate.not_unrecorded", "Not going on without a record"),
    r.AskEnd: Sentence("gate.not_ended", "Session not ended"),
}
#: The same in words, or made of the request.
Undone = str | Callable[[Any], str]
#: Requests that may wait for their moment, and how far it may be away, in microseconds.
MOST_SCHEDULED, FURTHEST_US = 256, 86_400_000_000
#: Sources of what lies on a control that says itself when it is let go.
SWITCHES = frozenset({"midi", *HAND_DEVICES})

#: Remedies: of a press that came too late, where nobody watches, where only a held key drives,
#: where nothing is recorded.
AGAIN = Sentence("gate.again", "press it again")
ATTACH = Sentence("gate.attach", "attach a wizard's console")
HOLD = Sentence(
    "gate.hold",
    "give it a key of its own and hold that; session: {{driving: pressed}} takes the risk",
)
GO_ON = Sentence("gate.go_on", "go on without a record (a wizard only), or free space for the log")
#: Why a key does not drive any more.
LET_GO = Sentence("gate.let_go", "the key was let go")


@cache
def watcher_may() -> tuple[type[r.Request], ...]:
    """What somebody who only watches may ask for, of features too."""
    gates = pieces("gate", FeatureGate).values()
    return (*WATCHER_MAY, *(kind for gate in gates for kind in gate.watcher_may))


@cache
def participant_may() -> tuple[type[r.Request], ...]:
    """What a participant may ask for, who sits at a terminal to answer: that of features alone."""
    gates = pieces("gate", FeatureGate).values()
    return tuple(kind for gate in gates for kind in gate.participant_may)


@cache
def _while_ending() -> tuple[type[r.Request], ...]:
    gates = pieces("gate", FeatureGate).values()
    return (*WHILE_ENDING, *(kind for gate in gates for kind in gate.while_ending))


@cache
def _undone() -> dict[type, Undone]:
    gates = pieces("gate", FeatureGate).values()
    of_features = {kind: what for gate in gates for kind, what in gate.undone.items()}
    return {**UNDONE, **of_features}


# -- role --------------------------------------------------------------------------------------


def watches(facts: Facts, asked: ClientRequest) -> Refusal | None:
    """A console that watches asks for little."""
    if asked.role != "watcher" or isinstance(asked.request, watcher_may()):
        return None
    if asked.vacant:
        reason = Sentence(
            "gate.watches_vacant",
            "this console only watches, and nobody plays {part}",
            part=asked.plays,
        )
        return Refusal("role", reason, command="take_over")
    reason = Sentence(
        "gate.watches",
        "this console only watches; another console plays {part}",
        part=asked.plays,
    )
    return Refusal("role", reason, asked.take_over)


def participates(facts: Facts, asked: ClientRequest) -> Refusal | None:
    """A participant answers questionnaires."""
    if asked.role != "participant" or isinstance(asked.request, participant_may()):
        return None
    return Refusal(
        "role", Sentence("gate.participates", "this console can only answer questionnaires")
    )


def not_for_role(facts: Facts, asked: ClientRequest) -> Refusal | None:
    """As `FOR_ROLES` says it."""
    roles, reason, remedy = FOR_ROLES.get(type(asked.request), ((asked.role,), "", ""))
    return None if asked.role in roles else Refusal("role", reason, remedy)


# -- stop --------------------------------------------------------------------------------------

STOPPED = Sentence("gate.stopped", "the stop is pressed")


def stop_pressed_action(facts: Facts, asked: PlayAction) -> Refusal | None:
    """An action that only tells the engagement model something is played all the same."""
    calls = asked.action.calls if asked.action is not None else ()
    if calls and all(call.driver == ENGAGEMENT for call in calls):
        return None
    return Refusal("stopped", STOPPED, command="release")


def stop_pressed_later(facts: Facts, asked: SendVerb) -> Refusal | None:
    """A verb for later is refused when it is asked for, one for now on its way into its lane."""
    return Refusal("stopped", STOPPED) if asked.at else None


def stop_pressed(facts: Facts, asked: SubmitCommand | DispatchCommand) -> Refusal | None:
    """Nothing reaches a driver until the stop is released."""
    if asked.stoppable:
        release = Sentence("gate.release_first", "release the stop first")
        return Refusal("stopped", STOPPED, release)
    return None


def not_confirmed(facts: Facts, asked: ReleaseStop) -> Refusal | None:
    """Somebody has to look at what may still move."""
    if missing := ", ".join(name for name in facts.unconfirmed if name not in asked.known):
        return Refusal(
            "unconfirmed",
            Sentence(
                "gate.not_confirmed",
                "the stop is not confirmed by {missing}, which may still move",
                missing=missing,
            ),
            Sentence(
                "gate.look_first",
                "look at it, then release the stop at a wizard's console, which asks once more",
            ),
        )
    return None


def not_stopped(facts: Facts, asked: ReleaseStop) -> Refusal | None:
    """There has to be a stop."""
    if facts.stopped:
        return None
    return Refusal("unknown", Sentence("gate.not_stopped", "the stop is not pressed"))


# -- ended, stale, unknown -----------------------------------------------------------------------


def ended(facts: Facts, asked: object) -> Refusal:
    """Nothing begins while the session ends."""
    return Refusal("ended", Sentence("gate.ending", "the session is ending"))


def ended_request(facts: Facts, asked: ClientRequest) -> Refusal | None:
    """Nor is anything else done that nobody needs then."""
    return None if isinstance(asked.request, _while_ending()) else ended(facts, asked)


def too_old(facts: Facts, asked: PlayAction | SendVerb) -> Refusal:
    """What was pressed too long ago is not done: the room has changed."""
    return Refusal("stale", asked.stale, AGAIN)


def too_old_request(facts: Facts, asked: ClientRequest) -> Refusal | None:
    """As `UNDONE` says it."""
    undone = not_done(asked.request)
    return _stale(undone, asked.stale) if undone else None


def _stale(undone: str, why: str) -> Refusal:
    return Refusal(
        "stale", Sentence("gate.undone", "{undone} ({why})", undone=undone, why=why), AGAIN
    )


def not_done(request: r.Request) -> str:
    """What is not done if `request` is too old; empty: it is done all the same."""
    match request:
        case r.AskLock(panel=panel, locked=False):
            return Sentence("gate.not_unlocked", "Panel {panel!r} not unlocked", panel=panel)
        case r.AskMistake(run=""):
            return Sentence("gate.not_marked", "Last action not marked as a mistake")
    undone = _undone().get(type(request), "")
    return undone(request) if callable(undone) else undone


def too_old_release(facts: Facts, asked: ReleaseStop) -> Refusal:
    """A release lets things move again."""
    return _stale(Sentence("gate.not_released", "Stop not released"), asked.stale)


def no_such_action(facts: Facts, asked: PlayAction) -> Refusal | None:
    """The file has to have it."""
    if asked.action:
        return None
    reason = Sentence("gate.no_action", "there is no action {action!r}", action=asked.name)
    return Refusal("unknown", reason)


def no_such_verb(facts: Facts, asked: SendVerb | SendOwnVerb) -> Refusal | None:
    """It has to be known who carries it out."""
    return asked.nobody


def not_offered(facts: Facts, asked: SubmitCommand) -> Refusal:
    """Its driver has to offer it."""
    return Refusal("unknown", asked.unknown)


# -- part ----------------------------------------------------------------------------


def another_plays_action(facts: Facts, asked: PlayAction) -> Refusal | None:
    """A panel is played by its parts. A phase plays what it begins with, whoever goes on to it;
    programs and control panels that belong to a part play what a wizard of that part would.
    """
    console, players = asked.origin.console, _players(facts, asked)
    if console not in players or asked.origin.source == "phase" or asked.action is None:
        return None
    title = asked.action.panel
    panel = next((each for each in facts.panels if each.title == title), None)
    if panel is None:  # beside the panels: it says something
        return _not_played(facts, asked, "say", "")
    found = panel_players(panel, facts.panels, players)
    if console in found:
        return None
    reason = Sentence(
        "gate.panel_of_part",
        "the panel {panel!r} is played by {players}",
        panel=title,
        players=player_names(found, players),
    )
    return Refusal("part", reason)


def another_plays_verb(facts: Facts, asked: SendVerb) -> Refusal | None:
    """A verb by itself belongs with the panels that cover it."""
    return _not_played(facts, asked, asked.verb, asked.driver)


def _not_played(
    facts: Facts, asked: PlayAction | SendVerb, verb: str, driver: str
) -> Refusal | None:
    console, players = asked.origin.console, _players(facts, asked)
    if console not in players:
        return None
    found = verb_players(verb, facts.panels, players, driver)
    if console in found:
        return None
    reason = Sentence(
        "gate.verb_of_part",
        "{verb!r} is played by {players}",
        verb=verb,
        players=player_names(found, players),
    )
    return Refusal("part", reason)


def _players(facts: Facts, asked: PlayAction | SendVerb) -> dict[str, str]:
    """Who plays, and whoever asks, if it belongs to a part."""
    console = asked.origin.console
    part = facts.helpers.get(console, "")
    return {**facts.wizards, console: part} if part else {**facts.wizards}


# -- lock, record, moment ------------------------------------------------------------------------


def locked_action(facts: Facts, asked: PlayAction) -> Refusal | None:
    """The file locks an action, the file or a hand its panel."""
    if asked.action is None:
        return None
    if asked.action.locked:
        by_file = Sentence("gate.locked_by_file", "the experiment file locks it")
        return Refusal("locked", _locked(asked.name), by_file)
    panel = asked.action.panel
    if not facts.locked.get(panel, False):
        return None
    return locked_panel(panel)


def locked_panel(panel: str, when: str = "") -> Refusal:
    """What is said of an action of a locked panel. `when`: while what it is."""
    reason = Sentence("gate.panel_locked", "the panel {panel!r} is locked", panel=panel)
    if when:
        reason = Sentence("gate.when", "{what} {when}", what=reason, when=when)
    return Refusal("locked", reason, _unlock(panel), "find")


def _locked(action: str) -> Sentence:
    return Sentence("gate.locked", "{action!r} is locked", action=action)


def locked_effect(facts: Facts, asked: PlayEffect) -> Refusal | None:
    """A lock holds for the robot itself, a profile does not."""
    if asked.action.locked:
        return Refusal("locked", _locked(asked.name))
    if not facts.locked.get(asked.action.panel):
        return None
    return Refusal("locked", Sentence("gate.its_panel_locked", "its panel is locked"))


def locked_verb(facts: Facts, asked: SendVerb) -> Refusal | None:
    """A verb is locked with the panels that cover it."""
    for panel in facts.panels:
        locked = facts.locked.get(panel.title, panel.locked)
        if locked and covers_verb(panel.covers, asked.verb, asked.driver):
            reason = Sentence(
                "gate.verb_locked",
                "the panel {panel!r} is locked, and with it {verb!r}",
                panel=panel.title,
                verb=asked.verb,
            )
            return Refusal("locked", reason, _unlock(panel.title), "find")
    return None


def _unlock(panel: str) -> Sentence:
    """What a wizard looks for."""
    return Sentence("gate.unlock", "find 'Unlock {panel}'", panel=panel)


def takes_hands_off(verb: str, args: Mapping[str, Json]) -> bool:
    """Whether it only ends what a hand does with a robot: the puppeteer's own stop."""
    return verb == "mode" and args.get("mode") == "normal"


def unrecorded_action(facts: Facts, asked: PlayAction) -> Refusal | None:
    """Nothing of an action begins if something of it would not be recorded."""
    if asked.action is None or all(
        takes_hands_off(call.verb, call.args) for call in asked.action.calls
    ):
        return None
    return Refusal("unrecorded", facts.unrecorded, GO_ON, "unrecorded")


def unrecorded_verb(facts: Facts, asked: SendVerb) -> Refusal | None:
    """What would not be recorded does not begin."""
    if takes_hands_off(asked.verb, asked.args):
        return None
    return Refusal("unrecorded", facts.unrecorded, GO_ON, "unrecorded")


def unrecorded_command(facts: Facts, asked: SubmitCommand | DispatchCommand) -> Refusal | None:
    """Also the command with whose own line this was found out."""
    if takes_hands_off(asked.command.verb, asked.command.args):
        return None
    return Refusal("unrecorded", facts.unrecorded, GO_ON)


def no_moment(facts: Facts, asked: PlayAction | SendVerb) -> Refusal | None:
    """What is asked for a moment has to reach it."""
    late_us = facts.now - asked.at
    if abs(late_us) > FURTHEST_US:
        far = Sentence("gate.far_away", "the moment is more than a day away")
        return Refusal("late", far)
    if late_us > 0:
        late = Sentence(
            "gate.too_late",
            "too late: it was to begin {seconds:.3f} s ago",
            seconds=late_us / 1_000_000,
        )
        return Refusal("late", late)
    if facts.scheduled >= MOST_SCHEDULED:
        many = Sentence(
            "gate.many_wait",
            "{count} requests wait for their moment already",
            count=MOST_SCHEDULED,
        )
        return Refusal("late", many)
    return None


def key_counts_once(facts: Facts, asked: PlayAction) -> Refusal | None:
    """A key that is held, or struck again, says nothing twice."""
    if asked.action is None:
        return None
    action = asked.action.label
    if asked.under_way == "waits":
        waits = Sentence("gate.waits", "{action!r} waits already", action=action)
        empty = Sentence("gate.empty_queue", "empty the queue")
        return Refusal("busy", waits, empty, "queue_empty")
    running = Sentence("gate.running", "{action!r} is running already", action=action)
    return Refusal("busy", running, Sentence("gate.interrupt", "interrupt it"), "cut")


# -- arguments, driving, consent, lane -----------------------------------------------------------


def wrong_arguments_later(facts: Facts, asked: SendVerb) -> Refusal | None:
    """What is asked for later has to be right now."""
    return Refusal("args", asked.wrong) if asked.at else None


def wrong_arguments(facts: Facts, asked: SubmitCommand) -> Refusal:
    """As its driver declares them."""
    return Refusal("args", asked.wrong)


def not_watched(facts: Facts, asked: SubmitCommand | DispatchCommand) -> Refusal | None:
    """What drives needs somebody who watches. What a wizard has asked for drives while the player
    of that wizard's part does, what belongs to no part while one of those whose part drives.

    Where a lost line may be seen late, only a held key drives, and a control that says when it is
    let go.
    """
    driving, command = facts.driving, asked.command
    if driving is None:
        return None
    if driving.unwatched:
        return Refusal("unwatched", driving.unwatched, ATTACH)
    part = driving.part
    watching = [each for each in driving.watchers if part in (None, each.part)]
    if part is not None and not watching:
        reason = Sentence(
            "gate.not_attached",
            "{console} is not attached, or does not respond",
            console=console_of(part),
        )
        return Refusal("unwatched", reason, ATTACH)
    held = [each for each in watching if each.held]
    own = any(each.console == driving.console for each in held)
    if own and command.source == "key" and command.key:
        if (driving.console, command.key) in driving.keys:
            return None
        keep = Sentence("gate.hold_key", "hold the key as long as it is to drive")
        return Refusal("unwatched", LET_GO, keep)
    if held and len(held) == len(watching) and command.source not in SWITCHES:
        console, line = console_of(held[0].part), held[0].line
        if line:
            reason = Sentence(
                "gate.held_inside",
                "{console}, inside {line}, drives only while a key is held",
                console=console,
                line=line,
            )
        else:
            reason = Sentence(
                "gate.held", "{console} drives only while a key is held", console=console
            )
        return Refusal("unwatched", reason, HOLD)
    return None


def without_consent(facts: Facts, asked: DispatchCommand) -> Refusal | None:
    """Only a person gives a consent, and only with one a face is learnt. The sentences do not say
    whose consent it is about.
    """
    if asked.gives and not _is_from_person(asked.command):
        return Refusal(
            "consent",
            Sentence("gate.no_consent", "no person has given this consent"),
            Sentence(
                "gate.let_consent",
                "let the wizard play a step `{verb}: NAME` of the experiment file",
                verb=FACE_CONSENT_VERB,
            ),
        )
    if asked.verb.needs_consent and asked.person not in facts.consents:
        return Refusal(
            "consent",
            Sentence(
                "gate.face_unconsented",
                "this person has not consented to having their face learnt",
            ),
            Sentence(
                "gate.ask_consent",
                "ask them, then play a step `{verb}: NAME`, with the same name",
                verb=FACE_CONSENT_VERB,
            ),
        )
    return None


def _is_from_person(command: Command) -> bool:
    if command.action:
        return command.source in BY_PERSON
    # Whatever comes over a connection names it: no program can pass for the handshake.
    return command.source == ENGAGEMENT and not (command.console or command.run)


def faulted_lane(facts: Facts, asked: SubmitCommand) -> Refusal:
    """A lane whose last job goes on in spite of its end takes nothing."""
    return Refusal(
        "faulted",
        Sentence(
            "gate.faulted",
            "{driver} does not respond: its last command has not ended",
            driver=asked.command.driver,
        ),
        Sentence(
            "gate.wait_for_device",
            "wait until it responds, or end the session and check the device",
        ),
    )


# -- the table -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Row:
    """One reason: its name, what it is about, and why that may not happen (None: it may).

    It is looked at only where there is the `fact`, and what is `asked` (names of fields; empty: it
    always is). `host`: only the robot process knows; a console and `woz check` leave the row out.
    """

    name: str
    about: tuple[type, ...]
    why_not: Callable[[Facts, Any], Refusal | None]
    fact: str = ""
    asked: str = ""
    host: bool = False
    #: The feature whose row it is, which has something to say of the moment; empty: the core's.
    feature: str = ""


@dataclass(frozen=True, slots=True)
class FeatureRow:
    """A feature's row. It stands before the first of the core's rows that asks the check `before`
    about the same, or behind them all.
    """

    row: Row
    before: Callable[[Facts, Any], Refusal | None] | None = None


@dataclass(frozen=True, slots=True)
class FeatureGate:
    """What a feature forbids, and what becomes of its requests.

    `while_ending`, `undone`: as `WHILE_ENDING` and `UNDONE`; what is not done may depend on the
    request, empty: it is done. `watcher_may`, `participant_may`: what else somebody may ask who
    only watches, or answers. `after_leaving`: what is carried out although its client has left.
    """

    rows: tuple[FeatureRow, ...] = ()
    while_ending: tuple[type[r.Request], ...] = ()
    undone: Mapping[type, Undone] = field(default_factory=dict)
    watcher_may: tuple[type[r.Request], ...] = ()
    participant_may: tuple[type[r.Request], ...] = ()
    after_leaving: tuple[type[r.Request], ...] = ()

    def __post_init__(self) -> None:
        """A row that nobody would ask forbids nothing, and nobody would see that."""
        for kind in (ClientRequest, PlayEffect):
            if any(kind in each.row.about for each in self.rows):
                raise ValueError(f"rows of features are not asked about {kind.__name__}")


_COMMAND = (SubmitCommand, DispatchCommand)

TABLE: tuple[Row, ...] = (
    Row("role", (ClientRequest,), watches, host=True),
    Row("role", (ClientRequest,), participates, host=True),
    Row("age", (ClientRequest,), too_old_request, asked="stale", host=True),
    Row("role", (ClientRequest,), not_for_role, host=True),
    Row("end", (ClientRequest,), ended_request, fact="ended"),
    Row("end", (ReleaseStop, SendVerb, SendOwnVerb), ended, fact="ended"),
    Row("unknown", (SendVerb, SendOwnVerb), no_such_verb, asked="nobody"),
    Row("age", (ReleaseStop,), too_old_release, asked="stale", host=True),
    Row("stop", (ReleaseStop,), not_confirmed, fact="unconfirmed", host=True),
    Row("stop", (ReleaseStop,), not_stopped),
    Row("age", (PlayAction, SendVerb), too_old, asked="stale", host=True),
    Row("end", (PlayAction,), ended, fact="ended"),
    Row("unknown", (PlayAction,), no_such_action),
    Row("lock", (PlayAction,), locked_action),
    Row("lock", (PlayEffect,), locked_effect),
    Row("record", (PlayAction,), unrecorded_action, fact="unrecorded"),
    Row("record", (SendVerb,), unrecorded_verb, fact="unrecorded"),
    Row("lock", (SendVerb,), locked_verb, fact="panels"),
    Row("part", (PlayAction,), another_plays_action, fact="wizards"),
    Row("part", (SendVerb,), another_plays_verb, fact="wizards"),
    Row("moment", (SendVerb,), no_moment, asked="at", host=True),
    Row("stop", (PlayAction,), stop_pressed_action, fact="stopped"),
    Row("stop", (SendVerb,), stop_pressed_later, fact="stopped"),
    Row("arguments", (SendVerb,), wrong_arguments_later, asked="wrong"),
    Row("moment", (PlayAction,), no_moment, asked="at", host=True),
    Row("running", (PlayAction,), key_counts_once, asked="under_way", host=True),
    # What is asked of an action or a verb ends here; its commands go on.
    Row("stop", _COMMAND, stop_pressed, fact="stopped"),
    Row("record", _COMMAND, unrecorded_command, fact="unrecorded"),
    Row("unknown", (SubmitCommand,), not_offered, asked="unknown"),
    Row("driving", _COMMAND, not_watched, fact="driving", host=True),
    Row("arguments", (SubmitCommand,), wrong_arguments, asked="wrong"),
    Row("lane", (SubmitCommand,), faulted_lane, asked="faulted", host=True),
    Row("consent", (DispatchCommand,), without_consent, asked="person", host=True),
)


@cache
def all_rows() -> tuple[Row, ...]:
    """`TABLE` with the rows of features in their places."""
    rows = [*TABLE]
    for name, gate in pieces("gate", FeatureGate).items():
        for each in gate.rows:
            own = replace(each.row, feature=name)
            about = {*own.about}
            places = (
                at
                for at, row in enumerate(rows)
                if row.why_not is each.before and about & {*row.about}
            )
            rows.insert(next(places, len(rows)), own)
    return tuple(rows)


@cache
def features_judge_commands() -> bool:
    """Whether a feature has a row about commands."""
    return any(row.feature and {*row.about} & {*_COMMAND} for row in all_rows())


def rows_about(question: type, rows: Iterable[Row] | None = None) -> tuple[Row, ...]:
    """The rows that look at such a question, in their order."""
    return tuple(row for row in rows or all_rows() if question in row.about)


@cache
def _rows() -> dict[type, tuple[Row, ...]]:
    return {kind: rows_about(kind) for row in all_rows() for kind in row.about}


def why_not(facts: Facts, question: Question) -> Refusal | None:
    """Why it may not happen now; None: it may."""
    return first_refusal(_rows()[type(question)], facts, question)


def first_refusal(rows: Iterable[Row], facts: Facts, question: Question) -> Refusal | None:
    """What the first row says that forbids it. One that raises forbids, too, and is named."""
    for row in rows:
        if row.fact and not getattr(facts, row.fact):
            continue
        if row.asked and not getattr(question, row.asked):
            continue
        if row.feature and row.feature not in facts.features:
            continue
        try:
            refusal = row.why_not(facts, question)
        except Exception as error:
            if row.feature in facts.failed:
                continue  # named already, and the session has to go on
            log.exception("the row %r of the gate failed", row.name)
            reason = Sentence(
                "gate.check_failed",
                "the check of {check!r} failed: {error}",
                check=row.name,
                error=f"{type(error).__name__}: {error}",
            )
            whose = row.feature or "woz-tui"
            remedy = Sentence(
                "gate.error_in",
                "this is an error in {program}; the traceback is in the *.host.log",
                program=whose,
            )
            return Refusal("unchecked", reason, remedy)
        if refusal is not None:
            return refusal
    return None
