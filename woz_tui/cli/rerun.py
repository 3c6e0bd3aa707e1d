"""`woz replay FILE --robot` and `--dry-run`: a session's commands again, on the robot.

The options are declared by `woz replay` (`replay.py`), which calls `play`.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import selectors
import signal
import socket
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from woz_tui.analysis.text_format import exact_clock
from woz_tui.cli.console_start import ScreenOptions, lacks_terminal, run_session
from woz_tui.cli.experiment_changes import change_lines, error_lines
from woz_tui.cli.shared_options import builtins
from woz_tui.cli.single_keys import single_keys
from woz_tui.config.bundled_files import bundled_file
from woz_tui.config.experiment import Experiment
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.keys.console_keys import BuiltinKey
from woz_tui.console.link.host_start import Launch, LaunchError, RobotProcess, host_arguments
from woz_tui.drivers.plugins import installed
from woz_tui.log.file_names import current_path
from woz_tui.protocol import codec
from woz_tui.protocol.requests import PROTOCOL, AskStop, Hello
from woz_tui.replay import experiment_origin
from woz_tui.replay.opened_log import LogError, log_in
from woz_tui.replay.rerun_plan import (
    RerunPlan,
    fitted,
    plan_of,
    redacted_plan,
    unfit_steps,
)
from woz_tui.replay.rerun_progress import RerunLines
from woz_tui.session.redactor import Redactor
from woz_tui.system.clock import RealClock
from woz_tui.system.text_cleaning import clean

_YES = "yes"
_ESCAPE, _CTRL_C = b"\x1b", b"\x03"
_STOPPED = 130
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
#: Characters of the arguments that a line of the table has room for.
ARGS = 56
#: Different reasons for leaving something out that the summary tells.
REASONS = 8


@dataclass(frozen=True, slots=True)
class _Rerun:
    """What is to be run: the log, the experiment of now, the plan for its robot, the same as its
    wizard may see it, and what has changed since.
    """

    log: Path
    experiment: Experiment
    plan: RerunPlan
    visible_plan: RerunPlan
    changed: list[str]
    redactor: Redactor


def play(arguments: argparse.Namespace) -> int:
    """Run a log again, or say what would be run.

    Reads `file` (a log), `robot`, `dry_run`, `yes`, `headless`, `keymap`, `theme`, `changed` (the
    experiment may have changed) and `experiment` (where it is, or None). The exit code: 0, or 1 if
    something could not be done.
    """
    on_screen = not (arguments.dry_run or arguments.headless)
    if on_screen and lacks_terminal(" (--headless runs it without a console)"):
        return 2
    rerun = _prepare(arguments)
    if rerun is None:
        return 1
    if arguments.dry_run:
        return _dry_run(rerun, arguments)
    own_keys = builtins(arguments)  # before the question: the file may be wrong
    if not _check_runnable(rerun, arguments) or not _confirmed(arguments.yes):
        return 1
    command = _host_command(rerun, arguments)
    if arguments.headless:
        # Setpoints that come in streams are too many for a line each.
        streams = frozenset(
            (spec.name, verb.name)
            for spec in rerun.experiment.drivers
            for verb in spec.offer.verbs
            if verb.stream
        )
        return watch(Launch([*command, "--headless"]), streams, rerun.redactor)
    return _in_console(command, own_keys, arguments.theme)


def _check_runnable(rerun: _Rerun, arguments: argparse.Namespace) -> bool:
    """Print the summary and return True, or print why the log cannot be run."""
    if rerun.changed and not arguments.changed:
        print(*rerun.changed, sep="\n", file=sys.stderr)
        print("woz: use --changed to run it nevertheless", file=sys.stderr)
        return False
    if not rerun.plan.sent:
        print(*table_lines(rerun.visible_plan), sep="\n")
        print("woz: this log has no command that can be sent again", file=sys.stderr)
        return False
    summary = summary_lines(rerun.visible_plan, rerun.experiment, headless=arguments.headless)
    print(*summary, sep="\n")
    return True


def _prepare(arguments: argparse.Namespace) -> _Rerun | None:
    """Read the log and the experiment; None after printing why that fails."""
    try:
        log = log_in(arguments.file)
        plan = plan_of(log)
        file, name = arguments.experiment, Path(plan.origin.name).name
        if file is None and name and not experiment_origin.candidate_files(log, name):
            file = bundled_file(name)
        experiment = experiment_origin.find_experiment(log, plan.origin, installed(), file)
    except ExperimentError as error:
        print(*error_lines(plan.origin, error, reveal=arguments.reveal), sep="\n", file=sys.stderr)
        return None
    except (ValueError, LogError, experiment_origin.OriginError) as error:
        print(f"woz: {error}", file=sys.stderr)
        return None
    changes = change_lines(plan.origin, experiment, reveal=arguments.reveal)
    redactor = experiment_origin.redactor_of(plan.origin, experiment, reveal=arguments.reveal)
    plan = fitted(plan, experiment)
    return _Rerun(log, experiment, plan, redacted_plan(plan, redactor), changes, redactor)


def _dry_run(rerun: _Rerun, arguments: argparse.Namespace) -> int:
    """Print what would be sent; 1 if a command could not be."""
    summary = summary_lines(rerun.visible_plan, rerun.experiment, headless=arguments.headless)
    print(*summary, *table_lines(rerun.visible_plan), *rerun.changed, sep="\n")
    print(verdict_line(rerun.plan))
    refused = bool(rerun.changed) and not arguments.changed
    return int(refused or bool(unfit_steps(rerun.plan)) or not rerun.plan.sent)


def _confirmed(yes: bool) -> bool:
    """Ask, unless `yes`; only the whole word counts."""
    if yes:
        return True
    if not sys.stdin.isatty():
        print(
            "woz: standard input is not a terminal; use --yes to run it without a question",
            file=sys.stderr,
        )
        return False
    try:
        answer = input("Is the robot free to move? Type yes to run it again: ")
    except EOFError:
        answer = ""
    if answer.strip().lower() == _YES:
        return True
    print("Nothing was run.")
    return False


def _host_command(rerun: _Rerun, arguments: argparse.Namespace) -> list[str]:
    """Behind `woz host`. Nobody takes part in a re-run, so it has no participant and no condition;
    its log lies beside the original.
    """
    recordings = getattr(arguments, "recordings", None) or rerun.log.absolute().parent
    seed = rerun.plan.seed
    return [
        *host_arguments(
            rerun.experiment.path,
            recordings=recordings,
            spill=None,
            name="",
            codes={"seed": str(seed) if seed else ""},
            robot=rerun.experiment.robot,
        ),
        "--rerun",
        str(rerun.log),
    ]


def _in_console(command: list[str], own_keys: Sequence[BuiltinKey], theme: str) -> int:
    opened = run_session(  # nobody starts it again from the console: it would begin anew
        command,
        lambda robot: ScreenOptions(socket=robot.socket, builtins=own_keys, theme=theme),
    )
    if opened is None:
        return 1
    if opened.left == "detached":
        print("The session continues, without driving; join it again with `woz attach`.")
    print(f"Log: {current_path(opened.robot.log)}")
    return opened.code


# -- the summary before the question, and the dry run ---------------------------------------------


def summary_lines(plan: RerunPlan, experiment: Experiment, *, headless: bool) -> Iterator[str]:
    """What will be run, on what, and what will not."""
    drives = sum(step.drives for step in plan.sent)
    yield f"session     {plan.session or 'without a code'}  ({clean(plan.name)})"
    yield f"experiment  {clean(experiment.title)}  ({experiment.path})"
    types = {spec.name: spec.type for spec in experiment.drivers}
    robot = ", ".join(f"{clean(name)} ({types.get(name, '?')})" for name in plan.drivers)
    yield f"robot       {robot or 'none'}"
    yield f"commands    {len(plan.sent)} in {exact_clock(plan.duration)}"
    by_driver: dict[str, list[str]] = {}
    for (driver, verb), count in plan.counts.items():
        by_driver.setdefault(clean(driver), []).append(f"{count} {clean(verb)}")
    for name, counts in by_driver.items():
        yield f"              {name}: {', '.join(counts)}"
    if drives:
        who = (
            "are refused, because no wizard watches" if headless else "need a wizard at the console"
        )
        yield f"drives      {drives}: they {who}"
    cut = sum(step.cut >= 0 for step in plan.sent)
    if cut:
        yield f"cut short   {cut}, at the same moments as in the log"
    if plan.stops:
        yield f"stops       {plan.stops} in the log; the stop is not pressed again"
    reasons = Counter(clean(step.skip) for step in plan.skipped).most_common()
    for reason, count in reasons[:REASONS]:
        yield f"left out    {count}: {reason}"
    if rest := sum(count for _, count in reasons[REASONS:]):
        yield f"left out    {rest}: for other reasons; --dry-run names each"
    if not plan.ended:
        yield "the log has no end: its session was interrupted, or is still running"
    for sentence in plan.damage:
        yield f"damage      {clean(sentence)}"


def table_lines(plan: RerunPlan) -> Iterator[str]:
    """One line for each command of the original, in order."""
    names = [f"{clean(step.command.driver)}.{clean(step.command.verb)}" for step in plan.steps]
    width = min(28, max(map(len, names), default=8))
    yield f"{'time':>10}  {'command':{width}}  {'arguments':{ARGS}}  what"
    for name, step in zip(names, plan.steps, strict=True):
        time = exact_clock(step.at - plan.start)
        args = step.command.args
        text = clean(json.dumps(args, ensure_ascii=False)) if args else ""
        shown = text if len(text) <= ARGS else f"{text[: ARGS - 3]}..."
        what = "drives" if step.drives else "sent"
        if step.skip:
            what = f"left out: {clean(step.skip)}"
        elif step.cut >= 0:
            what += f", cut at {exact_clock(step.cut - plan.start)} ({clean(step.why_cut)})"
        yield f"{time:>10}  {name:{width}}  {shown:{ARGS}}  {what}"


def verdict_line(plan: RerunPlan) -> str:
    """The last line of a dry run."""
    text = f"{len(plan.sent)} would be sent, {len(plan.skipped)} left out"
    impossible = len(unfit_steps(plan))
    return f"{text}, {impossible} of them because this robot cannot do them" if impossible else text


# -- without a console ----------------------------------------------------------------------------


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
        link = opened.enter_context(socket.socket(socket.AF_UNIX))
        link.connect(str(robot.socket))
        hello = Hello(role="program", name="rerun", protocol=PROTOCOL, stream="actions")
        link.sendall(codec.encode(hello))
        signals = opened.enter_context(_signals())
        keys = opened.enter_context(single_keys())
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
                    data = b""
                    with contextlib.suppress(ConnectionError):  # it has died
                        data = link.recv(1 << 16)
                    if not data:
                        return stopped
                    *lines, rest = (rest + data).split(b"\n")
                    for line in lines:
                        with contextlib.suppress(codec.WireError):
                            for text in progress.lines(codec.decode_incoming(line)):
                                print(text, flush=True)
                    continue
                typed = os.read(key.fd, 64)
                if key.fileobj is signals or _ESCAPE in typed or _CTRL_C in typed:
                    if stopped:
                        raise KeyboardInterrupt
                    stopped = True
                    with contextlib.suppress(ConnectionError):
                        stop = AskStop(source="key", sent_us=RealClock().boot_us())
                        link.sendall(codec.encode(stop))


def _noted(_number: int, _frame: object) -> None:
    """It is read from the socket."""


@contextlib.contextmanager
def _signals() -> Iterator[socket.socket]:
    """Readable as soon as a signal has come that means the end: then the robot is stopped first."""
    reader, writer = socket.socketpair()
    reader.setblocking(False)
    writer.setblocking(False)
    before = {number: signal.signal(number, _noted) for number in _SIGNALS}
    wakeup = signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    try:
        yield reader
    finally:
        signal.set_wakeup_fd(wakeup)
        for number, handler in before.items():
            signal.signal(number, handler)
        reader.close()
        writer.close()
