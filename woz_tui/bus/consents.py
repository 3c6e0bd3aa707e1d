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
from woz_tui.drivers.contract import FACE_CONSENT, Verb, gives_consent
from woz_tui.drivers.face_store import key_of
from woz_tui.protocol.messages import Command, Done, End, Message

#: A driver, and a person's name as `key_of` has it.
Person = tuple[str, str]


@dataclass
class Consents:
    """The consents of a session, as the hub's messages tell of them."""

    hub: Hub
    #: Who has consented, and to whom.
    people: set[Person] = field(default_factory=set)
    #: Commands under way that give a consent, and those that use one up.
    _giving: dict[str, Person] = field(default_factory=dict)
    _using: dict[str, Person] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.hub.listen(self._on_message, Command, End)

    def given(self, driver: str, name: str) -> bool:
        """Whether `driver` may learn the face of `name` now."""
        return (driver, key_of(name)) in self.people

    def use(self, command: Command, person: Person) -> None:
        """A command that needs one goes to its driver."""
        self._using[command.command] = person

    def _on_message(self, message: Message) -> None:
        match message:
            case Command(verb=verb) if verb == FACE_CONSENT:
                person = _person(message, "name")
                if gives_consent(verb, message.args):
                    self._giving[message.command] = person
                else:
                    self.people.discard(person)
            case End(command=command):
                gives, uses = self._giving.pop(command, None), self._using.pop(command, None)
                if isinstance(message, Done):
                    self.people |= {gives} if gives else set()
                    self.people -= {uses} if uses else set()


def person_of(command: Command, verb: Verb) -> Person | None:
    """Whose face a command learns, or who says whether it may be; None: it has to do with none."""
    if verb.name == FACE_CONSENT:
        return _person(command, "name")
    if not verb.needs_consent:
        return None
    return _person(command, verb.arguments[0].name if verb.arguments else "")


def _person(command: Command, argument: str) -> Person:
    return command.driver, key_of(str(command.args.get(argument, "")))
