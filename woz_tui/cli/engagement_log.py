"""`woz engagement LOG.jsonl`: a session's log through the engagement model once more.

Which settings it begins with, what stands above those that the log tells, and what is printed.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from woz_tui.analysis.engagement_rerun import (
    SETTINGS_KIND,
    LogRerun,
    SettingsOverride,
    line_of,
    rerun,
)
from woz_tui.cli.safe_streams import json_text
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import PAPER
from woz_tui.log.log_reader import Damage, read
from woz_tui.protocol import messages as m
from woz_tui.replay.experiment_origin import candidate_files
from woz_tui.sensing.engagement_model import Transition
from woz_tui.sensing.model_time import SECOND

#: What a model writes.
_MODEL = frozenset({SETTINGS_KIND, "engagement.changed", "engagement.shown"})


def run(
    path: Path, begin: EngagementSettings | None, above: SettingsOverride, *, lines: bool
) -> LogRerun:
    """Go through the log, printing the transitions as `lines`; its settings are `planned`."""
    damage = Damage()
    recount = rerun(path, begin, damage, _print_change if lines else None, above)
    _hints(recount, damage)
    return recount


def _print_change(change: Transition) -> None:
    print(json_text(line_of(change)))


# -- settings ----------------------------------------------------------------------------------


def planned(
    arguments: Namespace,
    log: Path,
    settings: EngagementSettings,
    with_options: Callable[[EngagementSettings], EngagementSettings],
) -> tuple[EngagementSettings | None, SettingsOverride]:
    """Settings of the beginning, and what stands above those that the log tells itself."""
    named = _named(arguments)
    if arguments.experiment is not None:
        return settings, SettingsOverride.always(settings, named)
    above = SettingsOverride(with_options, named)
    # What a model writes begins with its settings; earlier versions did not write them.
    first = next((line.kind for line in read(log, Damage()) if line.kind in _MODEL), "")
    if first == SETTINGS_KIND:
        return None, above
    # A log without settings is of a version that had the paper's turns alone.
    begin = replace(_searched(log, settings), turns=PAPER)
    return with_options(begin), above


def _named(arguments: Namespace) -> dict[str, frozenset[str]]:
    """Arguments of the wizard's verbs for which an option stands."""
    options = {"filter": "kind", "samples": "samples", "threshold": "threshold"}
    of_filter = {
        argument for option, argument in options.items() if getattr(arguments, option) is not None
    }
    named = {"filter": frozenset(of_filter)} if of_filter else {}
    if arguments.social_distance is not None:
        named["social_distance"] = frozenset({"metres"})
    return named


def _searched(log: Path, otherwise: EngagementSettings) -> EngagementSettings:
    """Those of the experiment that the session was run with, if its very file is still there."""
    from woz_tui.config.file_position import ExperimentError  # noqa: PLC0415
    from woz_tui.config.loading import load  # noqa: PLC0415
    from woz_tui.drivers import plugins  # noqa: PLC0415

    start = next((line.message for line in read(log, Damage())), None)
    if not isinstance(start, m.SessionStart):
        _warn("the log does not name its experiment; the defaults are used")
        return otherwise
    name = Path(start.experiment).name
    why = f"{name} is not beside the log"
    for file in candidate_files(log, name):
        try:
            experiment = load(file, plugins.installed())
        except (ExperimentError, OSError, plugins.PluginError) as error:
            why = f"{file} cannot be read now: {str(error).splitlines()[0]}"
            continue
        if experiment.sha256 != start.experiment_sha256:
            why = f"{file} has changed since the session"
        elif experiment.engagement is None:
            why = f"{file} has no section engagement"
        else:
            return experiment.engagement.settings
    _warn(f"{why}; the defaults are used (name a file with --experiment)")
    return otherwise


def _hints(recount: LogRerun, damage: Damage) -> None:
    for sentence in damage.sentences():
        _warn(f"the log is damaged: {sentence}")
    again = recount.again
    if again is None:
        return
    for why in again.unreadable:
        _warn(f"settings in the log cannot be read, the earlier ones are used: {why}")
    sensors = {sign: again.settings.sign(sign).sensor or sign for sign in again.settings.signs}
    missing = [name for name in sensors.values() if name not in recount.sensors]
    if missing:
        _warn(f"the log has no samples of {', '.join(missing)}")
    if again.passed_over:
        first, count = f"{again.passed_over[0] / SECOND:.1f} s", len(again.passed_over)
        what = f"{count} changes by hand were ignored (the first at {first})"
        if count == 1:
            what = f"1 change by hand was ignored (at {first})"
        _warn(f"{what}: the command line names what was changed")
    edited = again.settings_at[1:] if again.settings_at else recount.reloads
    if edited and (again.above.one or not again.settings_at):
        _warn(
            f"the section engagement was edited {edited[0] / SECOND:.0f} s after the"
            " start; everything is computed with one set of settings"
        )


def _warn(text: str) -> None:
    print(f"woz engagement: {text}", file=sys.stderr)
