"""The terminal: what it can show, which keys it can tell apart, how long a key is on its way."""

from __future__ import annotations

import contextlib
import locale
import os
import re
import select
import shutil
import statistics
import termios
import time
import tty
from collections.abc import Iterator, Mapping

from woz_tui.drivers.contract import Finding
from woz_tui.machine.hidden_line import hidden_line
from woz_tui.machine.program_output import output_of
from woz_tui.protocol.sentence import Sentence

#: Smallest screen the console is laid out for.
COLUMNS, LINES = 80, 24
#: Round trips longer than these are felt, and make keys stale (seconds).
SLOW_LINE = 0.15
STALE_LINE = 1.0
#: tmux holds a lone escape back for this long at most without anybody noticing (milliseconds).
ESCAPE_TIME = 25
#: Since this version tmux's own default is short enough.
TMUX = (3, 5)

_TERMINAL = Sentence("terminal.terminal", "terminal")
_CHARACTERS = Sentence("terminal.characters", "characters")
_COLOURS = Sentence("terminal.colours", "colours")

_STATUS = re.compile(rb"\x1b\[\?[\d;]*c")
_KITTY = re.compile(rb"\x1b\[\?(\d+)u")
_CURSOR = re.compile(rb"\x1b\[\d+;\d+R")


def environment(environ: Mapping[str, str]) -> list[Finding]:
    """What the environment says about it: type, character set, colours."""
    return [_type(environ.get("TERM", "")), _characters(), _colours(environ)]


def _type(term: str) -> Finding:
    if term in {"", "dumb", "unknown"}:
        text = Sentence(
            "terminal.no_cursor", "TERM is {term!r}: it cannot move the cursor", term=term
        )
        remedy = Sentence("terminal.real_one", "use a real terminal; over SSH, ssh -t")
        return Finding("error", _TERMINAL, text, remedy)
    text = Sentence("terminal.term", "TERM is {term}", term=term)
    return Finding("ok", _TERMINAL, text)


def _characters() -> Finding:
    with contextlib.suppress(locale.Error):
        locale.setlocale(locale.LC_CTYPE, "")
    charset = locale.nl_langinfo(locale.CODESET)
    if charset.upper().replace("-", "") == "UTF8":
        return Finding("ok", _CHARACTERS, charset)
    text = Sentence(
        "terminal.charset",
        "{charset}: letters with accents and bars will be wrong",
        charset=charset,
    )
    return Finding("warning", _CHARACTERS, text, "export LANG=C.UTF-8")


def _colours(environ: Mapping[str, str]) -> Finding:
    term = environ.get("TERM", "")
    if environ.get("NO_COLOR"):
        return Finding("info", _COLOURS, Sentence("terminal.no_color", "NO_COLOR is set: none"))
    if environ.get("COLORTERM") in {"truecolor", "24bit"}:
        return Finding("ok", _COLOURS, Sentence("terminal.true_color", "16 million"))
    if "256color" in term or term in {"xterm-kitty", "alacritty", "foot", "xterm-ghostty"}:
        return Finding("ok", _COLOURS, "256")
    few = Sentence("terminal.few_colours", "16 or fewer; states also have a symbol and a word")
    return Finding("info", _COLOURS, few)


def size() -> Finding:
    """Whether the console fits."""
    columns, lines = shutil.get_terminal_size((COLUMNS, LINES))
    if columns >= COLUMNS and lines >= LINES:
        return Finding("ok", "size", f"{columns} x {lines}")
    text = f"{columns} x {lines} is smaller than {COLUMNS} x {LINES}: panels will scroll"
    return Finding("warning", "size", text, "make the window larger or the font smaller")


# -- what only the terminal itself can answer ---------------------------------------------------


@contextlib.contextmanager
def controlling() -> Iterator[int | None]:
    """A descriptor of the terminal this process was started from; None if there is none.

    None as well in the background, where changing the terminal's mode would stop the process.
    """
    try:
        descriptor = os.open("/dev/tty", os.O_RDWR | os.O_NOCTTY | os.O_CLOEXEC)
    except OSError:
        yield None
        return
    try:
        yield descriptor if _in_front(descriptor) else None
    finally:
        os.close(descriptor)


def _in_front(descriptor: int) -> bool:
    try:
        return os.tcgetpgrp(descriptor) == os.getpgrp()
    except OSError:
        return False


def conversation(descriptor: int, seconds: float = 1.0) -> list[Finding]:
    """Ask the terminal which keys it can tell apart and time its answers, which inside tmux, screen
    or mosh would be theirs.

    `seconds` bounds each answer. Keys typed meanwhile are thrown away.
    """
    with _raw(descriptor):
        keys = keyboard(descriptor, seconds)
        return [keys] if hidden_line(os.environ).name else [keys, line(descriptor, seconds)]


@contextlib.contextmanager
def _raw(descriptor: int) -> Iterator[None]:
    before = termios.tcgetattr(descriptor)
    tty.setraw(descriptor, termios.TCSANOW)
    try:
        yield
    finally:
        termios.tcsetattr(descriptor, termios.TCSAFLUSH, before)


