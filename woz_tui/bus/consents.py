"""Whose face which driver may learn: only of people who have said in this session that it may.

`Verb.needs_consent` marks what learns a face. A consent is the command `face_consent: NAME` of the
same driver, done: so it is in the log before anything is learnt. It comes from a step of the
experiment file that a person plays at a console or at a panel of the robot, or from the robot that
has asked for it in a handshake. A verb that somebody sends by itself gives none, and no program
does. Anybody may withdraw one, and that counts from the moment at which it is asked for, even if
the driver cannot delete anything then.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from woz_tui.bus.hub import Hub
from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.drivers.contract import FACE_CONSENT, Verb, gives_consent
from woz_tui.drivers.face_store import key_of
from woz_tui.protocol.action_messages import BY_PERSON
from woz_tui.protocol.messages import AnyMessage, Command, Done, End

#: A driver, and a person's name as `key_of` has it.
_Person = tuple[str, str]


@dataclass(frozen=True, slots=True)
class ConsentRefusal:
    """Why a command may not go out. It does not say whose consent it is about."""

    reason: str
    remedy: str


@dataclass
class Consents:
    """The consents of a session, as the hub's messages tell of them."""

    hub: Hub
    _given: set[_Person] = field(default_factory=set)
    #: Commands under way that give a consent, and those that use one up.
    _giving: dict[str, _Person] = field(default_factory=dict)
    _using: dict[str, _Person] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.hub.listen(self._on_message)

    def given(self, driver: str, name: str) -> bool:
        """Whether `driver` may learn the face of `name` now."""
        return (driver, key_of(name)) in self._given

    def refusal(self, command: Command, verb: Verb) -> ConsentRefusal | None:
        """Why `command` may not go out to its driver; None: it may. Asked just before it does."""
        if verb.name == FACE_CONSENT:
            if gives_consent(command.verb, command.args) and not self._is_from_person(command):
                return ConsentRefusal(
                    "no person has given this consent",
                    f"let the wizard play a step `{FACE_CONSENT}: NAME` of the experiment file",
                )
        elif verb.needs_consent:
            person = _person(command, verb.arguments[0].name if verb.arguments else "")
            if person not in self._given:
                return ConsentRefusal(
                    "this person has not consented to having their face learnt",
                    f"ask them, then play a step `{FACE_CONSENT}: NAME`, with the same name",
                )
            self._using[command.command] = person
        return None

    def _is_from_person(self, command: Command) -> bool:
        if command.action:
            return command.source in BY_PERSON
        # Whatever comes over a connection names it: no program can pass for the handshake.
        return command.source == ENGAGEMENT and not (command.console or command.run)

    def _on_message(self, message: AnyMessage) -> None:
        match message:
            case Command(verb=verb) if verb == FACE_CONSENT:
                person = _person(message, "name")
                if gives_consent(verb, message.args):
                    self._giving[message.command] = person
                else:
                    self._given.discard(person)
            case End(command=command):
                gives, uses = self._giving.pop(command, None), self._using.pop(command, None)
                if isinstance(message, Done):
                    self._given |= {gives} if gives else set()
                    self._given -= {uses} if uses else set()


def _person(command: Command, argument: str) -> _Person:
    return command.driver, key_of(str(command.args.get(argument, "")))
