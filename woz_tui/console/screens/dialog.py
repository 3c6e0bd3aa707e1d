"""What all dialogs share: a frame over the living screen, a hint, the way out, kept drafts.

Escape and ctrl+c stop the robot from every dialog and close it; the text typed so far is kept and
is there again when the dialog is opened the next time. ctrl+q closes without stopping.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Protocol, cast

from rich.console import RenderableType
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical, VerticalScroll
from textual.content import Content
from textual.css.styles import RulesMap
from textual.geometry import Size
from textual.screen import ModalScreen
from textual.strip import Strip
from textual.style import Style
from textual.suggester import Suggester
from textual.visual import RenderOptions, Visual, VisualType
from textual.widget import Widget
from textual.widgets import Input, Static

from woz_tui.config.screen_language import say, word
from woz_tui.console.drawing.cells import Row, clean, wrap_row
from woz_tui.console.drawing.partial_update import PartialScreen
from woz_tui.console.input.byte_scanner import PASTE_LIMIT
from woz_tui.console.input.keyboard import ConsoleKey
from woz_tui.protocol.requests import Reply
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:
    from woz_tui.config.keys.keymap import KeyMap
    from woz_tui.config.keys.terminals import Terminal
    from woz_tui.console.camera.picture_terminal import PictureTerminal
    from woz_tui.console.drawing.glyphs import Glyphs
    from woz_tui.console.drawing.key_caps import KeyCap
    from woz_tui.console.drawing.theme import Appearance
    from woz_tui.console.input.keyboard import Keyboard
    from woz_tui.console.link.message_feed import MessageFeed
    from woz_tui.console.link.robot_requests import RobotRequests
    from woz_tui.console.robot_settings.step_sizes import ArrowSteps
    from woz_tui.console.state.console_state import ConsoleState
    from woz_tui.console.widgets.feature_console import KeyHint
    from woz_tui.system.clock import Clock

#: Whom a command serves: the console that plays the robot; also one that watches; also a replay;
#: a replay alone.
WIZARD = frozenset({"wizard"})
WATCHER = WIZARD | {"watcher"}
EVERYBODY = WATCHER | {"replay"}
REPLAY = frozenset({"replay"})


@dataclass(frozen=True, slots=True)
class ConsoleCommand(ConsoleKey):
    """One thing the console does, beside playing the experiment's actions.

    Args:
        run: Carries it out, where the keyboard does not send a request.
        hint: How the lowest line names it; None: not at all.
        found: Whether the palette lists it.
        also: Words that find it there, beside its own.
        users: The roles it serves.
    """

    run: Callable[[ConsoleApp], object] | None = None
    hint: KeyHint | None = None
    found: bool = True
    also: tuple[str, ...] = ()
    users: frozenset[str] = WIZARD

    def serves(self, role: str) -> bool:
        """Whether it does something for this role; one that is not known yet is the wizard's."""
        return (role if role in EVERYBODY else "wizard") in self.users


