"""Console app: takes messages in, paints the screen, opens dialogs, passes keys on."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

from rich.console import RenderableType
from textual import events
from textual.app import ComposeResult
from textual.screen import Screen

from woz_tui.config.keys.console_keys import BuiltinKey, builtin_keys_with
from woz_tui.config.keys.keymap import key_map
from woz_tui.config.keys.terminals import PLAIN, STOPS, Terminal
from woz_tui.config.keys.textual_names import from_textual
from woz_tui.config.screen_language import say, word
from woz_tui.console.commands import COMMANDS, by_key, calls, hints, open_named
from woz_tui.console.drawing.cells import clean
from woz_tui.console.drawing.glyphs import PaintFrame
from woz_tui.console.drawing.key_caps import KeyCap, cap_of, caption, key_name
from woz_tui.console.drawing.partial_update import cropped
from woz_tui.console.input.keyboard import KeyPress
from woz_tui.console.link.message_feed import Incoming, Loss, MessageFeed
from woz_tui.console.link.robot_requests import RobotRequests, press_to
from woz_tui.console.robot_settings.step_sizes import ArrowSteps
from woz_tui.console.screen_app import PAINT_S, ScreenApp
from woz_tui.console.screens.dialog import ConsoleCommand, Dialog
from woz_tui.console.state.event_sentences import EventLine
from woz_tui.console.state.feature_notes import StudyNews
from woz_tui.console.state.remedy_text import remedy_text
from woz_tui.console.widgets.bottom_rows import (
    BarInfo,
    News,
    asked_words,
    asks_again,
    order_keys,
    upcoming,
)
from woz_tui.console.widgets.event_list import act_text
from woz_tui.console.widgets.feature_console import FeatureConsole, NextStep
from woz_tui.console.widgets.main_screen import MainScreen
from woz_tui.console.widgets.meters import turned_away
from woz_tui.console.widgets.status_rows import StatusInfo
from woz_tui.feature import answer_of, answers_of, pieces
from woz_tui.protocol.camera_pictures import PictureShown
from woz_tui.protocol.messages import (
    ConsoleAttached,
    ConsoleLost,
    DriverHealth,
    Mistake,
    SessionStart,
    StopPressed,
    StopReleased,
)
from woz_tui.protocol.requests import AskAction, Reply, Welcome
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:
    from woz_tui.console.camera.picture_terminal import PictureTerminal
    from woz_tui.console.input.keyboard import ConsoleKey, Keyboard

#: Seconds a sentence above the hints stays.
NEWS_S = 8.0
#: What a robot lacks whose drivers do not offer the verb of an arrow key.
_LACKS = {
    "nudge": Sentence("app.no_head", "This robot has no head that can turn (gaze)"),
    "drive": Sentence("app.no_drive", "This robot has no drive"),
    "hip": Sentence("app.no_hip", "This robot has no hip to bend"),
}
#: The same of several robots.
_ALL_LACK = {
    "nudge": Sentence("app.no_heads", "No robot here has a head that can turn (gaze)"),
    "drive": Sentence("app.no_drives", "No robot here has a drive"),
    "hip": Sentence("app.no_hips", "No robot here has a hip to bend"),
}
#: What closes every dialog, as its hint says, wherever a keymap has put `leave`.
CLOSES = "ctrl+q"
#: Seconds a pressed key cap stays lit.
FLASH_S = 0.25


class Console(ScreenApp):
    """The wizard's screen.

    Returns how it was left: `ended`, `detached` or `lost`.

    Args:
        feed: Where messages come from and requests go.
        keyboard: What happens to keys.
        terminal: What this terminal can send.
        builtins: The console's own keys where the wizard's keymap file has moved them.
        commands: What can be done beside playing actions.
        restart: Starts the robot process again after it was lost; None if nobody can.
        ask_participant: Whether to ask for participant and condition when a session starts.
        greets: Whether to say how to stop and how to leave: somebody sees this for the first time.
        pictures: How a camera's pictures are drawn (see `camera.picture_widgets.view_for`).
        options: As for `ScreenApp`.
    """

    def __init__(
        self,
        feed: MessageFeed,
        keyboard: Keyboard,
        *,
        terminal: Terminal = PLAIN,
        builtins: Sequence[BuiltinKey] = (),
        commands: Sequence[ConsoleCommand] = COMMANDS,
        restart: Callable[[], None] | None = None,
        ask_participant: bool = False,
        greets: bool = False,
        pictures: str = "auto",
        **options: Any,
    ) -> None:
        super().__init__(feed, keyboard, **options)
        self.pictures = pictures
        self.picture_terminal: PictureTerminal | None = None
        self.terminal = terminal
        self.commands: Mapping[str, ConsoleCommand] = by_key(commands)
        own = [key for command in commands for key in command.keys if key.chord]
        self._builtins = builtins or own
        self.keymap = key_map((), terminal, builtins=self._builtins)
        self.caps: Mapping[str, KeyCap] = {}
        self.arrows = ArrowSteps(keyboard)
        self.requests = RobotRequests(
            feed,
            self.state,
            news=self.news,
            key=self._key,
            later=self.call_later,
            over=functools.partial(self.exit, "ended"),
        )
        keyboard.bind({}, self._own_keys())
        self.restart = restart
        #: What to warn of when the session is there for the first time, and what helps.
        self.greeting = ("", "")
        self.ask_participant = ask_participant
        self._greets = greets
        #: How the session began in which it was asked; its log may change its name.
        self._asked_in: SessionStart | None = None
        self._edition = 0
        #: What features offered a dialog about last.
        self._offered: dict[str, object] = {}
        self._was_lost = self._was_stopped = self._alt_told = False
        self._lost_t = 0
        self._loss = Loss("")
        self._news = News()
        self._news_t = self._news_until = self._flash_until = 0
        #: The driver that refused what the sentence is about.
        self._news_driver = ""
        self._stop_asked: int | None = None
        self._painted = 0
        self._main_screen = MainScreen()
        self._panels = self._main_screen.panels

    # -- putting together ---------------------------------------------------------------------

    def compose(self) -> ComposeResult:
        yield from self._main_screen.compose()

    def begin(self) -> None:
        """Hear of keys, and lay out the screen."""
        self.keyboard.on_pressed = self.inbox.elsewhere(self._pressed)
        self.keyboard.on_stale = self.inbox.elsewhere(self._stale)
        self.keyboard.on_alt = self.inbox.elsewhere(self._alt)
        self.keyboard.on_held = self.inbox.elsewhere(self._held)
        self.keyboard.on_prefix = self.inbox.elsewhere(self._prefix)
        self._measure()

    # -- painting -------------------------------------------------------------------------------

    def wake(self) -> None:
        """Paint now if the last painting is a beat ago; otherwise the next beat does."""
        if self.clock.now_us() - self._painted >= self._pace() * 1_000_000:
            self.paint()

    def _pace(self) -> float:
        """Seconds between two paintings at the least."""
        return PAINT_S

    def beat(self) -> None:
        """Paint if anything has come or moves with time; otherwise once a second."""
        self.keyboard.tick()
        local = self.clock.now_us()
        moving = self._flash_until or self.state.moves(self.state.now(local))
        due = moving or self._stop_asked is not None or local - self._painted >= 1_000_000
        if self.inbox or due:
            self.paint()

    def paint(self) -> None:
        """Work in what has come and show what has changed; nothing while its parts go."""
        if not self.is_running or not self.screen_stack:
            return
        local = self._painted = self.clock.now_us()
        self._take_in(local)
        if self._flash_until and local >= self._flash_until:
            self._flash_until = 0
            self._panels.press("")
        if self._news_until and local >= self._news_until:
            self._news, self._news_until = News(), 0
        self._measure()
        self._show(self.state.now(local))

    def _take_in(self, local: int) -> None:
        for came in self.inbox.taken():
            if isinstance(came, Loss):
                self._connection_lost(came, local)
            else:
                self._work_in(came, local)
        self._open_offered()
        for tiding in self.state.study.read_news():
            self.news(self._with_keys(tiding), tiding.look)
        if (refusal := self.state.runs.read_refusal()) is not None:
            self.news(refusal.sentence(self.state.label(refusal.action)), "warn")
            self._news_driver = refusal.driver
        stopped = self.state.session.stop is not None
        if stopped and not self.state.lost:  # else it is the stop of before
            self._stop_asked = None
        if self.state.edition != self._edition:
            self._edition = self.state.edition
            self._adopt()
        # Keys behind which something is asked before they play, where keys play at all.
        asked = asked_words(self.state) if self.state.role == "wizard" else {}
        first = {action: action for action in asked}
        if first and (action := upcoming(self.state)) in first:
            first[order_keys()[0]] = action
        self.keyboard.asks_first = first

    def _work_in(self, batch: list[Incoming], local: int) -> None:
        self.state.apply(batch, local)
        for message in batch:
            match message:
                case Reply():
                    self._replied(message)
                case PictureShown():
                    self.requests.pictured(message)
                case Welcome():
                    self.state.runs.read_refusal()  # an old one
                    self._welcomed(message)
                case DriverHealth(driver=driver) if driver == self._news_driver:
                    self._news = News()  # it refused in another state
                case ConsoleAttached() | ConsoleLost():
                    self._bind_arrows()
                case Mistake(console=self.state.console):
                    what = act_text(self.state, message.run, message.action, self.look.glyphs)
                    told = say("app.mistake", "Marked as a mistake: {what}", what=what)
                    self.news(told, "strong")
                case StopPressed(scope="all"):
                    self._stop_changed()
                case StopReleased():
                    self._stop_changed()
                    self._offer_home()

    def _stop_changed(self) -> None:
        """The stop was pressed or released: what was told before was of another state."""
        self._stop_asked = None
        self._news = News()

    def _offer_home(self) -> None:
        """The stop has left the robot as it was: which key takes it home, if it is turned away."""
        turned, home = turned_away(self.state), self.state.home_action
        if turned and home:
            key, label = self._cap_and_label(home)
            told = say(
                "app.turned_away",
                "The robot is still turned away ({turned}); press {key}: {label}",
                turned=turned,
                key=key,
                label=label,
            )
            self.news(told, "warn")

    def _connection_lost(self, loss: Loss, local: int) -> None:
        self.keyboard.session_came()
        self.state.lose(loss)
        self._loss, self._was_stopped = loss, self.state.session.stop is not None
        self.requests.forget()
        self._news = News()  # what is lost, and what can be done, comes first
        if not self._was_lost:
            self._was_lost, self._lost_t = True, self.state.now(local)
            calls("screens.lost:open_lost")(self)

    def explain_loss(self, why: str) -> None:
        """What becomes of a lost robot process; nothing if it is back."""
        if self.state.lost:
            self.state.lose(replace(self.state.lost, why=why))
            self.paint()

    def _open_offered(self) -> None:
        """Open what features offer at this moment, each once."""
        for name, console in pieces("console", FeatureConsole).items():
            offer = None
            if console.offers is not None:
                offer = answer_of(name, None, console.offers, self.state)
            about = offer.about if offer is not None else None
            if about != self._offered.get(name):
                self._offered[name] = about
                if offer is not None and offer.opens:
                    open_named(self, offer.opens)

    def _with_keys(self, tiding: StudyNews) -> str:
        """What a study has to tell, with the keys that it names."""
        text = tiding.text
        if tiding.right:
            right = []
            for action in tiding.right:
                cap = caption(self.caps.get(action, KeyCap("")), self.look.glyphs)
                label = self.state.label(action)
                right.append(f"{label} ({cap})" if cap else label)
            wanted = say("app.or", " or ").join(right)
            text = say("app.right", "{told}; right: {actions}", told=text, actions=wanted)
        command, does = tiding.command
        key = self._key(command) if command else ""
        return f"{text}; {press_to(key, does)}" if key else text

    def _replied(self, reply: Reply) -> None:
        self.requests.replied(reply)

    def _welcomed(self, welcome: Welcome) -> None:
        """The robot process is there, for the first time or again."""
        if self._was_lost:
            self._was_lost = False
            calls("screens.lost:close_lost")(self)
            self._tell_return()
        text, remedy = map(word, self.greeting)
        if text:
            self.greeting = ("", "")
            self._list_warning(text, remedy)
            self.news(f"{text} ({remedy})", "warn")
        if self._greets:  # this line takes the place of the other, which is an event, too
            self._greets = False
            stop, leave, keys = map(self._key, ("stop", "leave", "help"))
            greeting = say(
                "app.greeting",
                "{stop} stops the robot; {leave} closes; {keys} lists all keys",
                stop=stop,
                leave=leave,
                keys=keys,
            )
            self.news(greeting, "strong")
        start = self.state.session.start
        asks = self.ask_participant and welcome.role == "wizard" and start != self._asked_in
        if asks and not self.state.session.study.participant:
            self._asked_in = start
            self.do("start")  # what was typed meanwhile goes into its first field
        elif self.keyboard.session_came():
            self.news(
                say("app.start_keys", "Keys pressed during the start were not played"), "warn"
            )

    def _tell_return(self) -> None:
        """Say that the robot process is back, and which presses did nothing meanwhile."""
        late = {
            self.state.label(action): ended.reason
            for action, ended in self.state.runs.outcomes.items()
            if ended.how == "refused" and ended.t > self._lost_t
        }
        back = word(self._loss.part.back)
        if self._stop_asked is not None and self.state.session.stop is None:
            self._stop_asked = None
            again = say(
                "app.press_again", "{back}; the stop is not pressed: press it again", back=back
            )
            self.news(again, "warn")
        elif self._was_stopped and self.state.session.stop is None:
            gone = say("app.stop_gone", "{back}; the stop is not pressed any more", back=back)
            self.news(gone, "warn")
            self._list_warning(
                say("app.stop_released", "The stop is not pressed any more"),
                say("app.escape_stops", "escape presses it"),
            )
        elif late:
            why = next(reversed(late.values()))
            told = say(
                "app.back_unplayed",
                "{back}; not played: {labels} ({why})",
                back=back,
                labels=", ".join(late),
                why=why,
            )
            self.news(told, "warn")
        else:
            self.news(back, "good")

    def _adopt(self) -> None:
        """A new set of panels: bind its keys and show their caps."""
        state = self.state
        beside = [action.name for action in state.settings.beside_panels]
        own = builtin_keys_with(beside, self._builtins)
        warned = self.keymap.warnings  # told already: at each return of the line all is adopted
        self.keymap = key_map(state.panels, self.terminal, state.plan.keyboard, own)
        self._main_screen.actions.keys = {
            item.action: self._key(item.id) for item in own if item.action
        }
        self.caps = {name: cap_of(found) for name, found in self.keymap.actions.items()}
        self._panels.bear(self.caps)
        glyphs = self.look.glyphs
        state.keys = {name: caption(cap, glyphs) for name, cap in self.caps.items() if cap.chord}
        state.own_keys = {name: self._key(name) for name in self.keymap.builtins}
        self.keyboard.bind(self.keymap.table, self._own_keys())
        self.keyboard.holds = state.settings.driving == "held"
        self._bind_arrows()
        self.arrows.adopt(state.settings.steps)
        if self.keymap.warnings != warned and self.keymap.warnings:
            self.news(word(self.keymap.warnings[0]), "warn")

    def _bind_arrows(self) -> None:
        """Arrows move the robot of this wizard, where others play other ones."""
        own = self.state.own_verbs
        self.keyboard.names_driver = own != self.state.verbs
        self.keyboard.verbs = own

    def _own_keys(self) -> dict[str, ConsoleKey]:
        """What arrives, and which command it is the key of."""
        table = self.keymap.builtin_table
        return {chord: self.commands[name] for chord, name in table.items()}

    def terminal_found(self, terminal: Terminal) -> None:
        """The terminal has answered what it can send: keys that arrive now need no reserve."""
        if terminal != self.terminal:
            self.terminal = terminal
            self._adopt()
            self.paint()

    def picture_terminal_found(self, terminal: PictureTerminal) -> None:
        """What pictures need to know of the terminal; told by the driver when it is made."""
        self.picture_terminal = terminal

    def _show(self, now: int) -> None:
        bar = BarInfo(
            self._news,
            self._hints(),
            tuple(map(self._key, order_keys())),
            self._key("release") if self.state.role != "watcher" else "",
            self._stop_asked,
            take_over=self._key("take_over"),
            then=tuple(map(self._cap_and_label, self.state.then)),
            stop=self._key("stop"),
            failures=self._key("failures"),
            begin=self._begins(),
        )
        step = self._following()
        line = StatusInfo(
            self.feed.line_ok,
            self.feed.round_trip_us,
            failures=self._key("failures"),
            drivers=self._key("drivers"),
            cut=self._key("cut"),
            following=(self._key(step.key), step.begins) if step is not None else ("", ""),
        )
        self._main_screen.events.key = self._key("events")
        screen = PaintFrame(*self.size, now, self.look.glyphs)
        self._main_screen.paint(self.state, screen, line, bar)
        if self.dialog is not None and self.dialog.is_mounted:
            self.dialog.refreshed()
        self._tell_shown(screen)

    def _tell_shown(self, frame: PaintFrame) -> None:
        """What features tell of what stands on the screen now."""
        if self.state.lost:
            return
        for name, each in pieces("console", FeatureConsole).items():
            if each.shown is not None:
                for request in answers_of(name, each.shown, self.state, frame):
                    self.requests.ask(request, _unread)

    def _begins(self) -> tuple[str, str]:
        """The key of what is to begin before anything comes next, and what; without a key, why
        nothing is. Of several features the last has it.
        """
        for name, each in reversed(pieces("console", FeatureConsole).items()):
            found = answer_of(name, None, each.begins, self.state) if each.begins else None
            if found is not None:
                key, what = found
                return self._key(key) if key else "", what
        step = self._following()
        if step is None or not step.first:
            return "", ""
        return self._key(step.key), say("app.begins", "begins {what}", what=clean(step.begins))

    def _following(self) -> NextStep | None:
        """What a feature's key goes on to."""
        step: NextStep | None = None
        for name, each in pieces("console", FeatureConsole).items():
            if step is None and each.following is not None:
                step = answer_of(name, None, each.following, self.state)
        return step

    def _hints(self) -> tuple[tuple[str, str], ...]:
        named = ((self._key(name), word) for name, word in hints(self.state, self.commands))
        return tuple((key, word) for key, word in named if key)

    def _key(self, name: str) -> str:
        """The key of one of the console's own, as a cap shows it."""
        return key_name(self.key_of(name), self.look.glyphs)

    def key_of(self, name: str) -> str:
        """The key to press for a command, in its normal form; empty: it has none."""
        found = self.keymap.builtins.get(name)
        return found.press if found is not None else ""

    def _measure(self) -> None:
        """Give all parts their places; each that has moved asks to be painted (`Cells.Resized`)."""
        base, glyphs = self.screen_stack[0], self.look.glyphs
        self._main_screen.measure(self.size, base, self.state, glyphs)

    def on_resize(self) -> None:
        """Paint every cell: small and back in a moment is no change, but the window lost it."""
        self._measure()
        self.refresh()

    def on_cells_resized(self) -> None:
        """Fill the part that has another size."""
        self.paint()

    def _display(self, screen: Screen[object], renderable: RenderableType | None) -> None:
        """As Textual does, with fewer bytes."""
        super()._display(screen, cropped(renderable))
        if self.dialog is not None:
            self.dialog.displayed(renderable)

    # -- news and presses ------------------------------------------------------------------------

    def news(self, text: str, look: str = "muted") -> None:
        """A sentence above the hints, for a few seconds."""
        text = remedy_text(text, self.state)
        self._news, self._news_t, self._news_driver = News(text, look), self.clock.now_us(), ""
        self._news_until = self._news_t + round(NEWS_S * 1_000_000)
        self.paint()

    def _list_warning(self, text: str, detail: str) -> None:
        """A line of this console's own in the list of events."""
        now = self.state.now(self.clock.now_us())
        self.state.events.append(EventLine("warning", text, detail, now))

    def _forget_news(self) -> None:
        """A newer key has another end than what was told before it came."""
        if self._news.text and self._news_t <= self.keyboard.came_us:
            self._news, self._news_until = News(), 0
            self.paint()

    def _cap_and_label(self, action: str) -> tuple[str, str]:
        """One without a key is the first in the finder."""
        cap = caption(self.caps.get(action, KeyCap("")), self.look.glyphs)
        return cap or self._key("find"), self.state.label(action)

    def walk(self, by: int) -> None:
        self._panels.walk(self.state, by)
        self.paint()

    def filter_events(self) -> None:
        """Show the next selection of the events."""
        self._main_screen.events.turn()
        self.paint()

    def _pressed(self, chord: str, action: str, ref: int) -> None:
        if chord in STOPS:
            self._stopping()
            return
        self._end_peek()
        self._forget_news()
        if action and not self.state.lost:
            self._panels.press(action)
            self._flash_until = self.clock.now_us() + round(FLASH_S * 1_000_000)
            self.paint()

    def _stale(self, chord: str, name: str, ref: int) -> None:
        if what := self.state.label(name):
            late = say(
                "app.late",
                "Not played: {what}. It came too late, or with many keys at once",
                what=what,
            )
        else:  # such as enter, at the end of a note
            late = say(
                "app.late_key",
                "{key} ignored: it came too late, or with many keys at once",
                key=key_name(chord, self.look.glyphs),
            )
        self.news(late, "warn")

    def _held(self, chord: str, name: str, ref: int) -> None:
        """Who holds a key sees why it does no more; who meant it presses it again later."""
        key = key_name(chord, self.look.glyphs)
        soon = say("app.too_soon", "{key} ignored: too soon after the last press", key=key)
        self.news(soon, "muted")

    def _alt(self) -> None:
        """Say once what alt does here; the stop has been sent."""
        if not self._alt_told:
            self._alt_told = True
            self._list_warning(
                say("app.escape_alt", "This terminal sends escape with alt"),
                say("app.escape_is_stop", "escape is the stop"),
            )
            self.paint()

    def _prefix(self, prefix: str) -> None:
        if prefix:
            self._end_peek()
            key = key_name(prefix, self.look.glyphs)
            begun = f"{key} {self.look.glyphs.ellipsis}"
            self.news(say("app.second_key", "{key} waits for its second key", key=begun), "run")
        elif self._news.look == "run":
            self._news_until = 1
            self.paint()

    # -- keys ---------------------------------------------------------------------------------

    async def on_event(self, event: events.Event) -> None:
        """Keys pass here before any widget, dialog or text field sees them."""
        if isinstance(event, events.Key) and not event.is_forwarded and self._take_key(event):
            event.stop()
            return
        await super().on_event(event)

    def _take_key(self, event: events.Key) -> bool:
        """Whether the key was for the console, and nobody else is to see it."""
        chord = from_textual(event.key, event.character)
        if chord in STOPS:
            self.keyboard.stop(chord)
            return True
        name = self.keymap.builtin_table.get(chord)
        dialog = self.dialog
        if chord == CLOSES and dialog is not None:
            name = "leave"
        if dialog is not None and (not dialog.plays or name == "leave" or chord in dialog.own_keys):
            # Closing and releasing the stop work in every dialog; the rest is the dialog's.
            if name == "leave":
                self.close_dialog()
            elif name == "release":
                self.do(name)
            return name in ("leave", "release")
        self._end_peek()
        asked = self.keyboard.take_asked_first(chord)
        if asked is None:
            waited_us = max(0, round((time.monotonic() - event.time) * 1_000_000))
            if self.keyboard.press(chord, age_us=waited_us):
                return True
            asked = self.keyboard.take_asked_first(chord)
        if asked is not None:
            self._forget_news()
            action = self.keyboard.asks_first.get(asked.what, asked.what)
            self.ask_words(action, asked.keys, of_order=asked.what != action)
        elif name is None:
            key = key_name(chord, self.look.glyphs)
            self.news(say("app.unassigned", "{key} is not assigned", key=key))
        elif dialog is not None and dialog.opened_by == self.commands[name].name:
            self.close_dialog()
        else:
            self._forget_news()
            self.do(name)
        return True

    def ask_words(self, action: str, keys: str, *, of_order: bool = False) -> None:
        """Ask for what an action lacks, or anew for what it has, and then play it. What could not
        be played is asked for at once: who answers a question in vain has lost time.
        """
        state = self.state
        panel = next((e for e in state.panels for a in e.actions if a.name == action), None)
        view = state.action(action)
        refused = panel and view and state.why_not(panel, view)
        asks = asked_words(state).get(action) or asks_again(state, action)
        if asks is None or refused or state.session.stop is not None or state.lost:
            source = "key" if keys else "palette"
            self.requests.ask(AskAction(action=action, source=source, key=keys))
        else:
            self.open_dialog(resolve_name(asks.dialog)(action, keys, of_order=of_order))

    def do(self, name: str) -> None:
        """Carry out a command by the id of one of its keys.

        Of those that the keyboard sends, it has not sent the ones that only some drivers offer.
        """
        command, below = self.commands[name], self.dialog
        if command.run is not None:
            command.run(self)
            if (top := self.dialog) is not None and top is not below:
                top.opened_by = command.name
        elif command.verb:
            self.news(self._arrow_words(command.verb), "warn")
        elif command.sends is not None:
            self.requests.ask(command.sends(KeyPress()))

    def _arrow_words(self, verb: str) -> str:
        """Why an arrow key moves nothing: no robot has the verb, or several have."""
        short = self.state.short_names
        own = self.state.own_verbs
        able = [short.get(name, name) for name, verbs in own.items() if verb in verbs]
        if able:
            return say(
                "app.several_robots",
                "Arrow keys move one robot alone, and here are {names}: use a button",
                names=", ".join(able),
            )
        robots = {name.partition(".")[0] for name in short} if "." in "".join(short) else {""}
        return word((_LACKS if len(robots) < 2 else _ALL_LACK)[verb])

    def _end_peek(self) -> None:
        """Close what ends with any key."""
        if self.dialog is not None and self.dialog.ends_with_key:
            self.close_dialog()

    def _stopping(self) -> None:
        """The stop was sent: every dialog closes, so that the wizard stands on known ground."""
        self._stop_asked = self.state.now(self.clock.now_us())
        while self.dialog is not None:
            self.close_dialog()
        self.paint()

    # -- dialogs --------------------------------------------------------------------------------

    @property
    def dialog(self) -> Dialog | None:
        """The dialog on top, if one is open."""
        screen = self.screen_stack[-1] if self.screen_stack else None
        return screen if isinstance(screen, Dialog) else None

    @property
    def stop_pending(self) -> bool:
        """Whether a stop was sent from here that has not been answered yet."""
        return self._stop_asked is not None

    def open_dialog(self, dialog: Dialog) -> None:
        """Give the keyboard to a dialog, unless the robot is played meanwhile."""
        while dialog.plays and self.dialog is not None:
            self.close_dialog()  # drawings take turns
        self._give_keys(dialog)
        self.push_screen(dialog)

    def close_dialog(self, dialog: Dialog | None = None) -> None:
        """Close `dialog`, or whichever is on top; then what is below has the keyboard."""
        top = self.dialog
        if top is not None and (dialog is None or dialog is top):
            top.closing()
            self.pop_screen()
        self.give_keys()
        self.paint()

    def give_keys(self) -> None:
        """Keys belong to the dialog on top, or to the robot."""
        self._give_keys(self.dialog)

    def _give_keys(self, top: Dialog | None) -> None:
        self.keyboard.kept = frozenset() if top is None else top.own_keys
        if top is not None:
            self.keyboard.takes_late = top.takes_late
            self.keyboard.typed_into = top.typed_into
        self.keyboard.free = top is None or top.plays


def _unread(_: Reply) -> None:
    """Of a reply that tells a person nothing."""
