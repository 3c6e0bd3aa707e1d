"""`woz engagement LOG.jsonl`: a session's log through the engagement model once more.

The same follower that the robot process uses reads the same messages, so with the settings of the
session its transitions come out exactly as they were; with others they tell what those would have
said. What the robot did then it has done: its sentences stay where they were.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from woz_tui.core import messages as m
from woz_tui.experiment.engagement import EngagementSettings
from woz_tui.record.log import Damage, Line, read
from woz_tui.sensing.model import Change
from woz_tui.sensing.passing import SECOND
from woz_tui.sensing.stream import Follower

_SAMPLE = "sample"
#: The folder in which a project keeps its experiments, beside the one of its logs.
_EXPERIMENTS = "experiments"


@dataclass
class Recount:
    """What a log says, and what the model makes of it now; times in microseconds.

    `recorded` are the transitions that the session has logged, `computed` those of now. `end` is
    the last line's time, `sensors` what of the model's signs was ever sensed, `reloads` when the
    section of the experiment was changed while the session ran.
    """

    recorded: list[Change] = field(default_factory=list)
    computed: list[Change] = field(default_factory=list)
    end: int = 0
    sensors: set[str] = field(default_factory=set)
    reloads: list[int] = field(default_factory=list)
    start: m.SessionStart | None = None


def run(arguments: argparse.Namespace, settings: EngagementSettings) -> int:
    """Print the transitions as lines, or beside those that were recorded; or how trials went."""
    path = Path(arguments.file)
    if arguments.experiment is None:
        settings = _settings_of_session(arguments, path, settings)
    if arguments.trials:
        from woz_tui.cli import engagement_trials  # noqa: PLC0415

        engagement_trials.show(path, settings, as_json=arguments.json)
        return 0
    damage = Damage()
    lines = not arguments.compare
    recount = recounted(path, settings, damage, _print_change if lines else _keep_quiet)
    _hints(recount, settings, damage)
    if arguments.compare:
        from woz_tui.cli import engagement_compare  # noqa: PLC0415

        engagement_compare.show(recount, as_json=bool(getattr(arguments, "json", False)))
    return 0


def recounted(
    path: Path,
    settings: EngagementSettings,
    damage: Damage,
    tell: Callable[[Change], object] = lambda change: None,
) -> Recount:
    """Read the log to which `path` belongs; `tell` hears of each transition as it is computed.

    Raises `FileNotFoundError` and `ValueError` as `record.log.read` does.
    """
    follower = Follower(settings)
    recount = Recount()

    def follow(changes: list[Change]) -> None:
        recount.computed += changes
        for change in changes:
            tell(change)

    for line in read(path, damage):
        recount.end = max(recount.end, line.t)
        if line.kind == _SAMPLE and line.fields.get("sensor") not in follower.sensors:
            continue
        message = message_of(line)
        if message is not None:
            _noted(recount, message)
            follow([*follower.take(message)])
    follow([*follower.until(recount.end)])
    return recount


def message_of(line: Line) -> m.AnyMessage | None:
    """The line as a message; a truth value counts as the number that it is live."""
    if line.kind == _SAMPLE and isinstance(line.fields.get("value"), bool):
        sensor, value = str(line.fields.get("sensor")), float(line.fields["value"])
        return m.Reading(seq=line.seq, t=line.t, sensor=sensor, value=value)
    return line.message


def _noted(recount: Recount, message: m.AnyMessage) -> None:
    match message:
        case m.Reading(sensor=sensor):
            recount.sensors.add(sensor)
        case m.EngagementChanged():
            recount.recorded.append(
                Change(
                    t=message.t,
                    was=message.was,
                    now=message.now,
                    outcome=message.outcome,
                    why=message.why,
                    verdicts=message.verdicts,
                    visitor=message.visitor,
                    forced=message.forced,
                )
            )
        case m.ExperimentReloaded(changes=changes):
            if any("engagement" in change for change in changes):
                recount.reloads.append(message.t)
        case m.SessionStart():
            recount.start = message


def line_of(change: Change) -> dict[str, m.Json]:
    """A transition in the fields of the lines of samples, and what a session knows besides."""
    line: dict[str, m.Json] = {
        "t": change.t / SECOND,
        "presence": change.verdicts.get("presence"),
        "gaze": change.verdicts.get("gaze"),
        "id": change.verdicts.get("identity"),
        "distance": change.verdicts.get("distance"),
        "state": change.now,
        "outcome": change.outcome,
        "why": change.why,
    }
    if change.visitor:
        line["visitor"] = change.visitor
    if change.forced:
        line["forced"] = True
    return line


def _print_change(change: Change) -> None:
    print(json.dumps(line_of(change), ensure_ascii=False))


def _keep_quiet(change: Change) -> None:
    """The comparison comes when all is known."""


# -- settings ----------------------------------------------------------------------------------


def _settings_of_session(
    arguments: argparse.Namespace, log: Path, otherwise: EngagementSettings
) -> EngagementSettings:
    """Those of the experiment that the session was run with, if its very file is still there."""
    start = _start_of(log)
    if start is None:
        _warn("the log does not say which experiment it is of: these are the defaults")
        return otherwise
    found, why = _experiment_of(log, start)
    if found is None:
        _warn(f"{why}: these are the defaults (--experiment names a file)")
        return otherwise
    from woz_tui.cli.engagement import settings_of  # noqa: PLC0415

    return settings_of(argparse.Namespace(**{**vars(arguments), "experiment": found}))


def _start_of(log: Path) -> m.SessionStart | None:
    for line in read(log, Damage()):
        message = line.message
        return message if isinstance(message, m.SessionStart) else None
    return None


def _experiment_of(log: Path, start: m.SessionStart) -> tuple[Path | None, str]:
    """The experiment's file, or why it is not taken."""
    name = Path(start.experiment).name
    why = f"{name} is not beside the log"
    near = (log.resolve().parent, log.resolve().parent.parent, Path.cwd())
    folders = dict.fromkeys(folder / sub for sub in ("", _EXPERIMENTS) for folder in near)
    for folder in folders:
        file = folder / name
        if not name or not file.is_file():
            continue
        why = _unlike(file, start)
        if not why:
            return file, ""
    return None, why


def _unlike(file: Path, start: m.SessionStart) -> str:
    """Why `file` is not the experiment of the session; empty: it is."""
    from woz_tui import plugins  # noqa: PLC0415
    from woz_tui.experiment.decode import load  # noqa: PLC0415
    from woz_tui.experiment.shape import ExperimentError  # noqa: PLC0415

    try:
        experiment = load(file, plugins.installed())
    except (ExperimentError, OSError, plugins.PluginError) as error:
        return f"{file} cannot be read now: {str(error).splitlines()[0]}"
    if experiment.sha256 != start.experiment_sha256:
        return f"{file} has changed since the session"
    return f"{file} has no section engagement" if experiment.engagement is None else ""


def _hints(recount: Recount, settings: EngagementSettings, damage: Damage) -> None:
    for sentence in damage.sentences():
        _warn(f"the log is damaged: {sentence}")
    sensors = {sign: settings.sign(sign).sensor or sign for sign in settings.signs}
    missing = [name for name in sensors.values() if name not in recount.sensors]
    if missing:
        _warn(f"nothing was sensed of {', '.join(missing)}")
    if recount.reloads:
        _warn(
            f"the section engagement was edited {recount.reloads[0] / SECOND:.0f} s after the"
            " start; everything is computed with one set of settings"
        )


def _warn(text: str) -> None:
    print(f"woz engagement: {text}", file=sys.stderr)