class ConsoleApp(Protocol):
    """What dialogs and commands may use of the app."""

    state: ConsoleState
    feed: MessageFeed
    requests: RobotRequests
    keyboard: Keyboard
    arrows: ArrowSteps
    clock: Clock
    look: Appearance
    theme: str
    terminal: Terminal
    #: Commands by the ids of their keys; all keys as they are bound now; the caps of actions.
    commands: Mapping[str, ConsoleCommand]
    keymap: KeyMap
    caps: Mapping[str, KeyCap]
    #: How a camera's pictures are drawn, and what they need to know of the terminal.
    pictures: str
    picture_terminal: PictureTerminal | None
    #: Starts the robot process again after it was lost; None if nobody can.
    restart: Callable[[], None] | None

    @property
    def size(self) -> Size:
        """Columns and lines of the screen."""

    @property
    def dialog(self) -> Dialog | None:
        """The dialog on top."""

    @property
    def stop_pending(self) -> bool:
        """Whether a stop was sent from here that has not been answered yet."""

    def open_dialog(self, dialog: Dialog) -> None:
        """Put it on top."""

    def close_dialog(self, dialog: Dialog | None = None) -> None:
        """Close `dialog`, or whichever is on top."""

    def give_keys(self) -> None:
        """The dialog on top has other keys of its own than before."""

    def do(self, name: str) -> None:
        """Carry out a command."""

    def ask_words(self, action: str, keys: str, *, of_order: bool = False) -> None:
        """Ask for what an action lacks, or anew for what it has, and then play it. `keys`: those
        that were pressed; `of_order`: they play what comes next in the order of actions.
        """

    def key_of(self, name: str) -> str:
        """The key to press for a command; empty: it has none."""

    def news(self, text: str, look: str = "muted") -> None:
        """Say a sentence above the hints."""

    def explain_loss(self, why: str) -> None:
        """What becomes of a lost robot process."""

    def paint(self) -> None:
        """Show what has changed."""

    def walk(self, by: int) -> None:
        """Choose another panel."""

    def filter_events(self) -> None:
        """Show the next selection of the events."""

    def refresh(self, *, layout: bool = False) -> object:
        """Draw every cell again."""

    def exit(self, result: str | None = None) -> None:
        """Leave the console: `ended`, `detached`, `lost`, `left`."""


_STYLES = {
    "plain": "",
    "muted": "$woz-muted",
    "strong": "bold $woz-strong",
    "title": "bold $woz-title",
    "key": "bold $woz-key on $woz-key-ground",
    "run": "$woz-run",
    "good": "$woz-good",
    "warn": "$woz-warn",
    "bad": "bold $woz-bad",
}


def content(rows: Iterable[Row]) -> Content:
    """Rows as text that wraps."""
    pieces: list[Content | str | tuple[str, str]] = []
    for number, row in enumerate(rows):
        if number:
            pieces.append("\n")
        for text, look in row:
            style = _STYLES.get(look, "")
            pieces.append((clean(text), style) if style else clean(text))
    return Content.assemble(*pieces)


def plain(text: str) -> Content:
    """A text from anywhere on one line, for what would read a `str` as markup."""
    return content([((text, "plain"),)])


class Dialog(PartialScreen[None], ModalScreen[None]):
    """A framed dialog. Subclasses give `heading`, `hint` and `body`; sentences are worded here."""

    heading: str = ""
    hint: ClassVar[str] = Sentence("dialog.closes", "ctrl+q closes")
    #: Class of the frame: `wide`, `drawing`, or nothing for a narrow one.
    size_class: ClassVar[str] = ""
    #: Whether the robot is played while it is open; it then has no keys of its own but these, in
    #: the normal form of keys. Whoever changes them calls the app's `give_keys`.
    plays: ClassVar[bool] = False
    own_keys: frozenset[str] = frozenset()
    #: Whether any other key closes it, beside what the key does.
    ends_with_key: ClassVar[bool] = False
    #: Whether a field in it has the keyboard.
    typed_into = False
    #: The command that opened it, which closes it where the robot is played meanwhile.
    opened_by = ""

    @property
    def console_app(self) -> ConsoleApp:
        """What a dialog may use of the app."""
        return cast("ConsoleApp", self.app)

    @property
    def is_on_top(self) -> bool:
        """Whether it has not been closed: messages that it sent itself may come after that."""
        return self.console_app.dialog is self

    @property
    def requests(self) -> RobotRequests:
        return self.console_app.requests

    @property
    def state(self) -> ConsoleState:
        return self.console_app.state

    @property
    def glyphs(self) -> Glyphs:
        return self.console_app.look.glyphs

    @property
    def now(self) -> int:
        """The session's time, in microseconds."""
        return self.state.now(self.console_app.clock.now_us())

    def compose(self) -> ComposeResult:
        """The frame with its heading, the body, the hint on the lower edge."""
        with Vertical(classes=f"dialog {self.size_class}") as box:
            box.border_title = word(self.heading)
            box.border_subtitle = self.glyphs.plain(word(self.hint))
            yield from self.body()

    def show_hint(self, hint: str) -> None:
        """Write another hint on the lower edge."""
        for box in self.query(".dialog"):
            box.border_subtitle = self.glyphs.plain(word(hint))

    def update(self, name: str, text: VisualType) -> None:
        """Show `text` in the `Static` called `name`; a stop may come before there is one."""
        for place in self.query(f"#{name}").results(Static):
            place.update(text)

    def on_mount(self) -> None:
        """What has changed since the body was made is shown now."""
        self.call_after_refresh(self.refreshed)

    def body(self) -> Iterable[Widget]:
        """What stands inside the frame."""
        raise NotImplementedError

    def takes_late(self, chord: str) -> bool:
        """Whether a key still counts that came late, in a burst: what is typed is not lost, but
        nothing is done by it. Called from the thread that reads keys.
        """
        return self.typed_into and chord != "enter"

    def leave(self) -> None:
        """Close this dialog."""
        self.console_app.close_dialog(self)

    def closing(self) -> None:
        """Called before it goes, for whatever reason; keeps drafts."""

    def refreshed(self) -> None:
        """Called after each painting of the screen beneath; for what changes while it is open."""

    def displayed(self, update: RenderableType | None) -> None:
        """Called after each writing to the terminal; for what is drawn beside Textual."""


