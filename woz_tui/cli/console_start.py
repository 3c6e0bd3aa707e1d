"""Opens the console on this terminal, for `run`, `demo`, `train`, `replay` and `attach`."""

from __future__ import annotations

import contextlib
import gc
import locale
import os
import shlex
import shutil
import sys
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from woz_tui.cli import GC_THRESHOLDS
from woz_tui.cli.progress import progress
from woz_tui.config.keys.console_keys import BUILTIN_KEYS, BuiltinKey
from woz_tui.config.screen_language import choose, say, word
from woz_tui.console.link.host_start import Launch, LaunchError, RobotProcess
from woz_tui.log.file_names import current_path
from woz_tui.protocol.sentence import said_by
from woz_tui.system.text_cleaning import lasting
from woz_tui.system.user_folders import is_first_start

if TYPE_CHECKING:
    from woz_tui.console.app import Console
    from woz_tui.console.drawing.theme import Appearance
    from woz_tui.console.input.background_colour import TerminalBackground
    from woz_tui.console.input.keyboard import Keyboard
    from woz_tui.console.link.host_connection import HostConnection
    from woz_tui.console.link.message_feed import Loss

#: How long a thread may keep the interpreter while another one waits for it, in seconds. Python's
#: own 5 ms would be added to a stop several times over while the screen is being drawn.
SWITCH_S = 0.0005


@dataclass(frozen=True, slots=True)
class ScreenOptions:
    """How the console is opened.

    `restart` are the arguments of `woz host` with which a lost robot process is started again;
    None if nobody can. `builtins` are the console's own keys, moved by a keymap file or not.
    `pictures`: how a camera's are drawn. `theme`: its colours, as `add_theme` has them. `part`:
    which part of the panels this wizard plays. `language`: what it speaks, as `add_language` has
    it; empty: what suits. `explain`: see `HostConnection`. `greeting`: what to warn of at the
    beginning, and what helps.
    """

    socket: Path
    watch: bool = False
    take_over: bool = False
    ask_participant: bool = False
    restart: Sequence[str] | None = None
    builtins: Sequence[BuiltinKey] = BUILTIN_KEYS
    pictures: str = "auto"
    theme: str = ""
    part: str = ""
    language: str = ""
    explain: Callable[[Loss], Loss] | None = None
    greeting: tuple[str, str] = ("", "")


def lacks_terminal(hint: str = "") -> bool:
    """Whether this terminal can have no console; that is said, with `hint`."""
    problem = terminal_problem()
    if problem:
        print(f"woz: {problem}{hint}", file=sys.stderr)
    return bool(problem)


def terminal_problem() -> str:
    """Why the console cannot be opened on this terminal; empty if it can."""
    from woz_tui.console.input.exit_handler import missing_terminal  # noqa: PLC0415

    return missing_terminal(sys.stdin, sys.stdout, os.environ)


def load_modules() -> None:
    """Import what the console needs, while the robot process is starting."""
    import woz_tui.console.app  # noqa: PLC0415
    import woz_tui.console.input.background_colour  # noqa: PLC0415
    import woz_tui.console.link.host_connection  # noqa: PLC0415
    import woz_tui.console.wizard_terminal  # noqa: F401, PLC0415


@dataclass(frozen=True, slots=True)
class ClosedConsole:
    """How a console was left (see `run_console`), its exit code, and what it knew of the session:
    its log, for how many seconds it goes on without a console (0: unknown), and the copy of the
    experiment file that has what was typed (empty: there is none).
    """

    left: str
    code: int
    log: str = ""
    abandon_after: float = 0.0
    typed_copy: str = ""


def open_console(options: ScreenOptions) -> ClosedConsole:
    """Run the console until it is left."""
    return close_console(make_console(options))


def close_console(app: Console) -> ClosedConsole:
    """The same with a console that is ready to run."""
    left, code = run_console(app)
    copy = app.requests.typed_copy
    return ClosedConsole(left, code, app.state.log, app.state.settings.abandon_after, copy)


def woz() -> str:
    """How a shell here finds the command: by its path where it is not linked, as in `make demo`."""
    own = sys.argv[0]
    return "woz" if Path(own).name != "woz" or shutil.which("woz") else shlex.quote(own)


