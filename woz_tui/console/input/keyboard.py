"""Sends the request that a key stands for, from the thread that read the key.

Experiment actions and those of the console's own keys that only send a request are carried out
here, whatever the screen is doing. Everything else is left to the screen: `press` and `arrive`
then return False.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from woz_tui.config.keys.console_keys import BuiltinKey
from woz_tui.config.keys.terminals import STOPS
from woz_tui.config.screen_language import word
from woz_tui.console.link.message_feed import MessageFeed
from woz_tui.protocol.requests import (
    AskAction,
    AskLetGo,
    AskStop,
    Request,
)
from woz_tui.system.clock import Clock, RealClock
from woz_tui.system.rate_limit import RateLimit

#: Microseconds in which a key that has just counted may come again because it is held: a terminal
#: says of no key that it was let go. Longer than keyboards wait before the first repeat (250 to
#: 660 ms; between the others 25 to 100 ms), shorter than it takes to decide on another press.
HELD_US = 750_000
#: Late keys that are told and logged: so many at once, then one in so many seconds. The rest of a
#: flood does nothing, or it would keep screen and robot process busy for longer than it took.
LATE_AT_ONCE, LATE_EVERY_S = 16, 0.5
#: The second key of a sequence must follow within this time, in seconds.
SEQUENCE_S = 1.0
#: Letters that are kept of what is typed before there is a session.
EARLY_LIMIT = 64

#: Called after a press with the chord (`c r` for a sequence), the action's name (empty for the
#: console's own keys and the stop) and the request's `ref` (0: nothing was sent).
OnPress = Callable[[str, str, int], None]


@dataclass(frozen=True, slots=True)
class ArrowSizes:
    """How far one press of an arrow goes: degrees, metres."""

    head: float = 5.0
    hip: float = 3.0
    drive: float = 0.1
    turn: float = 10.0


class KeyPress(NamedTuple):
    """One press, as its request tells of it."""

    key: str = ""
    age_us: int = 0
    stale: bool = False
    steps: ArrowSizes = ArrowSizes()
    #: The driver that is meant, where several offer the verb.
    on: str = ""
    #: When `age_us` was known, in `Clock.boot_us`; 0: just now.
    at_us: int = 0

    @property
    def fields(self) -> dict[str, Any]:
        """What a request tells of the press that it stands for."""
        return {
            "key": self.key,
            "age_us": self.age_us,
            "stale": self.stale,
            "sent_us": self.at_us,
        }


class AskedFirst(NamedTuple):
    """A press behind which something is asked before anything is played.

    `chord` as it was pressed; `keys`: all of it (`c r`); `what`: the action, or the id of the
    console's own key.
    """

    chord: str
    keys: str
    what: str


@dataclass(frozen=True, slots=True)
class ConsoleKey:
    """A key of the console itself, as the keyboard needs it.

    Args:
        keys: As they are without a keymap file. The first gives the name, and the words of help
            and palette; one without a chord is in the palette only.
        sends: Makes its request; None: the screen carries it out.
        verb: Unless one driver alone offers this, nothing is sent; empty: no verb is needed.
        opens: Whether it may open a dialog: keys pressed behind it then wait for the screen.
        once: Held down, or pressed again at once, it counts once.
    """

    keys: tuple[BuiltinKey, ...]
    sends: Callable[[KeyPress], Request] | None = field(default=None, kw_only=True)
    verb: str = field(default="", kw_only=True)
    opens: bool = field(default=True, kw_only=True)
    once: bool = field(default=False, kw_only=True)

    @property
    def name(self) -> str:
        """Its id."""
        return self.keys[0].id

    @property
    def words(self) -> str:
        """What it does, in the language of the screen."""
        return word(self.keys[0].description)


class Keyboard:
    """Looks keys up and sends what they stand for. Safe to use from any thread.

    Args:
        feed: Where requests go.
        clock: For the time between the keys of a sequence.
        steps: Of the arrow keys.
    """

    def __init__(
        self, feed: MessageFeed, clock: Clock | None = None, steps: ArrowSizes | None = None
    ) -> None:
        self.feed = feed
        #: The verbs that each driver offers to this wizard: arrows work only where one moves.
        self.verbs: Mapping[str, Collection[str]] = {}
        #: Whether other drivers offer them to other wizards, so that its name has to be said.
        self.names_driver = False
        self.on_pressed: OnPress = _ignore
        #: A press too old to be played. What would have moved the robot is logged as refused,
        #: under the given `ref`.
        self.on_stale: OnPress = _ignore
        #: A press that may come from a held key did nothing: its chord and the command's name.
        self.on_held: OnPress = _ignore
        #: The first key of a sequence, while it waits for the second; then empty again.
        self.on_prefix: Callable[[str], None] = _ignore
        #: Whether a key that came late, in a burst, still counts in what has the keyboard. Called
        #: from the thread that reads keys.
        self.takes_late: Callable[[str], bool] = _takes_any
        #: Whether what has the keyboard is a text field.
        self.typed_into = False
        self._tells_late = RateLimit(LATE_EVERY_S, (LATE_AT_ONCE - 1) * LATE_EVERY_S)
        #: Keys that belong to what is drawn over the screen while the rest plays the robot.
        self.kept: frozenset[str] = frozenset()
        #: The stop has come with a key right behind it, as alt and that key do.
        self.on_alt: Callable[[], None] = _ignore
        #: Keys drive only while they are held: a terminal that can is to say when one is let go.
        self.on_holds: Callable[[bool], None] = _ignore
        self._holds = False
        #: Actions, and own keys by id, that the screen asks something about before they are
        #: played, with the action that this is about.
        self.asks_first: Mapping[str, str] = {}
        self._asked_first: AskedFirst | None = None
        #: What the key for suspending does; set by the terminal.
        self.on_suspend: Callable[[], None] | None = None
        self._clock = clock or RealClock()
        #: How far one press of an arrow goes.
        self.steps = steps or ArrowSizes()
        #: What was typed before there was a session to play; None: there is one.
        self._early: str | None = None
        self._lock = threading.RLock()
        self._table: Mapping[str, str] = {}
        self._own: Mapping[str, ConsoleKey] = {}
        self._prefixes: Collection[str] = frozenset()
        self._free = True
        #: Keys left to the screen that it has not handled; those of them behind which others
        #: wait; those that a stop has made void.
        self._left = self._behind = self._void = 0
        self._stops = 0
        self._prefix = ""
        self._prefix_us = 0
        #: When the last key came, on the clock.
        self.came_us = 0
        #: The last key, and whether it has been told that it may be held.
        self._last, self._told_held = "", False
        #: Whether the last key counted on the main screen.
        self._last_free = True

    # -- what the app says ----------------------------------------------------------------------

    def bind(self, table: Mapping[str, str], own: Mapping[str, ConsoleKey] | None = None) -> None:
        """Play `table` from now on: normal form or sequence `c r` -> name of the action.

        `own`: normal form -> the console's own key; without it they stay as they are.
        """
        with self._lock:
            self._table = {chord: name for chord, name in table.items() if chord not in STOPS}
            self._prefixes = {chord.split(" ")[0] for chord in table if " " in chord}
            if own is not None:
                self._own = dict(own)
        self._set_prefix("")

    @property
    def free(self) -> bool:
        """False while a text field, dialog or palette has the keyboard."""
        return self._free

    @free.setter
    def free(self, free: bool) -> None:
        self._free = free
        if not free:
            self._set_prefix("")

    def wait_for_session(self, typed: Iterable[str] = ()) -> None:
        """Until `session_came` no key does anything but stop and leave; what is typed is kept,
        after the keys that were `typed` before.
        """
        self._early = ""
        for chord in typed:
            self.arrive(chord)

    def session_came(self) -> str:
        """Keys count from now on. What was typed before then; it is told once."""
        with self._lock:
            typed, self._early = self._early, None
        return typed or ""

    @property
    def holds(self) -> bool:
        """Whether keys drive only while they are held."""
        return self._holds

    @holds.setter
    def holds(self, holds: bool) -> None:
        if holds != self._holds:
            self._holds = holds
            self.on_holds(holds)

    # -- keys -----------------------------------------------------------------------------------

    def let_go(self, chord: str) -> None:
        """A key is up, as the terminal says."""
        if self._holds:
            self.feed.ask(AskLetGo(key=chord))

    def arrive(self, chord: str, *, age_us: int = 0, stale: bool = False, at_us: int = 0) -> bool:
        """A key straight from the terminal. Like `press`, but in order with the screen. `at_us` is
        when its age was known (`Clock.boot_us`): if this process stands still from then on, it is
        older when it is sent.

        Once a key that may open a dialog has been left to the screen, the keys behind it are
        too, until the screen has handled it: they may belong into the dialog.
        """
        own = self._own.get(chord)
        if self.on_suspend is not None and own is not None and own.name == "suspend":
            self.on_suspend()
            return True
        if (own is None or own.name != "leave") and self._keep_early(chord):
            return True
        if not self._free or self._behind:
            return self._arrive_elsewhere(chord, stale)
        if stale and not self._tells_late(self._clock.now_us() / 1_000_000):
            return True
        if chord in self.kept:
            self._note(chord, free=True)
        elif self._press(chord, age_us, stale, at_us):
            return True
        if stale:  # nor may it open a dialog that the rest of the burst would fill
            self.on_stale(chord, "", 0)
        return stale

    def _keep_early(self, chord: str) -> bool:
        """Whether there is no session yet; then a letter is kept, and any other key is void."""
        with self._lock:
            if self._early is None:
                return False
            if chord == "backspace":
                self._early = self._early[:-1]
            elif len(chord) == 1 and len(self._early) < EARLY_LIMIT:
                self._early += chord
            return True

    def _arrive_elsewhere(self, chord: str, stale: bool) -> bool:
        """A key for a dialog: it may be the rest of the held key that opened this dialog, or closed
        the last one.
        """
        with self._lock:
            was_free = self._last_free
            rest = self._note(chord, free=False) and was_free
            self._last_free = rest
        if stale and not self._free and not self.takes_late(chord):
            if self._tells_late(self._clock.now_us() / 1_000_000):
                self.on_stale(chord, "", 0)
            return True
        return rest

    @property
    def plays(self) -> bool:
        """Whether keys play now: there is a session, and nothing else has or may get them."""
        return self._free and not self._behind and self._early is None

    def text_of(self, chord: str) -> str:
        """What a late key adds to the text field that has the keyboard; empty: no letter."""
        letter = " " if chord == "space" else chord
        typed = self.typed_into and not self._free and len(letter) == 1
        return letter if typed and self.takes_late(chord) else ""

    def leave_to_screen(self, chord: str) -> Callable[[], None]:
        """`chord` goes to the screen; call the result when the screen has handled it."""
        own = self._own.get(chord)
        with self._lock:
            asks = chord in self.kept or (own is not None and own.opens)
            asks = asks or (self._asked_first is not None and self._asked_first.chord == chord)
            opens = self._free and asks
            waited_for = int(opens or self._behind > 0)
            self._left += 1
            self._behind += waited_for
            stops = self._stops

        def handled() -> None:
            with self._lock:
                if stops < self._stops:
                    self._void -= 1
                else:
                    self._left -= 1
                    self._behind -= waited_for

        return handled

    def press(self, chord: str, *, age_us: int = 0, stale: bool = False) -> bool:
        """A key was pressed `age_us` ago; True if it has been dealt with here.

        A `stale` press plays nothing: what would have moved the robot is logged as refused, and
        all are told to `on_stale`.
        A press that the screen got before a stop and offers after it plays nothing either.
        """
        if self._void:
            return True
        return self._free and self._press(chord, age_us, stale, offered=True)

    def _press(
        self, chord: str, age_us: int, stale: bool, at_us: int = 0, *, offered: bool = False
    ) -> bool:
        # A key that was left to the screen has been judged when it arrived.
        if not (offered and self._left) and self._is_held(chord):
            return True
        with self._lock:
            prefix = "" if self._late() else self._prefix
        self._set_prefix("")
        for keys in (f"{prefix} {chord}".lstrip(), chord):
            action = self._table.get(keys)
            if action is None:
                continue
            if action in self.asks_first and not stale:
                self._asked_first = AskedFirst(chord, keys, action)
                return False
            press = KeyPress(keys, age_us, stale, at_us=at_us)
            ref = self.feed.ask(AskAction(action=action, source="key", **press.fields))
            (self.on_stale if stale else self.on_pressed)(keys, action, ref)
            return True
        if chord not in self._prefixes:
            return self._send(chord, age_us, stale, at_us)
        if stale:
            self.on_stale(chord, "", 0)
        else:
            with self._lock:
                self._prefix_us = self._clock.now_us()
            self._set_prefix(chord)
        return True

    def take_asked_first(self, chord: str) -> AskedFirst | None:
        """Whether something is to be asked before this key plays; it is told once."""
        with self._lock:
            asked, self._asked_first = self._asked_first, None
        return asked if asked is not None and asked.chord == chord else None

    def _note(self, chord: str, *, free: bool) -> bool:
        """A key came; whether it may be the one before, held."""
        now = self._clock.now_us()
        with self._lock:
            again = chord == self._last and now - self.came_us < HELD_US
            self._last, self.came_us, self._last_free = chord, now, free
        return again

    def _is_held(self, chord: str) -> bool:
        """Whether it may be the rest of a held key that counts once."""
        own = self._own.get(chord)
        with self._lock:
            again = self._note(chord, free=True)
            held = again and own is not None and own.once and chord not in self._table
            tells, self._told_held = held and not self._told_held, held
        if tells and own is not None:
            self.on_held(chord, own.name, 0)
        return held

    def stop(self, source: str) -> None:
        """Stop everything; `source` is the stop key (`escape`, `ctrl+c`) or another word."""
        ref = self.feed.ask(AskStop(source="key" if source in STOPS else source))
        with self._lock:
            self._stops += 1
            self._void += self._left
            self._left = self._behind = 0
            self._asked_first = None
        self._set_prefix("")
        if source in STOPS:
            self.on_pressed(source, "", ref)

    def tick(self) -> None:
        """Forget the first key of a sequence if the second did not follow; call now and then."""
        if self._prefix and self._late():
            self._set_prefix("")

    # -- sequences ------------------------------------------------------------------------------

    def _late(self) -> bool:
        return self._clock.now_us() - self._prefix_us > SEQUENCE_S * 1_000_000

    def _set_prefix(self, prefix: str) -> None:
        with self._lock:
            changed = prefix != self._prefix
            self._prefix = prefix
        if changed:
            self.on_prefix(prefix)

    # -- requests -------------------------------------------------------------------------------

    def _send(self, chord: str, age_us: int, stale: bool, at_us: int) -> bool:
        own = self._own.get(chord)
        if own is None or own.sends is None:
            return False
        if own.name in self.asks_first and not stale:
            self._asked_first = AskedFirst(chord, chord, own.name)
            return False
        offering = [name for name, offered in self.verbs.items() if own.verb in offered]
        if own.verb and len(offering) != 1:
            return False  # nobody, or nobody knows whom: the screen says so
        on = offering[0] if own.verb and self.names_driver else ""
        request = own.sends(KeyPress(chord, age_us, stale, self.steps, on, at_us))
        if not stale:
            self.on_pressed(chord, "", self.feed.ask(request))
        elif request.aged:  # the log says it was refused
            self.on_stale(chord, own.name, self.feed.ask(request))
        else:
            self.on_stale(chord, own.name, 0)
        return True


def _ignore(*told: object) -> None:
    """Do nothing: the default of a callback."""


def _takes_any(chord: str) -> bool:
    return True