class WrappedRows(Visual):
    """Rows as text that wraps; a row goes on `indent` cells to the right of its beginning."""

    def __init__(self, rows: Iterable[Row], indent: int) -> None:
        self._rows, self._indent = tuple(rows), indent
        self._last: tuple[int, Content] | None = None

    def _text_for(self, width: int) -> Content:
        """The text for this width; asked for several times in a row."""
        if self._last is None or self._last[0] != width:
            rows = [part for row in self._rows for part in wrap_row(row, self._indent, width)]
            self._last = width, content(rows)
        return self._last[1]

    def render_strips(
        self, width: int, height: int | None, style: Style, options: RenderOptions
    ) -> list[Strip]:
        """As `Content` does."""
        return self._text_for(width).render_strips(width, height, style, options)

    def get_optimal_width(self, rules: RulesMap, container_width: int) -> int:
        """Each row on one line."""
        return content(self._rows).get_optimal_width(rules, container_width)

    def get_height(self, rules: RulesMap, width: int) -> int:
        return self._text_for(width).get_height(rules, width)


class ReportDialog(Dialog):
    """A dialog of text to read: rows, scrolled with the arrows."""

    #: Where the lines go on that a long row takes beyond its first.
    indent: ClassVar[int] = 0

    def body(self) -> Iterable[Widget]:
        yield VerticalScroll(Static(WrappedRows(self.lines(), self.indent), id="report"))

    def lines(self) -> list[Row]:
        """What it says."""
        raise NotImplementedError

    def renew(self) -> None:
        """Say it again after something has changed; before it is composed there is no need."""
        self.update("report", WrappedRows(self.lines(), self.indent))


class LiveReportDialog(ReportDialog):
    """A dialog of text that follows what happens while it is open."""

    _shown: Sequence[Row] = ()

    def refreshed(self) -> None:
        """Show a change at once."""
        if (rows := self.lines()) != self._shown:
            self._shown = rows
            self.renew()


class Completion(Suggester):
    """Pale letters behind what is typed: `complete` gives the whole text, or None."""

    def __init__(self, complete: Callable[[str], str | None]) -> None:
        super().__init__(use_cache=False, case_sensitive=True)
        self._complete = complete

    async def get_suggestion(self, value: str) -> str | None:
        """As the text field asks for it."""
        return self._complete(value)