def farewell(closed: ClosedConsole, again: str, log: Path | None) -> list[str]:
    """What a wizard reads in the shell: how to come back with `again` behind `woz`, or what can be
    done with the session's log; None: it is not on this computer.
    """
    lines = []
    if closed.left == "detached":
        lines.append(
            say(
                "leave.goes_on",
                "The session continues; join it again with `{woz} {again}`.",
                woz=woz(),
                again=again,
            )
        )
        if closed.abandon_after:
            after = lasting(closed.abandon_after)
            lines.append(
                say(
                    "leave.abandoned",
                    "Without a console it ends by itself after {after}"
                    " (`session: {{abandon_after: 1 h}}` in the experiment file changes that).",
                    after=after,
                )
            )
    if log is None:
        return lines
    log = current_path(log)
    said = log.with_suffix(".host.log")
    lines.append(say("leave.log_file", "Log: {log}", log=log))
    if closed.left == "ended":
        name = shlex.quote(str(log))
        lines += [
            say("leave.figures", "Its figures: {woz} report {log}", woz=woz(), log=name),
            say("leave.see_again", "See it again: {woz} replay {log}", woz=woz(), log=name),
        ]
        if closed.typed_copy:
            lines.append(say("leave.typed", "Typed sentences: {file}", file=closed.typed_copy))
    if said.is_file() and said.stat().st_size:
        lines.append(
            say("leave.errors", "Errors of drivers and of the robot process: {file}", file=said)
        )
    return lines


def make_console(options: ScreenOptions) -> Console:
    """The console, connected and ready to run; nothing has been drawn. Raises `ConnectionError`
    if the robot process has ended already.
    """
    from woz_tui.config.keys.terminals import detect_terminal  # noqa: PLC0415
    from woz_tui.console.app import Console  # noqa: PLC0415
    from woz_tui.console.link.host_connection import HostConnection  # noqa: PLC0415
    from woz_tui.console.wizard_terminal import WizardDriver  # noqa: PLC0415
    from woz_tui.machine.hidden_line import hidden_line  # noqa: PLC0415

    choose(options.language)
    look, pressed = detect_appearance(options.theme)
    link = HostConnection(
        options.socket,
        role="watcher" if options.watch else "wizard",
        name=os.environ.get("TERM", ""),
        take_over=options.take_over,
        part=options.part,
        explain=options.explain,
        line=hidden_line(os.environ),
    )
    keyboard = _connect(link, pressed.stops)
    keyboard.wait_for_session(pressed.keys)
    app = Console(
        link,
        keyboard,
        look=look,
        terminal=detect_terminal(os.environ),
        builtins=options.builtins,
        ask_participant=options.ask_participant,
        greets=is_first_start(),
        pictures=options.pictures,
        driver_class=WizardDriver,
    )
    app.greeting = options.greeting
    if options.restart is not None:
        app.restart = _restart(
            list(options.restart), lambda: app.state.log, app.call_from_thread, app.explain_loss
        )
    return app


def _connect(link: HostConnection, stops: Sequence[str]) -> Keyboard:
    """Connect, and press the stops that were pressed before there was a connection."""
    from woz_tui.console.input.keyboard import Keyboard  # noqa: PLC0415

    link.connect()
    keyboard = Keyboard(link)
    for stop in stops:
        keyboard.stop(stop)
    return keyboard


def detect_appearance(theme: str) -> tuple[Appearance, TerminalBackground]:
    """The colours and signs for this terminal, and what was pressed during the query.

    `theme` as `add_theme` has it; a choice is remembered.
    """
    from woz_tui.console.drawing.theme import choose_appearance, save_theme  # noqa: PLC0415
    from woz_tui.console.input.background_colour import (  # noqa: PLC0415
        TerminalBackground,
        ask_background,
    )

    answer = TerminalBackground()

    def light() -> bool | None:
        nonlocal answer
        answer = ask_background(sys.stdin.fileno(), sys.stdout.fileno())
        return answer.light

    if theme:
        theme = theme.replace("auto", "")
        save_theme(theme, os.environ)
    look = choose_appearance(os.environ, locale.getencoding(), theme=theme, light=light)
    return look, answer


