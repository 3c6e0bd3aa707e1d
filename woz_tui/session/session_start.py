"""Publishes the first lines of a session's log: who, what, and the experiment's files."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from woz_tui.bus.hub import Hub
from woz_tui.config.bundled_files import is_path
from woz_tui.config.experiment import Experiment
from woz_tui.drivers import plugins
from woz_tui.log.file_names import from_folder, home_folder
from woz_tui.protocol import messages as m
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.participant_identity import SessionIdentity
from woz_tui.system.clock import Clock, boot_id, timestamp
from woz_tui.system.provenance import software

#: Fields of a file that say which key plays an action: in our own format, and in WoZ4U's.
_KEY_FIELDS = ("key", "key_comb")
#: So many keys that are other ones than the file says are told one by one.
_MOST_KEYS = 8
#: Bytes of all files together in one line of the log; a line may have 1 MiB.
FILES_BYTES = 512 * 1024


def publish_start(
    hub: Hub, identity: SessionIdentity, experiment: Experiment, clock: Clock, spill: list[str]
) -> None:
    """Publish what a log begins with; `spill`: where it goes on if its folder fails."""
    hub.publish(session_start(identity, experiment, clock, spill, -hub.t(0)))
    hub.publish(experiment_files(experiment))
    _publish_key_notices(hub, experiment)
    _publish_left_out(hub, experiment)


def publish_reload(
    hub: Hub, experiment: Experiment, changes: Sequence[str], telling: Sequence[str]
) -> None:
    """Publish that the session goes on with a changed file, and the file."""
    hub.publish(
        m.ExperimentReloaded(
            experiment_sha256=experiment.sha256,
            file_sha256=experiment.file_sha256,
            changes=[*changes],
            telling=[*telling],
        )
    )
    hub.publish(experiment_files(experiment))
    _publish_key_notices(hub, experiment)
    _publish_left_out(hub, experiment)


def publish_perception(hub: Hub, experiment: Experiment) -> None:
    """Say what is kept from the wizard from here on."""
    perception = experiment.study.perception
    hub.publish(m.PerceptionChanged(hidden=[*perception.hide], blurred=[*perception.blur]))


def _publish_left_out(hub: Hub, experiment: Experiment) -> None:
    """Tell what this robot does not do of a file that is written for another one."""
    short = [action for action in experiment.actions if action.left_out]
    if not short:
        return
    counts = Counter(each.what for action in short for each in action.left_out)
    what = ", ".join(f"{name} ({count})" for name, count in counts.most_common())
    empty = sum(not action.calls for action in short)
    if empty:
        text = Sentence(
            "session.partly_nothing",
            "This robot cannot do all of {count} actions ({empty} do nothing): {what}",
            one="This robot cannot do all of 1 action ({empty} do nothing): {what}",
            count=len(short),
            empty=empty,
            what=what,
        )
    else:
        text = Sentence(
            "session.partly",
            "This robot cannot do all of {count} actions: {what}",
            one="This robot cannot do all of 1 action: {what}",
            count=len(short),
            what=what,
        )
    remedy = f"woz check {experiment.path.name} --robot {robot_name(experiment)}"
    hub.publish(m.Notice(level="warning", text=text, remedy=remedy))


def robot_name(experiment: Experiment) -> str:
    """The robot that plays the file instead of its own, as it can be named again: its name, or its
    file as seen from the experiment's folder.
    """
    robot = experiment.robot
    return from_folder(Path(robot), experiment.path.parent) if is_path(robot) else robot


def _publish_key_notices(hub: Hub, experiment: Experiment) -> None:
    """Tell of keys that do not play what the file says: nobody may have checked it before."""
    odd = [one for one in experiment.warnings if one.path.rpartition(".")[2] in _KEY_FIELDS]
    for problem in odd[:_MOST_KEYS]:
        text = problem.in_line(problem.where or problem.path)
        hub.publish(m.Notice(level="warning", text=text, tells=("condition",)))
    if len(odd) > _MOST_KEYS:
        text = Sentence(
            "session.more_keys",
            "{count} more keys differ from the file",
            one="1 more key differs from the file",
            count=len(odd) - _MOST_KEYS,
        )
        remedy = f"woz check {experiment.path.name}"
        hub.publish(m.Notice(level="warning", text=text, remedy=remedy))


def session_start(
    identity: SessionIdentity,
    experiment: Experiment,
    clock: Clock,
    spill: list[str],
    zero_us: int,
) -> m.SessionStart:
    """Who, what, with which software, and how the clock and the calendar meet. `zero_us`: what the
    clock said at `t` = 0.
    """
    return m.SessionStart(
        session=identity.session,
        participant=identity.participant,
        condition=identity.condition,
        wizard=identity.wizard,
        software=software(plugins.GROUP),
        experiment=experiment.path.name,
        experiment_sha256=experiment.sha256,
        seed=identity.seed,
        clock={
            "source": "monotonic",
            "unit": "us",
            "wall_at_t0": timestamp(clock.wall()),
            "boot_id": boot_id(),
            "monotonic_us": zero_us,
        },
        spill=spill,
        robot=robot_name(experiment),
        file_sha256=experiment.file_sha256,
    )


def experiment_files(experiment: Experiment) -> m.ExperimentFiles:
    """The experiment's files as they were read, so that the log can be read without them.

    The home folder is written as `~`, in names and in texts: logs are published.
    """
    files: dict[str, str] = {}
    left_out: list[str] = []
    room = FILES_BYTES
    for path, text in zip(experiment.files, experiment.texts, strict=False):
        name, shown = from_folder(path, experiment.path.parent), text_without_home(text)
        need = len(json.dumps(shown))
        if need <= room:
            files[name] = shown
            room -= need
        else:
            left_out.append(name)
    names = (from_folder(path, experiment.path.parent) for path in experiment.files)
    return m.ExperimentFiles(
        experiment_sha256=experiment.sha256,
        files=files,
        left_out=left_out,
        files_sha256=dict(zip(names, experiment.files_sha256, strict=False)),
    )


def text_without_home(text: str) -> str:
    """`text` with `~` for the home folder wherever a path begins with it, or is it."""
    home = home_folder()
    if home is None:
        return text
    return re.sub(rf"(?<![\w./~-]){re.escape(str(home))}(?![\w-]|\.\w)", "~", text)
