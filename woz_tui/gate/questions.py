"""What the gate is asked about, and what it answers."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

from woz_tui.protocol.messages import Command, Json
from woz_tui.protocol.refusal import Refusal
from woz_tui.protocol.requests import Request

if TYPE_CHECKING:  # the console needs none of it for its first paint
    from woz_tui.drivers.contract import Verb


@dataclass(frozen=True, slots=True)
class RequestOrigin:
    """Where a request came from: whose hand, which key, which console."""

    source: str
    key: str = ""
    console: str = ""


class GatedCall(Protocol):
    """What counts here of a verb that an action sends, in the file or on the screen."""

    @property
    def verb(self) -> str:
        """Its name."""

    @property
    def args(self) -> Mapping[str, Json]:
        """Its arguments."""

    @property
    def driver(self) -> str:
        """To whom it goes."""


class GatedAction(Protocol):
    """What counts here of an action, in the file or on the screen."""

    @property
    def label(self) -> str:
        """What its button says."""

    @property
    def panel(self) -> str:
        """The title of its panel."""

    @property
    def locked(self) -> bool:
        """Whether the file locks it."""

    @property
    def calls(self) -> Sequence[GatedCall]:
        """What it sends."""


@dataclass(frozen=True, slots=True)
class ClientRequest:
    """A request of a console or a program, before anybody looks at what it is about.

    `stale`: why it is too old, in words; empty: it is not. Of a console that watches: `plays` is
    what it would play, `vacant` whether nobody does, `take_over` how it would in spite of others.
    """

    request: Request
    role: str
    stale: str = ""
    plays: str = ""
    vacant: bool = False
    take_over: str = ""


@dataclass(frozen=True, slots=True)
class ReleaseStop:
    """The release of the stop. `known`: drivers of which whoever asks knows that they have not
    confirmed it.
    """

    stale: str = ""
    known: Collection[str] = ()


@dataclass(frozen=True, slots=True)
class PlayAction:
    """An action by its name, from a key, a line of a script, a program, a phase; `action`: None
    where the file has none. `at`: the moment for which it is asked, 0: now. `beside_panels`:
    it is a feature's, and no panel's. `under_way`: its key counts once, and it waits or is running.
    `given`: variables of its sentences whose values come with the request; `text`: what is said in
    place of its first sentence.
    """

    name: str
    action: GatedAction | None
    origin: RequestOrigin
    stale: str = ""
    at: int = 0
    beside_panels: bool = False
    under_way: Literal["", "waits", "is running"] = ""
    given: Collection[str] = ()
    text: str = ""


@dataclass(frozen=True, slots=True)
class PlayEffect:
    """An action of a panel that the robot plays by itself when the engagement model says so."""

    name: str
    action: GatedAction


@dataclass(frozen=True, slots=True)
class SendVerb:
    """A verb by itself, from a hand or a program. `nobody`: why no driver can be named for it.
    `at` as in `PlayAction`; then `wrong` says what is wrong with its arguments.
    """

    verb: str
    args: Mapping[str, Json]
    driver: str
    origin: RequestOrigin
    stale: str = ""
    at: int = 0
    nobody: Refusal | None = None
    wrong: str = ""


@dataclass(frozen=True, slots=True)
class SendOwnVerb:
    """A verb that a driver asks for by itself: no hand is behind it."""

    nobody: Refusal | None = None


@dataclass(frozen=True, slots=True)
class SubmitCommand:
    """A command on its way into a lane. `verb`: as its driver offers it; None: it does not, and
    `unknown` says so. `wrong` is what is wrong with its arguments. `stoppable`: something could
    come of it while the stop is pressed. `faulted`: its lane does not respond.
    """

    command: Command
    verb: Verb | None
    unknown: str = ""
    wrong: str = ""
    stoppable: bool = True
    faulted: bool = False


@dataclass(frozen=True, slots=True)
class DispatchCommand:
    """A command that goes to its driver now. `person` (driver and name): whose face it learns, or
    whose consent it is about, which it `gives`; None: it has to do with nobody's face.
    """

    command: Command
    verb: Verb
    stoppable: bool = True
    person: tuple[str, str] | None = None
    gives: bool = False


Question = (
    ClientRequest
    | ReleaseStop
    | PlayAction
    | PlayEffect
    | SendVerb
    | SendOwnVerb
    | SubmitCommand
    | DispatchCommand
)