class EntryDialog(Dialog):
    """A dialog with one text field whose text is kept as a draft until it is sent."""

    placeholder: ClassVar[str] = ""
    #: What enter sends where nothing is typed; empty: it only closes.
    default: ClassVar[str] = ""
    typed_into = True
    _back = 0

    @property
    def draft(self) -> str:
        """Name under which the text is kept."""
        return type(self).__name__

    def body(self) -> Iterable[Widget]:
        yield Input(
            self.requests.drafts.get(self.draft, ""),
            placeholder=word(self.placeholder),
            max_length=PASTE_LIMIT,
            select_on_focus=False,
            id="entry",
        )
        yield from self.below()

    def below(self) -> Iterable[Widget]:
        """What stands under the field."""
        return ()

    @property
    def there(self) -> bool:
        """Whether the field exists: a stop may close a dialog before it has been put together,
        and Textual then still tells it that it is mounted.
        """
        return bool(self.query("#entry"))

    @property
    def entry(self) -> Input:
        return self.query_one("#entry", Input)

    def closing(self) -> None:
        """Keep what was typed; a stop may come before there is a field."""
        for entry in self.query("#entry").results(Input):
            self.requests.drafts[self.draft] = entry.value

    @property
    def history(self) -> Sequence[str]:
        """What was typed before, the newest last."""
        return ()

    def action_history(self, by: int) -> None:
        """Walk through what was typed before; down from the newest is the empty line."""
        self._back = max(0, min(len(self.history), self._back - by))
        self.set_text(self.history[-self._back] if self._back else "")

    def set_text(self, text: str, caret: int | None = None) -> None:
        """Put a text into the field; the caret goes to its end."""
        self.entry.value = text
        self.entry.cursor_position = len(text) if caret is None else caret

    def on_input_changed(self, event: Input.Changed) -> None:
        event.stop()
        if self.there:
            self.changed(event.value)

    def changed(self, typed: str) -> None:
        """What stands in the field is new."""

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Enter was pressed; a second one behind it has nothing to send."""
        event.stop()
        if self.is_on_top:
            self.accept(event.value.strip())

    def accept(self, typed: str) -> None:
        """Carry out what was typed, forget it and close."""
        if text := typed or self.default:
            self.submit(text)
        self.sent()

    def submit(self, text: str) -> None:
        """Carry out what was typed."""
        raise NotImplementedError

    def sent(self) -> None:
        """The text did its work: forget it and close."""
        self.entry.value = ""
        self.leave()


class CompletionDialog(EntryDialog):
    """A text for one of several robots that is completed: what matches stands below the field, and
    who gets it.
    """

    size_class = "wide"
    #: What they do with it, and what they are called here.
    verb: ClassVar[str]
    word: ClassVar[str]
    #: The driver that gets it: the one that is named, whoever plays which robot meanwhile.
    robot = ""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("tab", "complete", priority=True),
        Binding("up", "history(-1)", priority=True),
        Binding("down", "history(1)", priority=True),
        Binding("ctrl+o", "other", priority=True),
    ]

    def below(self) -> Iterable[Widget]:
        """What matches, and for whom it is."""
        yield Static("", id="matches", classes="caption")
        yield Static("", id="robot", classes="caption")

    def on_mount(self) -> None:
        """One's own robot first."""
        if self.there:
            self.action_other()

    def action_other(self) -> None:
        robots = self.robots
        if robots:
            at = robots.index(self.robot) + 1 if self.robot in robots else 0
            self.robot = robots[at % len(robots)]
        many = ""
        if len(robots) > 1:
            many = say(
                "dialog.another",
                "{word}: {robot}  (ctrl+o: another)",
                word=word(self.word),
                robot=self.robot,
            )
        self.update("robot", plain(many))
        self.adopt()

    @property
    def robots(self) -> list[str]:
        """Drivers that can do it, those of one's own robot first."""
        own = self.state.own_verbs
        able = [name for name, verbs in self.state.verbs.items() if self.verb in verbs]
        return sorted(able, key=lambda name: self.verb not in own[name])

    def adopt(self) -> None:
        """Offer what `robot` can do."""
        raise NotImplementedError


def refusal_text(reply: Reply) -> str:
    """Why something was not done, and what helps."""
    return ": ".join(part for part in (reply.reason, reply.hint) if part)


class FormDialog(Dialog):
    """A dialog of several fields that stays open until what stands in them is accepted."""

    typed_into = True

    def answered(self, reply: Reply) -> None:
        """Close, or say why not."""
        if reply.ok:
            self.leave()
        else:
            self.complain(refusal_text(reply))

    def complain(self, wrong: str) -> None:
        """Say what is wrong in the field `#wrong`; nothing, if nothing is."""
        self.update("wrong", plain(wrong))
