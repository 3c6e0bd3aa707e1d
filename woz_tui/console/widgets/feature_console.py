"""What features have on the wizard's screen."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from woz_tui.console.drawing.cells import Row
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.input.keyboard import KeyPress
from woz_tui.console.state.console_state import ConsoleState
from woz_tui.feature import answer_of, pieces
from woz_tui.protocol.requests import Request


def _always(state: ConsoleState) -> bool:
    return True


@dataclass(frozen=True, slots=True)
class KeyHint:
    """A key's word in the lowest line, where `worth` says so; the lower `rank`, the earlier."""

    rank: float
    word: str
    worth: Callable[[ConsoleState], bool] = _always


@dataclass(frozen=True, slots=True)
class FeatureCommand:
    """A command of the console: it sends its request, or plays the action of its key, if that has
    one, and then opens the dialog `opens`, if one is named (`module:Class`).

    `key`: the id of its key (`Feature.keys`). `sends`: makes the request; it counts `once` where
    the key is held down or pressed again at once. `calls`: a function `module:name` that is given
    the app instead. `hint`: how the lowest line names it; None: not at all. `watchers`: whether it
    is for those who only watch, too. `found`: whether the palette has it; `also`: words that find
    it there, beside its own.
    """

    key: str
    opens: str = ""
    sends: Callable[[KeyPress], Request] | None = None
    once: bool = True
    calls: str = ""
    hint: KeyHint | None = None
    watchers: bool = False
    found: bool = True
    also: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class DialogOffer:
    """The dialog `module:Class` opens by itself, once for each thing that it is `about`; empty: not
    at this console.
    """

    about: object
    opens: str


@dataclass(frozen=True, slots=True)
class Board:
    """Lines of its own above the panels.

    `lines`: how many, on a screen of so many lines; 0: none. `rows`: what stands there.
    """

    lines: Callable[[ConsoleState, int], int]
    rows: Callable[[ConsoleState, PaintFrame], Sequence[Row]]


@dataclass(frozen=True, slots=True)
class ActionOrder:
    """Actions that a key plays one after the other: at the bottom the next one, on a roomy screen
    all of them.

    `keys`: ids of the keys that the row at the bottom names; the first plays the next action.
    `heading`: above all of them. `nothing`: what stands at the bottom while there are none.
    `any`: whether the file has such an order, so that what the next action says gets lines of its
    own. `next`: the action that comes next; empty: none. `row`: how it stands at the bottom, given
    the keys as caps show them (none: in a replay); empty: there are none now. `rows`: all of them.
    """

    keys: tuple[str, ...]
    heading: str
    nothing: str
    any: Callable[[ConsoleState], bool]
    next: Callable[[ConsoleState], str]
    row: Callable[[ConsoleState, PaintFrame, Sequence[str]], Row]
    rows: Callable[[ConsoleState, PaintFrame], Sequence[Row]]


@dataclass(frozen=True, slots=True)
class AskedWords:
    """Something that is asked for before some actions are played.

    `lacking`: these actions, now, by name. `again`: whether an action's words, which it has now,
    can be asked for anew. `dialog`: `module:Class` of the dialog that asks and then plays, made
    with the action's name, the keys that were pressed, and whether they play the next line of the
    order. `rows`: how such an action's sentence stands at the bottom while it comes next.
    """

    lacking: Callable[[ConsoleState], Collection[str]]
    again: Callable[[ConsoleState, str], bool]
    dialog: str
    rows: Callable[[ConsoleState, PaintFrame, str], Sequence[Row]]


@dataclass(frozen=True, slots=True)
class ParticipantField:
    """A field of the participant's dialog: its name, and what can stand in it."""

    name: str
    hint: str


@dataclass(frozen=True, slots=True)
class ParticipantForm:
    """What the participant's dialog asks beside the code.

    `fields`: for this code. `request`: says what was typed of it, before the code is set.
    """

    fields: Callable[[ConsoleState, str], Iterable[ParticipantField]]
    request: Callable[[str, Mapping[str, str]], Request]


@dataclass(frozen=True, slots=True)
class FoundRequest:
    """What the palette finds by its `name`: a request, and in a word what it is about."""

    name: str
    what: str
    request: Request


@dataclass(frozen=True, slots=True)
class NextStep:
    """What a key goes on to: the key's id, and what that begins. `first`: there is nothing yet that
    it would go on from.
    """

    key: str
    begins: str
    first: bool = False


@dataclass(frozen=True, slots=True)
class UnderWay:
    """What is under way between trials, and how far it is, in words."""

    title: str
    progress: str


