"""The console's own way to its terminal: the stop and the keys come first, the screen second.

What is used here of Textual that is not public: of `LinuxDriver` its methods `_patch_*` and
`_run_input_thread` by inheritance, its attributes `fileno`, `_app`, `_debug`, `_file`,
`attrs_before`, `exit_event`, `_key_thread` and `_must_signal_resume`; and `XTermParser.feed`. Other
files: `partial_update.py` and `camera/picture_widgets.py` (`textual._compositor`), `app.py`
(`_display`). Read and tested with Textual 8.2.8; pyproject.toml keeps it below 9.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import select
import signal
import sys
import termios
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from typing import Any, Protocol, cast

from textual import events
from textual._xterm_parser import XTermParser
from textual.app import App
from textual.drivers.linux_driver import LinuxDriver

from woz_tui.config.keys.terminals import KITTY, PLAIN, Terminal, detect_terminal, merged_chords
from woz_tui.console.camera.picture_terminal import PictureTerminal, question
from woz_tui.console.drawing.cells import clean, clean_paste
from woz_tui.console.drawing.terminal_output import Output
from woz_tui.console.input.byte_scanner import INTRODUCER_S, Scanner
from woz_tui.console.input.escape_sequences import (
    Key,
    KeyUp,
    Paste,
    Raw,
    StopToken,
    TerminalReply,
    Token,
)
from woz_tui.console.input.exit_handler import GONE, ExitHandler, run_aside
from woz_tui.console.input.keyboard import Keyboard
from woz_tui.console.input.terminal_monitor import TerminalMonitor
from woz_tui.machine.scheduling import ask_for_short_turns
from woz_tui.system.clock import RealClock

#: The reading thread looks around at least this often, in seconds.
TICK_S = 0.25
#: How long giving the terminal back may take, in seconds.
RESTORE_S = 0.3
#: Reads in which a last look is taken at what was typed: more than a person can have typed.
LAST_READS = 16
#: Presses of the same key in one read, as a frozen line sends them to a field.
EDITS = 64
#: Which keyboard flags are set (kitty), and who are you: every terminal answers the second.
_WHO = "\x1b[?u\x1b[c"
#: Keyboard flags of kitty's protocol: keys told apart as Textual has asked for, with and without
#: their release.
_RELEASES, _NO_RELEASES = "\x1b[=3;1u", "\x1b[=1;1u"
#: Undoes all that start_application_mode does, in whichever state it was left.
_RESTORE = (
    "\x1b[?2026l\x1b[0m"  # show what is being drawn, plain characters
    "\x1b[?2004l\x1b[?7h\x1b[?2048l"  # no paste marks, wrap lines, no size reports
    "\x1b[?1016l\x1b[?1006l\x1b[?1015l\x1b[?1003l\x1b[?1000l\x1b[?1004l"  # no mouse, no focus
    "\x1b[<u"  # kitty keyboard, before leaving the screen it was set on
    "\x1b[?1049l\x1b[?25h"  # the normal screen, with cursor
)


class KeyboardApp(Protocol):
    """What the driver needs of the app: its `keyboard`."""

    keyboard: Keyboard


class WizardDriver(LinuxDriver):
    """Reads keys in a thread of its own and sends what they stand for from there.

    The app gives its `keyboard`. If it has a method `terminal_found(terminal)`, that is called in
    the app's thread with the `config.keys.terminals.Terminal` that answered. A method
    `picture_terminal_found(terminal)` is called at once with the `PictureTerminal`, which learns
    from the answers what pictures need to know.
    """

    def __init__(self, app: App[Any], **options: Any) -> None:
        super().__init__(app, **options)
        self._keyboard = cast(KeyboardApp, app).keyboard
        self._keyboard.on_suspend = _suspend
        self._keyboard.on_holds = self._ask_for_releases
        multiplexed = bool(detect_terminal(os.environ).multiplexer)
        self._line = TerminalMonitor(self._keyboard.feed, RealClock(), multiplexed=multiplexed)
        self._kitty = 0
        #: Whether the terminal was asked to say when a key is let go.
        self._releases = False
        self._output: Output | None = None
        self._wake_in, self._wake_out = os.pipe()
        os.set_blocking(self._wake_in, False)
        os.set_blocking(self._wake_out, False)
        self._picture_terminal = PictureTerminal(self._taken_output, self._line, self._wake)
        if (found := getattr(app, "picture_terminal_found", None)) is not None:
            found(self._picture_terminal)
        self._read_s = 0.0
        self._scanner = Scanner()
        self._parser = XTermParser(self._debug)
        self._endings = ExitHandler(
            self, self._keyboard.feed, self._line, self._interrupted, self._leave
        )
        self._endings.install()
        atexit.register(self.restore)

    # -- the terminal's modes -------------------------------------------------------------------

    def start_application_mode(self) -> None:
        """Take the terminal. If that fails half way it is given back."""
        streams = [each for each in (self._file, sys.__stdout__) if each is not None]
        screen = next((each.fileno() for each in streams if each.isatty()), self.fileno)
        self._output = Output(screen, self._repaint)
        try:
            super().start_application_mode()  # type: ignore[no-untyped-call]
            self.write(question(os.environ) + _WHO)
            self._ask_for_releases(self._keyboard.holds)
        except BaseException:
            self.restore()
            raise

    def _ask_for_releases(self, holds: bool) -> None:
        """Have a terminal that can say when a key is let go; others take no notice."""
        if holds or self._releases:
            self.write(_RELEASES if holds else _NO_RELEASES)
        self._releases = holds

    def stop_application_mode(self) -> None:
        self.disable_input()
        self.restore()

    def restore(self) -> None:
        """Put the terminal back as it was; safe to call twice and from any thread."""
        output, self._output = self._output, None
        if output is None:
            return
        output.finish(_RESTORE, RESTORE_S)
        if self.attrs_before is not None:
            with contextlib.suppress(termios.error):
                self._throw_away()
                termios.tcsetattr(self.fileno, termios.TCSANOW, self.attrs_before)

    def pause(self) -> None:
        """Stop reading and drawing, give the terminal back for a while."""
        self.suspend_application_mode()

    def resume(self) -> None:
        """Take the terminal again and draw everything."""
        self._must_signal_resume = True
        self.resume_application_mode()
        self._repaint()

    def in_foreground(self) -> bool:
        """Whether this process may use its terminal."""
        with contextlib.suppress(OSError):
            return os.tcgetpgrp(self.fileno) == os.getpgrp()
        return True

    # -- out ------------------------------------------------------------------------------------

    def write(self, data: str) -> None:
        """Hand output over; a terminal that does not take it loses it, and is redrawn later."""
        if self._output is not None:
            self._output.write(data)

    def _taken_output(self) -> Output | None:
        """The terminal's output while it is taken."""
        return self._output

    def _repaint(self) -> None:
        self._in_app(self._app.refresh)

    def _in_app(self, callback: Callable[..., object], *arguments: object, **named: Any) -> None:
        """Call back in the app's thread, in order with the events it was sent before."""

        def call() -> None:
            callback(*arguments, **named)

        with contextlib.suppress(RuntimeError):  # the loop has closed: nobody to tell
            self.send_message(events.Callback(call))

    def _leave(self, code: int) -> None:
        self._in_app(self._app.exit, return_code=code)

    # -- in: the reading thread -----------------------------------------------------------------

    def disable_input(self) -> None:
        """End the reading thread; of what was typed but not read only stops count."""
        thread = self._key_thread
        if thread is None:
            return
        signal.signal(signal.SIGWINCH, signal.SIG_DFL)
        self.exit_event.set()
        self._wake()
        if thread is not threading.current_thread():
            thread.join(1.0)
        self._key_thread = None
        self.exit_event.clear()
        self._slept_enough()
        with contextlib.suppress(termios.error):
            self._throw_away()

    def _throw_away(self) -> None:
        """Empty the terminal's input without waiting; a stop in it is carried out all the same.

        While the reading thread lives that looks for stops, and what it has not read is flushed.
        """
        if self._key_thread is not None or not self.in_foreground():
            termios.tcflush(self.fileno, termios.TCIFLUSH)
            return
        stops = [token.source for token in self._unread() if isinstance(token, StopToken)]
        if stops:  # perhaps in a signal's handler: the interrupted code may hold the locks
            run_aside(self._stop_all, stops)

    def _stop_all(self, sources: list[str]) -> None:
        for source in sources:
            self._keyboard.stop(source)

    def _unread(self) -> list[Token]:
        """What waits to be read; for the rest of an escape sequence a moment."""
        scanner, tokens = self._scanner, list[Token]()
        poll = select.poll()
        poll.register(self.fileno, select.POLLIN)
        for _ in range(LAST_READS):
            if not poll.poll(1000 * min(scanner.waiting or 0.0, INTRODUCER_S)):
                break
            data = self._read()
            if not data:
                break
            tokens += scanner.feed(data)
        else:
            termios.tcflush(self.fileno, termios.TCIFLUSH)
        if scanner.waiting is not None and scanner.waiting <= INTRODUCER_S:
            tokens += scanner.expire()
        return tokens

    def run_input_thread(self) -> None:
        """Read until told to end, or until the terminal is gone."""
        ask_for_short_turns()
        scanner = self._scanner = Scanner(merged_chords(detect_terminal(os.environ)))
        scanner.expects_graphics = bool(question(os.environ))
        scanner.expects_background = True  # asked for before this began: its answer may be late
        self._line.reset()
        poll = select.poll()
        for fd in (self.fileno, self._wake_in):
            poll.register(fd, select.POLLIN)
        while not self.exit_event.is_set():
            ready = poll.poll(1000 * self._patience(scanner))
            self._line.awake()
            if any(fd == self._wake_in for fd, _ in ready):
                self._slept_enough()
            if any(fd == self.fileno for fd, _ in ready):
                data = self._read()
                if data is None:
                    self._endings.end(GONE)
                    return
                self._handle(scanner.feed(data))
            elif scanner.waiting is not None and self._quiet_s() >= scanner.waiting:
                self._handle(scanner.expire())
            self._ask_line()
            self._keyboard.tick()

    def _wake(self) -> None:
        """Let the reading thread look around at once."""
        with contextlib.suppress(BlockingIOError):
            os.write(self._wake_out, b"x")

    def _slept_enough(self) -> None:
        with contextlib.suppress(BlockingIOError):
            os.read(self._wake_in, 64)

    def _patience(self, scanner: Scanner) -> float:
        """Seconds until there is something to do without a byte."""
        left = TICK_S if scanner.waiting is None else scanner.waiting - self._quiet_s()
        return max(0.0, min(TICK_S, left, max(0.0, self._line.question_in_s)))

    def _quiet_s(self) -> float:
        return time.monotonic() - self._read_s

    def _read(self) -> bytes | None:
        """What came, perhaps nothing; None: the terminal is gone."""
        try:
            data = os.read(self.fileno, 4096)
        except BlockingIOError:  # somebody who shares the terminal has made it non-blocking
            return b""
        except OSError:
            return None
        self._read_s = time.monotonic()
        return data or None

    def _ask_line(self) -> None:
        """Ask how the line is, if it is time; not while the terminal takes nothing."""
        if self._line.question_in_s > 0:
            return
        output = self._output
        if output is not None and not output.stalled and output.write(self._line.question):
            self._line.question_sent()
        else:
            self._line.put_off()

    # -- tokens ---------------------------------------------------------------------------------

    def _handle(self, tokens: list[Token]) -> None:
        """Carry out what came in one read. A fault in it must not end the reading: the stop."""
        try:
            self._carry_out(tokens)
        except Exception as error:  # noqa: BLE001
            text = clean(f"a key could not be handled: {type(error).__name__}: {error}")
            self._in_app(self._app.notify, text, severity="error", markup=False)

    def _carry_out(self, tokens: list[Token]) -> None:
        stops = [token.source for token in tokens if isinstance(token, StopToken)]
        for source in stops:
            self._keyboard.stop(source)
        if stops and any(_is_alt(*pair) for pair in pairwise(tokens)):
            self._keyboard.on_alt()
        chords = [token.chord for token in tokens if isinstance(token, Key)]
        self._line.arrived(chords, play=self._keyboard.plays)
        for token in self._fewer(tokens) if self._line.untyped else tokens:
            match token:
                case Key():
                    self._key(token)
                case KeyUp(chord=chord):
                    self._keyboard.let_go(chord)
                case Paste(text=text):
                    self.process_message(events.Paste(clean_paste(text)))
                case Raw(raw=raw):
                    self._to_screen(raw)
                case TerminalReply(what="status"):
                    self._line.answered()
                case TerminalReply():
                    self._reply(token)

    def _fewer(self, tokens: list[Token]) -> Iterator[Token]:
        """What a read comes to that has more keys than anybody types: a stop may stand behind many
        such reads. A field gets the text in one piece, and of each other key the first ones count;
        where keys play, which these do not, the first.
        """
        most = 1 if self._keyboard.plays else EDITS
        seen: Counter[str] = Counter()
        text = ""
        for token in tokens:
            chord = token.chord if isinstance(token, Key) else ""
            if letter := self._keyboard.text_of(chord):
                text += letter
                continue
            if text:
                yield Paste(text, b"")
                text = ""
            seen[chord] += 1
            if not chord or seen[chord] <= most:
                yield token
        if text:
            yield Paste(text, b"")

    def _key(self, key: Key) -> None:
        at_us = self._line.now_us  # first: who stands still in between makes the key older
        age_us, stale = self._line.age_us, self._line.stale
        if self._keyboard.arrive(key.chord, age_us=age_us, stale=stale, at_us=at_us):
            return
        handled = self._keyboard.leave_to_screen(key.chord)
        try:
            self._to_screen(key.screen, age_us)
        finally:
            self._in_app(handled)

    def _to_screen(self, raw: bytes, age_us: int = 0) -> None:
        """Through Textual's parser, which sees whole sequences only and so never waits."""
        try:
            for event in self._parser.feed(raw.decode("utf-8", "replace")):
                event.time -= age_us / 1_000_000  # it may have been under way for so long
                self.process_message(event)
        except Exception:
            self._parser = XTermParser(self._debug)  # it cannot go on after an exception
            raise

    def _reply(self, reply: TerminalReply) -> None:
        if reply.what == "kitty" and reply.values:
            self._kitty = reply.values[0]
        elif reply.what == "graphics":
            self._picture_terminal.kitty = reply.values == (1,)
        elif reply.what == "attributes":  # asked last: what has not come by now will not come
            self._line.identified()
            self._scanner.expects_graphics = self._scanner.expects_background = False
            self._picture_terminal.sixel = reply.raw.startswith(b"\x1b[?") and 4 in reply.values[1:]
            found = getattr(self._app, "terminal_found", None)
            if found is not None:
                self._in_app(found, _answering_terminal(bool(self._kitty & 1)))

    def _interrupted(self) -> None:
        self._keyboard.stop("ctrl+c")


def _answering_terminal(kitty: bool) -> Terminal:
    """The terminal by its environment and by its answer."""
    guess = detect_terminal(os.environ)
    if guess.multiplexer or guess.linux:
        return replace(guess, kitty=kitty)
    return KITTY if kitty else PLAIN


def _suspend() -> None:
    """What the key for suspending does; the handler runs in the main thread."""
    os.kill(os.getpid(), signal.SIGTSTP)


def _is_alt(first: Token, second: Token) -> bool:
    """Whether they came as alt and a key do from a plain terminal: escape, the key at once."""
    return isinstance(first, StopToken) and first.raw == b"\x1b" and isinstance(second, Key)
