"""A re-run without a console: lines about its progress, and the stop on escape or ctrl+c."""

from __future__ import annotations

import contextlib
import os
import selectors
import signal
import socket
import sys
import termios
import tty
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from woz_tui.cli.host_start import Launch, LaunchError, RobotProcess
from woz_tui.cli.rerun_table import clock
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.protocol.requests import AskStop, Hello, Request
from woz_tui.session.redactor import Redactor
from woz_tui.system.text_cleaning import clean
from woz_tui.timeline.episodes import OUTCOMES

#: Ends of commands that are as planned.
_EXPECTED = (m.Done, m.Stopped, m.Superseded)
_ESCAPE, _CTRL_C = b"\x1b", b"\x03"
_STOPPED = 130
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass
class RerunLines:
    """The messages of a re-run so far; `lines` returns what is printed for the next one.

    `streams`: driver and verb of setpoints that get no line each. `redactor`: hides what the
    wizard of then was not to know.
    """

    streams: frozenset[tuple[str, str]] = frozenset()
    redactor: Redactor = field(default_factory=Redactor)
    commands: dict[str, m.Command] = field(default_factory=dict)
    began: int = 0
    failed: int = 0
    ended: m.RerunEnded | None = None

    def lines(self, message: object) -> Iterator[str]:
        """Lines for `message`; usually one or none."""
        if isinstance(message, m.Message):
            visible = self.redactor.message(message)
            if visible is not None:
                yield from self._lines(visible)

    def _lines(self, message: m.Message) -> Iterator[str]:
        match message:
            case m.RerunStarted():
                self.began = message.t
                yield f"{message.commands} commands of {clean(message.original)}"
            case m.Command(source="replay"):
                self.commands[message.command] = message
            case m.RerunSent():
                yield from self._sent(message)
            case m.RerunSkipped():
                yield f"{self._time(message.t)}  {message.original_command} is left out:" + (
                    f" {clean(message.reason)}"
                )
            case m.RerunEnded():
                self.ended = message
            case m.Notice(level=level, text=text):
                yield f"{self._time(message.t)}  {level}: {clean(text)}"
            case m.DriverLost() | m.DriverFaulted():
                yield f"{self._time(message.t)}  {message.driver}: {clean(message.detail)}"
            case m.End():
                yield from self._end(message)

    def _sent(self, sent: m.RerunSent) -> Iterator[str]:
        command = self.commands.get(sent.command)
        if command is None or (command.driver, command.verb) in self.streams:
            return
        args = clean(", ".join(f"{name} {value}" for name, value in command.args.items()))
        what = clean(f"{command.driver}.{command.verb}")
        yield f"{self._time(sent.due)}  {what} {args[:80]}  ({sent.late_us / 1000:.1f} ms late)"

    def _end(self, end: m.End) -> Iterator[str]:
        command = self.commands.pop(end.command, None)
        if command is None or isinstance(end, _EXPECTED):
            return
        self.failed += 1
        how = OUTCOMES[type(end)].replace("_", " ")
        what = clean(f"{command.driver}.{command.verb}")
        yield f"{self._time(end.t)}  {what} {how}: {clean(end.reason)}"

    def _time(self, t: int) -> str:
        return f"{clock(t - self.began):>10}"


def watch(launch: Launch, streams: frozenset[tuple[str, str]], redactor: Redactor) -> int:
    """Print its lines until it ends: 0 if all was done, 130 after a stop from here, else 1."""
    try:
        robot = launch.wait()
    except LaunchError as error:
        print(error, file=sys.stderr)
        return 1
    progress = RerunLines(streams, redactor)
    stopped = False
    try:
        with contextlib.suppress(ConnectionError, FileNotFoundError):  # gone, as is told below
            stopped = _print_until_closed(robot, progress)
    except BaseException:
        launch.abandon()
        raise
    print(f"Log: {robot.log}")
    if stopped:
        return _STOPPED
    if progress.ended is None:
        print(f"woz: the robot process has ended; see {robot.host_log}", file=sys.stderr)
        return 1
    return int(progress.ended.reason != "done" or progress.failed > 0)


def _print_until_closed(robot: RobotProcess, progress: RerunLines) -> bool:
    """Print until the robot process closes the connection; whether it was stopped from here."""
    stopped = False
    with contextlib.ExitStack() as opened:
        link = opened.enter_context(_connected(robot.socket))
        signals = opened.enter_context(_signals())
        keys = opened.enter_context(_keys())
        selector = opened.enter_context(selectors.DefaultSelector())
        selector.register(link, selectors.EVENT_READ)
        selector.register(signals, selectors.EVENT_READ)
        if keys is not None:
            selector.register(keys, selectors.EVENT_READ)
            print("escape or ctrl+c stops it", flush=True)
        rest = b""
        while True:
            for key, _ in selector.select():
                if key.fileobj is link:
                    data = _receive(link)
                    if not data:
                        return stopped
                    *lines, rest = (rest + data).split(b"\n")
                    _print(progress, lines)
                elif key.fileobj is signals or _is_stop(key.fd):
                    if key.fileobj is signals:
                        signals.recv(64)
                    if stopped:
                        raise KeyboardInterrupt
                    stopped = True
                    with contextlib.suppress(ConnectionError):
                        _send(link, AskStop(source="key"))


def _receive(link: socket.socket) -> bytes:
    """What has come; nothing when the robot process has closed, or died."""
    try:
        return link.recv(1 << 16)
    except ConnectionError:
        return b""


def _print(progress: RerunLines, lines: list[bytes]) -> None:
    for line in lines:
        with contextlib.suppress(codec.WireError):
            for text in progress.lines(codec.decode_incoming(line)):
                print(text, flush=True)


def _is_stop(keyboard: int) -> bool:
    typed = os.read(keyboard, 64)
    return _ESCAPE in typed or _CTRL_C in typed


def _send(link: socket.socket, request: Request) -> None:
    link.sendall(codec.encode(request))


@contextlib.contextmanager
def _connected(path: Path) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_UNIX) as link:
        link.connect(str(path))
        _send(link, Hello(role="program", name="rerun", stream="actions"))
        yield link


@contextlib.contextmanager
def _signals() -> Iterator[socket.socket]:
    """Readable as soon as a signal has come that means the end: then the robot is stopped first."""
    reader, writer = socket.socketpair()
    reader.setblocking(False)
    writer.setblocking(False)
    before = {number: signal.signal(number, lambda *_: None) for number in _SIGNALS}
    wakeup = signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    try:
        yield reader
    finally:
        signal.set_wakeup_fd(wakeup)
        for number, handler in before.items():
            signal.signal(number, handler)
        reader.close()
        writer.close()


@contextlib.contextmanager
def _keys() -> Iterator[int | None]:
    """The terminal's keys one by one; None if nobody can press any."""
    if not sys.stdin.isatty():
        yield None
        return
    keyboard = sys.stdin.fileno()
    before = termios.tcgetattr(keyboard)
    tty.setcbreak(keyboard)
    try:
        yield keyboard
    finally:
        termios.tcsetattr(keyboard, termios.TCSADRAIN, before)