@dataclass(frozen=True, slots=True)
class FeatureStep:
    """What one key of the dialog of trials does: it sends its request, or opens the dialog
    `module:Class`, made with what it is `about`, if anything is named.
    """

    key: str
    text: str
    opens: str = ""
    about: str = ""
    request: Request | None = None


@dataclass(frozen=True, slots=True)
class BetweenTrials:
    """What a feature has between trials.

    `under_way`: what has to end before the next trial begins. `first`, `last`: its steps in the
    dialog of trials, before and behind those of trials. `offers`: the step whose dialog opens when
    a trial is over.
    """

    under_way: Callable[[ConsoleState], UnderWay | None]
    first: Callable[[ConsoleState], Iterable[FeatureStep]]
    last: Callable[[ConsoleState], Iterable[FeatureStep]]
    offers: Callable[[ConsoleState], FeatureStep | None]


@dataclass(frozen=True, slots=True)
class EndAnswer:
    """What becomes of something that is open when the wizard ends the session: a sentence, and the
    request that goes out before the end, if any, with the dialog `module:Class` in which it is
    seen to; then the end is asked again. `ends_trial`: the request has the trial under way done,
    and the end goes on.
    """

    sentence: str
    request: Request | None = None
    opens: str = ""
    ends_trial: bool = False


@dataclass(frozen=True, slots=True)
class EndQuestion:
    """Something that is open at the end, with what may become of it, the usual first. `key`: under
    which the choice is kept.
    """

    key: str
    answers: Sequence[EndAnswer]


@dataclass(frozen=True, slots=True)
class FeatureConsole:
    """What a feature has on the screen. Nothing in it may import Textual: dialogs are named.

    `commands`: what can be done with it. `status`: what stands at the right of the first status
    row, and is never left out. `present`: what stands in the second one, right of the drivers; a
    name in it has so many cells at the most. `following`: what its key goes on to, named beside it.
    `under_way`: what stands before the failures there; it is given the key that cuts what began
    last, and the cells that are left. `board`: lines above the panels. `offers`: the dialog that
    opens by itself now. `instead`: the dialog `module:Class` that opens now for a command of the
    console, by the id of its key, instead of what it does otherwise; empty: nothing, None: as
    otherwise. `finds`: what the palette finds beside its commands. `order`: what a key plays one
    after the other; of several features the first has it. `between`: what it has between trials.
    `at_end`: what is open when the session ends, also if the trial under way were done. `cut_off`:
    what the end would cut off, in sentences. `value`: what stands behind the trial in the first
    status row. `begins`: the id of the key of what is to begin before there is a script, and what,
    in words; without a key, why nothing is; None: as otherwise. `asks`: what it asks for
    before actions are played. `describes`: what it asks of participants. `shown`: requests that
    tell of what the last painting showed, given the whole screen; nobody reads their replies.
    """

    commands: tuple[FeatureCommand, ...] = ()
    status: Callable[[ConsoleState, PaintFrame], Row] | None = None
    under_way: Callable[[ConsoleState, PaintFrame, str, int], Row] | None = None
    board: Board | None = None
    offers: Callable[[ConsoleState], DialogOffer | None] | None = None
    instead: Mapping[str, Callable[[ConsoleState], str | None]] = field(default_factory=dict)
    present: Callable[[ConsoleState, PaintFrame, int], Row] | None = None
    following: Callable[[ConsoleState], NextStep | None] | None = None
    finds: Callable[[ConsoleState], Iterable[FoundRequest]] | None = None
    order: ActionOrder | None = None
    between: BetweenTrials | None = None
    at_end: Callable[[ConsoleState, bool], Iterable[EndQuestion]] | None = None
    cut_off: Callable[[ConsoleState], Iterable[str]] | None = None
    value: Callable[[ConsoleState], str] | None = None
    begins: Callable[[ConsoleState], tuple[str, str] | None] | None = None
    asks: AskedWords | None = None
    describes: ParticipantForm | None = None
    shown: Callable[[ConsoleState, PaintFrame], Iterable[Request]] | None = None


def between_trials() -> Iterator[tuple[str, BetweenTrials]]:
    """What features have between trials, by their names."""
    for name, console in pieces("console", FeatureConsole).items():
        if console.between is not None:
            yield name, console.between


def under_way(state: ConsoleState) -> UnderWay | None:
    """What has to end before the next trial begins."""
    found = (answer_of(name, None, each.under_way, state) for name, each in between_trials())
    return next((each for each in found if each is not None), None)
