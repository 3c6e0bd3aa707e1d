"""What an experiment is, once its file has been read and found right.

Everything here is frozen and complete: names are resolved, defaults filled in, paths absolute,
keys in their normal form (see `config/keys/`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.file_position import NOWHERE, FilePosition, Problem
from woz_tui.config.study import Study
from woz_tui.drivers.contract import Offer
from woz_tui.drivers.fields import Doc, Entry, NotBlank, Range, Seconds
from woz_tui.network.listen_address import DRIVERS_LISTEN
from woz_tui.protocol.messages import Json
from woz_tui.protocol.sentence import Sentence
from woz_tui.protocol.welcome import STALE_S


@dataclass(frozen=True, slots=True)
class DriverPlace(Entry):
    """Another computer of the robot, which has a driver's hardware."""

    what = Sentence("check.another_computer", "another computer")
    example = "at: arm-pi"

    name: Annotated[str, NotBlank(), Doc("the computer's name, as in its access file")]
    listen: Annotated[str, Doc("where this computer lets it in: HOST:PORT")] = DRIVERS_LISTEN


#: In which process a driver runs.
OWN_PROCESS, SHARED_PROCESS = "own", "shared"


@dataclass(frozen=True, slots=True)
class DriverSpec:
    """One driver of a robot: its name (`head`, or `left.head` with several robots), the entry
    point it comes from, its decoded settings, what it offers with them; `at`: its hardware is at
    another computer; `process`: whether it runs in one of its own (`OWN_PROCESS`), in that of the
    session (`SHARED_PROCESS`), or goes with those that it works with (empty).
    """

    name: str
    type: str
    settings: Any
    offer: Offer
    place: FilePosition
    at: DriverPlace | None = None
    process: str = ""

    @property
    def simulated(self) -> bool:
        """Whether it drives no hardware: the simulated robot, or one whose address says so."""
        address = getattr(self.settings, "address", "")
        return "simulated" in (self.type, address)

    @property
    def kind(self) -> str:
        """Its type, and where its hardware is if that is another computer."""
        return self.type if self.at is None else f"{self.type}, at {self.at.name}"


#: Names the variants for whatever else the deciding variable is.
ELSE = "else"


@dataclass(frozen=True, slots=True)
class TextVariants:
    """A text that is chosen when its action is played: condition -> its variants. One that does not
    depend on the condition has them under an empty name. `by`: the variable that decides instead of
    the condition; `else` has the variants where it has none of these values, or none.
    """

    texts: Mapping[str, tuple[str, ...]]
    by: str = ""

    @property
    def depends(self) -> bool:
        """Whether the condition decides."""
        return not self.by and "" not in self.texts

    @property
    def every(self) -> tuple[str, ...]:
        return tuple(text for variants in self.texts.values() for text in variants)

    def of(self, values: Mapping[str, str]) -> tuple[str, ...]:
        """The variants with these values of the variables; nothing if the condition is none of
        those that the file names.
        """
        if self.by:
            return self.texts.get(values.get(self.by, ""), self.texts[ELSE])
        return self.texts.get(values.get("condition", "") if self.depends else "", ())


#: What a step may wait for beside the ends of its commands.
ARRIVED = "arrived"


@dataclass(frozen=True, slots=True)
class Call:
    """One verb, its checked arguments (variables still in place), the driver it goes to.

    `choices` are the arguments that are chosen when it is played; they are not in `args` before.
    `tells` and `unfilled` as in `messages.Command`, once the variables are filled in. `until`: what
    a step waits for; empty: the command's end; `arrived`: the motion's.
    """

    verb: str
    args: Mapping[str, Json]
    driver: str
    place: FilePosition = NOWHERE
    tells: tuple[str, ...] = ()
    unfilled: Mapping[str, Json] = field(default_factory=dict)
    choices: Mapping[str, TextVariants] = field(default_factory=dict)
    until: str = ""