def open_participant(
    app: type[Any],
    socket: Path,
    only: str,
    theme: str = "",
    explain: Callable[[Loss], Loss] | None = None,
) -> tuple[str, int]:
    """Run a participant's own screen until it is left: how (ended, detached), and the exit code.

    `app`: its class (`feature.ParticipantScreen.app`). `only`: the name of the one thing that is
    shown; empty: all.
    """
    from woz_tui.console.link.host_connection import HostConnection  # noqa: PLC0415
    from woz_tui.console.wizard_terminal import WizardDriver  # noqa: PLC0415

    look, pressed = detect_appearance(theme)
    link = HostConnection(
        socket, role="participant", name=os.environ.get("TERM", ""), explain=explain
    )
    keyboard = _connect(link, pressed.stops)
    screen = app(link, keyboard, only=only, look=look, driver_class=WizardDriver)
    prioritise_keys()
    return screen.run(mouse=False) or "", screen.return_code or 0


def run_console(app: Console) -> tuple[str, int]:
    """Run it until it is left: how (ended, detached, lost, failed), and the exit code.

    `failed`: it crashed before the robot process had answered it.
    """
    prioritise_keys()
    left, code = app.run(mouse=False) or "", app.return_code or 0
    return ("failed" if code == 1 and not app.state.welcomed else left), code


def prioritise_keys() -> None:
    """Tune the interpreter so that the screen's work gives way to the thread that reads keys."""
    gc.freeze()
    gc.set_threshold(*GC_THRESHOLDS)
    sys.setswitchinterval(SWITCH_S)


def _restart(
    arguments: list[str],
    log: Callable[[], str],
    in_app: Callable[..., object],
    explain: Callable[[str], None],
) -> Callable[[], None]:
    """Start the robot process again, for whoever took part last, one at a time; the link finds it
    by itself, at the same socket.
    """
    starting = threading.Lock()

    def start() -> None:
        try:
            Launch([*arguments, *_last_codes(Path(log()))]).wait()
        except LaunchError as error:
            in_app(explain, f"it did not start again: {error}")
        finally:
            starting.release()

    def restart() -> None:
        if starting.acquire(blocking=False):
            threading.Thread(target=start, name="restart", daemon=True).start()

    return restart


def _last_codes(log: Path) -> list[str]:
    """Who took part last in the session of `log`, in which condition and with which profile, as
    arguments of `woz host`; those of the command line may be over. Nobody if the log cannot be
    read: then the console asks. What the file does not allow any more is left out there.

    The screen of a wizard who is blind to the conditions does not have them. With an order, which
    the robot process proposes again, the next trial has its own.
    """
    from woz_tui.cli.shared_options import start_options  # noqa: PLC0415
    from woz_tui.feature import pieces  # noqa: PLC0415
    from woz_tui.log.log_reader import LogLine, messages  # noqa: PLC0415
    from woz_tui.timeline.session_state import SessionState  # noqa: PLC0415

    state = SessionState()
    with contextlib.suppress(OSError, ValueError):
        for message in messages(current_path(log)):
            if not isinstance(message, LogLine):
                state.apply(message)
    study = state.study
    condition = "" if study.order else study.condition
    codes = ["--restarted", "--participant", study.participant, "--condition", condition]
    for name, option in start_options().items():
        history = pieces("history", type).get(name)
        if history is not None and (value := state.history(history).restart()) is not None:
            codes += [option.flag, value]
    return codes


#: Without a console the robot process would wait for one for a long time.
ENDED = "woz: the console did not open; the robot process was ended"


@dataclass(frozen=True, slots=True)
class SessionResult:
    """How the console was left, and what ran."""

    closed: ClosedConsole
    robot: RobotProcess
    launch: Launch

    @property
    def left(self) -> str:
        """As the console says."""
        return self.closed.left

    @property
    def code(self) -> int:
        """As the console says."""
        return self.closed.code


def run_session(
    command: list[str], options: Callable[[RobotProcess], ScreenOptions]
) -> SessionResult | None:
    """Start `woz host` with `command` and a console with `options` on it; returns when the
    console is left. None: the robot process did not start, and its error was printed.

    A robot process whose console does not open is ended.
    """
    launch = Launch(command)
    try:
        with progress(patience_s=0.0) as show:
            show("Starting the robot process ...")
            load_modules()
            robot = launch.wait()
        console = make_console(options(robot))
    except LaunchError as error:
        print(word(said_by(error)), file=sys.stderr)
        return None
    except BaseException as error:
        launch.abandon()
        error.add_note(ENDED)
        raise
    closed = close_console(console)
    if closed.left == "failed":
        launch.abandon()
        print(ENDED, file=sys.stderr)
    return SessionResult(closed, robot, launch)
