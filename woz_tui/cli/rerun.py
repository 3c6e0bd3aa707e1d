"""`woz replay FILE --robot` and `--dry-run`: a session's commands again, on the robot.

The options are declared by `woz replay` (`replay.py`), which calls `play`.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass
from pathlib import Path

from woz_tui.cli import rerun_table as table
from woz_tui.cli.console_start import run_session
from woz_tui.cli.error_sentences import with_error_sentences
from woz_tui.cli.experiment_changes import change_lines, error_lines, redactor_of
from woz_tui.cli.host_start import Launch, host_arguments
from woz_tui.config.experiment import Experiment, ExperimentError
from woz_tui.log.file_names import current_path
from woz_tui.replay.rerun_plan import RerunPlan
from woz_tui.session.redactor import Redactor

_YES = "yes"


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

    Reads `file` (a log), `robot`, `dry_run`, `yes`, `headless`, `changed` (the experiment may have
    changed) and `experiment` (where it is, or None). The exit code: 0, or 1 if something could not
    be done or stood against it.
    """
    if not arguments.dry_run and not arguments.headless:
        from woz_tui.cli import console_start  # noqa: PLC0415

        refused = console_start.refusal()
        if refused:
            print(f"woz: {refused} (--headless runs it without a console)", file=sys.stderr)
            return 2
    return with_error_sentences(lambda: _play(arguments))


def _play(arguments: argparse.Namespace) -> int:
    rerun = _prepare(arguments)
    if rerun is None:
        return 1
    if arguments.dry_run:
        return _dry_run(rerun, arguments)
    if not _check_runnable(rerun, arguments) or not _confirmed(arguments.yes):
        return 1
    command = _host_command(rerun, arguments)
    if arguments.headless:
        from woz_tui.cli import rerun_headless  # noqa: PLC0415

        launch = Launch([*command, "--headless"])
        return rerun_headless.watch(launch, _streams(rerun), rerun.redactor)
    return _in_console(command)


def _check_runnable(rerun: _Rerun, arguments: argparse.Namespace) -> bool:
    """Whether nothing stands against it; says what does, and else what will be run."""
    if rerun.changed and not arguments.changed:
        print(*rerun.changed, sep="\n", file=sys.stderr)
        print("woz: use --changed to run it nevertheless", file=sys.stderr)
        return False
    if not rerun.plan.sent:
        print(*table.table(rerun.visible_plan), sep="\n")
        print("woz: this log has no command that can be sent again", file=sys.stderr)
        return False
    summary = table.summary(rerun.visible_plan, rerun.experiment, headless=arguments.headless)
    print(*summary, sep="\n")
    return True


def _prepare(arguments: argparse.Namespace) -> _Rerun | None:
    """Everything that has to be known before; None after saying why it cannot be."""
    from woz_tui.replay import experiment_origin  # noqa: PLC0415
    from woz_tui.replay.opened_log import LogError, log_in  # noqa: PLC0415
    from woz_tui.replay.rerun_plan import fitted, plan_of  # noqa: PLC0415

    try:
        log = log_in(arguments.file)
        plan = plan_of(log)
        file = arguments.experiment or _bundled(log, plan.origin.name)
        experiment = _load_experiment(log, plan, file, reveal=arguments.reveal)
    except (ValueError, LogError, experiment_origin.OriginError) as error:
        print(f"woz: {error}", file=sys.stderr)
        return None
    if experiment is None:
        return None
    changes = change_lines(plan.origin, experiment, reveal=arguments.reveal)
    redactor = redactor_of(plan.origin, experiment, reveal=arguments.reveal)
    plan = fitted(plan, experiment)
    return _Rerun(log, experiment, plan, table.redacted(plan, redactor), changes, redactor)


def _load_experiment(
    log: Path, plan: RerunPlan, file: Path | None, *, reveal: bool
) -> Experiment | None:
    """The experiment of now; None after saying what is wrong with it."""
    from woz_tui.drivers.plugins import installed  # noqa: PLC0415
    from woz_tui.replay import experiment_origin  # noqa: PLC0415

    try:
        return experiment_origin.find_experiment(log, plan.origin, installed(), file)
    except ExperimentError as error:
        print(*error_lines(plan.origin, error, reveal=reveal), sep="\n", file=sys.stderr)
        return None


def _bundled(log: Path, name: str) -> Path | None:
    """The experiment of this name that comes with woz-tui, if there is none near the log."""
    from woz_tui.cli.demo import demo_file  # noqa: PLC0415
    from woz_tui.replay.experiment_origin import candidate_files  # noqa: PLC0415

    name = Path(name).name
    return demo_file(name) if name and not candidate_files(log, name) else None


def _dry_run(rerun: _Rerun, arguments: argparse.Namespace) -> int:
    """Moves nothing, needs no robot. 1 if something of it could not be sent."""
    from woz_tui.replay.rerun_plan import unfit_steps  # noqa: PLC0415

    summary = table.summary(rerun.visible_plan, rerun.experiment, headless=arguments.headless)
    print(*summary, *table.table(rerun.visible_plan), *rerun.changed, sep="\n")
    print(table.verdict(rerun.plan))
    refused = bool(rerun.changed) and not arguments.changed
    return int(refused or bool(unfit_steps(rerun.plan)) or not rerun.plan.sent)


def _confirmed(yes: bool) -> bool:
    """Ask, unless it was said already; nothing but the whole word counts."""
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
        ),
        "--rerun",
        str(rerun.log),
    ]


def _streams(rerun: _Rerun) -> frozenset[tuple[str, str]]:
    """Driver and verb of setpoints that come in streams: too many for a line each."""
    return frozenset(
        (spec.name, verb.name)
        for spec in rerun.experiment.drivers
        for verb in spec.verbs
        if verb.stream
    )


def _in_console(command: list[str]) -> int:
    from woz_tui.cli.console_start import ScreenOptions  # noqa: PLC0415

    # Nobody starts it again from the console: the robot would begin from the beginning.
    opened = run_session(command, lambda robot: ScreenOptions(socket=robot.socket))
    if opened is None:
        return 1
    if opened.left == "detached":
        print("The session continues, without driving; join it again with `woz attach`.")
    print(f"Log: {current_path(opened.robot.log)}")
    return opened.code