@dataclass(frozen=True, slots=True)
class Wait:
    """A pause between steps, in seconds."""

    seconds: float


@dataclass(frozen=True, slots=True)
class LeftOut:
    """What a robot that plays the file instead of the file's own does not do: `what` is a verb or
    an argument of one (`play.amplitude`).
    """

    what: str
    why: str


@dataclass(frozen=True, slots=True)
class ParallelCalls:
    """Calls that begin at the same moment; the step ends when the last one has ended."""

    calls: tuple[Call, ...]
    left_out: tuple[LeftOut, ...] = ()


Step = ParallelCalls | Wait


@dataclass(frozen=True, slots=True)
class Action:
    """What one key does: steps, one after the other.

    `name` is unique in the experiment and is what the file and programs call it by.
    `when_busy`: queue, replace or refuse; empty: queue, but its own key counts once while it runs
    or waits. `locked`: shown but never played. `then`: actions that are likely to follow it.
    """

    name: str
    label: str
    key: str
    panel: str
    steps: tuple[Step, ...]
    place: FilePosition
    when_busy: str = ""
    help: str = ""
    locked: bool = False
    then: tuple[str, ...] = ()

    @property
    def calls(self) -> list[Call]:
        """All calls of all its steps, in their order."""
        return [
            call for step in self.steps if isinstance(step, ParallelCalls) for call in step.calls
        ]

    @property
    def left_out(self) -> list[LeftOut]:
        """What of it this robot does not do, each once."""
        steps = [step for step in self.steps if isinstance(step, ParallelCalls)]
        return [*dict.fromkeys(one for step in steps for one in step.left_out)]


@dataclass(frozen=True, slots=True)
class Panel:
    """A titled group of actions; `locked` panels take no input at all until unlocked.

    `covers`: verbs that nobody's hand may send by itself either while the panel is locked: not by
    the console's own keys, not from the palette, a control panel or a program.
    `parts`: whose it is where several wizards play (see `protocol.panel_players`); none: it names
    nobody.
    """

    title: str
    actions: tuple[Action, ...]
    place: FilePosition
    locked: bool = False
    covers: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ArrowKeySteps:
    """How far one press of an arrow key goes."""

    head: Annotated[float, Range(0.1, 90, "°"), Doc("angle of the head for one step")] = 5.0
    hip: Annotated[float, Range(0.1, 45, "°"), Doc("angle of the hip for one step")] = 3.0
    drive: Annotated[float, Range(0.01, 5, "m"), Doc("distance of the base for one step")] = 0.1
    turn: Annotated[float, Range(1, 360, "°"), Doc("angle of the base for one step")] = 10.0


#: What somebody may be who joins from another machine.
AccessRole = Literal["wizard", "program", "watcher", "participant"]