def keyboard(descriptor: int, seconds: float) -> Finding:
    """Whether it speaks the kitty keyboard protocol. The terminal must be in raw mode.

    Every terminal answers the second question (device attributes), so that the silence on the
    first is known as soon as that answer comes.
    """
    answer = _ask(descriptor, b"\x1b[?u\x1b[c", _STATUS, seconds)
    if _KITTY.search(answer):
        text = "can distinguish all keys (kitty keyboard protocol)"
        return Finding("ok", "keys", text)
    if _STATUS.search(answer):
        text = (
            "plain: it cannot distinguish ctrl+digits, shift+enter and alt+letters from other keys"
        )
        return Finding("info", "keys", text, "`woz check FILE --keys` lists what each key sends")
    text = f"the terminal did not respond within {seconds:g} s; assumed to be plain"
    return Finding("warning", "keys", text, "`woz check FILE --keys` lists what each key sends")


def line(descriptor: int, seconds: float, times: int = 5) -> Finding:
    """How long a byte takes to the terminal and back. The terminal must be in raw mode."""
    trips: list[float] = []
    for _ in range(times):
        begin = time.monotonic()
        if not _CURSOR.search(_ask(descriptor, b"\x1b[6n", _CURSOR, seconds)):
            text = f"no answer within {seconds:g} s"
            return Finding("warning", "connection", text, "keys may arrive late or in bursts")
        trips.append(time.monotonic() - begin)
    text = f"{statistics.median(trips) * 1e3:.1f} ms there and back, at worst "
    text += f"{max(trips) * 1e3:.1f} ms"
    if max(trips) < SLOW_LINE:
        return Finding("ok", "connection", text)
    level = "error" if max(trips) >= STALE_LINE else "warning"
    return Finding(level, "connection", text, "use a cable or a nearer access point")


def _ask(descriptor: int, question: bytes, until: re.Pattern[bytes], seconds: float) -> bytes:
    """What comes back until `until` matches or `seconds` have passed."""
    deadline = time.monotonic() + seconds
    termios.tcflush(descriptor, termios.TCIFLUSH)
    if not select.select([], [descriptor], [], seconds)[1]:  # stopped by ctrl+s, or a dead line
        return b""
    os.write(descriptor, question)
    answer = b""
    while not until.search(answer):
        ready, _, _ = select.select([descriptor], [], [], max(0.0, deadline - time.monotonic()))
        chunk = os.read(descriptor, 1024) if ready else b""
        if not chunk:
            break
        answer += chunk
    return answer


# -- what stands between it and us --------------------------------------------------------------


def multiplexers(environ: Mapping[str, str]) -> list[Finding]:
    """What tmux, screen and mosh hide: the escape key, which is the stop, and a lost line."""
    line, findings = hidden_line(environ), list[Finding]()
    if line.name:
        text = Sentence(
            "terminal.between",
            "{program} stands between you and the console: a frozen connection is not noticed, a"
            " closed one is",
            program=line.name,
        )
        if not line.ask:
            text = Sentence(
                "terminal.between_all",
                "{program} stands between you and the console: neither a frozen nor a closed"
                " connection is noticed",
                program=line.name,
            )
        remedy = Sentence(
            "terminal.hold",
            "hold a key to drive; without {program} the connection itself is watched",
            program=line.name,
        )
        subject = Sentence("preflight.connection", "connection")
        findings.append(Finding("info", subject, text, remedy))
    if environ.get("TMUX"):
        wait = output_of(["tmux", "show", "-gv", "escape-time"])
        findings.append(tmux_escape(wait, output_of(["tmux", "-V"])))
    if environ.get("STY"):
        text = Sentence("terminal.screen_escape", "screen delays Escape (stop) by up to 0.3 s")
        findings.append(Finding("warning", "screen", text, "maptimeout 5 in ~/.screenrc"))
    return findings


def tmux_escape(wait: str | None, version: str | None) -> Finding:
    """What tmux's `escape-time` (milliseconds) means for the stop; `version` as `tmux -V` says."""
    number = re.search(r"(\d+)\.(\d+)", version or "")
    old = number is not None and (int(number[1]), int(number[2])) < TMUX
    if wait is None or not wait.isdecimal():
        level = "info"
        text = Sentence(
            "terminal.tmux_unknown", "tmux does not report how long it delays Escape (stop)"
        )
    else:
        level = "warning"
        text = Sentence("terminal.tmux_escape", "tmux delays Escape (stop) by {ms} ms", ms=wait)
        if int(wait) <= ESCAPE_TIME:
            return Finding("ok", "tmux", text)
    if old:
        text = Sentence(
            "terminal.tmux_old",
            "{delay} ({version} is older than 3.5, whose own setting is short)",
            delay=text,
            version=version,
        )
    remedy = Sentence(
        "terminal.tmux_remedy",
        "set -sg escape-time 10 in ~/.tmux.conf; at once: tmux set -sg escape-time 10",
    )
    return Finding(level, "tmux", text, remedy)