@dataclass(frozen=True, slots=True)
class SessionSettings:
    """How a session is run."""

    #: Seconds without any console before the robot rests and the session ends.
    abandon_after: Annotated[
        float,
        Seconds(5.0),
        Doc(
            "the session ends after this time without a console; until the first wizard comes,"
            " a program counts as one"
        ),
    ] = 600.0
    #: Seconds a key press may wait in a queue before it is refused as late.
    deadline: Annotated[
        float, Seconds(0.1, 600.0), Doc("longest time that a key press can wait in a queue")
    ] = 10.0
    #: Seconds a press may take from the terminal to the robot before it counts as stale.
    stale_after: Annotated[
        float, Seconds(0.1, 60.0), Doc("age above which a key press is refused")
    ] = STALE_S
    #: Seconds without a beat of the wizard's console before driving stops.
    dead_man: Annotated[
        float, Seconds(1.0, 60.0), Doc("driving stops after this time without the console")
    ] = 3.0
    #: How keys drive. `auto`: by a held key where the console is inside tmux, screen or mosh, which
    #: hide that the wizard's line is lost, and by one press elsewhere.
    driving: Annotated[
        Literal["auto", "held", "pressed"],
        Doc(
            "keys drive while they are `held`, or as far as one press says (`pressed`); `auto`:"
            " `held` inside tmux, screen and mosh, else `pressed`"
        ),
    ] = "auto"
    #: Name of an access file -> as what its owner may join from another machine.
    access: Annotated[
        Mapping[str, AccessRole],
        Doc("roles of those who may join from another machine, by the name of their access file"),
    ] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Engagement:
    """The section `engagement`: settings, and what happens when a state is entered.

    `effects`: state -> an action without a key, whose name is `on <state>`. `plays`: state -> names
    of actions of the panels, which are played as they stand there.
    """

    settings: EngagementSettings = field(default_factory=EngagementSettings)
    effects: Mapping[str, Action] = field(default_factory=dict)
    plays: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Experiment:
    """A whole experiment, ready to run."""

    title: str
    path: Path
    #: SHA-256 of all `files`, one behind the other.
    sha256: str
    drivers: tuple[DriverSpec, ...]
    panels: tuple[Panel, ...]
    #: The robot that plays it instead of the one that the file names; empty: none.
    robot: str = ""
    #: Regular expression that participant codes match as a whole.
    participant_pattern: str = "[A-Za-z0-9]{1,16}"
    conditions: tuple[str, ...] = ()
    #: Values for `{name}` in utterances, beside the built-in participant, condition and session.
    variables: Mapping[str, str] = field(default_factory=dict)
    #: Those whose value depends on the condition: name -> condition -> text.
    by_condition: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    #: Keyboard layout: us, gb, de, es, fr ...
    keyboard: str = "us"
    #: In which the console speaks to participants.
    language: str = "en"
    #: Actions of features; a feature plays those without steps.
    beside_panels: tuple[Action, ...] = ()
    session: SessionSettings = field(default_factory=SessionSettings)
    #: Sensors, and `engagement` or `pose`, that stand first among the meters.
    sensors: tuple[str, ...] = ()
    #: Of the arrow keys.
    steps: ArrowKeySteps = field(default_factory=ArrowKeySteps)
    #: What the sections of features say (`feature_section.FeatureSection`), by section.
    sections: Mapping[object, Any] = field(default_factory=dict)
    #: How the robot tells whether somebody is with it; None: it does not.
    engagement: Engagement | None = None
    #: The study around it: preflight, perception.
    study: Study = field(default_factory=Study)
    #: Every file that was read, for the hash and for watching.
    files: tuple[Path, ...] = ()
    #: The text of each of `files`.
    texts: tuple[str, ...] = ()
    #: SHA-256 of the bytes of each of `files`, hexadecimal.
    files_sha256: tuple[str, ...] = ()
    warnings: tuple[Problem, ...] = ()

    @property
    def file_sha256(self) -> str:
        """SHA-256 of the experiment file's bytes; empty for an experiment without a file."""
        return next(iter(self.files_sha256), "")

    @property
    def actions(self) -> list[Action]:
        """All actions: those of the panels and beside them, what entering a state plays."""
        effects = self.engagement.effects.values() if self.engagement is not None else ()
        of_panels = [action for panel in self.panels for action in panel.actions]
        return [*of_panels, *self.beside_panels, *effects]

    @property
    def parts(self) -> list[str]:
        """The parts that wizards can play, in the order in which panels name them."""
        return [*dict.fromkeys(part for panel in self.panels for part in panel.parts)]

    def action(self, name: str) -> Action | None:
        """The action called `name`, or None."""
        for panel in self.panels:
            for action in panel.actions:
                if action.name == name:
                    return action
        return next((action for action in self.beside_panels if action.name == name), None)

    def driver(self, name: str) -> DriverSpec | None:
        """The driver called `name`, or None."""
        return next((spec for spec in self.drivers if spec.name == name), None)
