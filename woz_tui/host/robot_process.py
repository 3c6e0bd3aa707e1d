"""`woz host`: the robot process from start to end."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import gc
import json
import logging
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from woz_tui.config.experiment import Experiment
from woz_tui.config.feature_section import FeatureSection
from woz_tui.config.file_position import ExperimentError, FilePosition, Problem
from woz_tui.config.loading import load
from woz_tui.config.robot_fit import fitted
from woz_tui.drivers.plugins import GROUP, Catalogue, installed
from woz_tui.feature import features, left_out, pieces
from woz_tui.gate.table import FeatureGate
from woz_tui.host.loop_watchdog import LoopWatchdog
from woz_tui.host.request_handlers import RequestHandlers
from woz_tui.host.session_kind import SessionKind
from woz_tui.host.session_server import SessionServer
from woz_tui.log.file_names import file_stem, name_after
from woz_tui.log.recorder import Recorder
from woz_tui.log.withdrawals import WithdrawalRecordError, withdrawn_codes
from woz_tui.machine.scheduling import ask_for_short_turns
from woz_tui.protocol import messages as m
from woz_tui.protocol.refusal import RequestError
from woz_tui.protocol.sentence import Sentence
from woz_tui.session.participant_identity import (
    SessionIdentity,
    check_code,
    check_not_withdrawn,
    check_participant,
)
from woz_tui.session.session import Session
from woz_tui.session.session_features import SessionFeature
from woz_tui.system.clock import RealClock
from woz_tui.system.provenance import software
from woz_tui.system.service_manager import notify
from woz_tui.system.session_sockets import bind, next_session, running, socket_path, starting

if TYPE_CHECKING:  # most sessions are neither, and begin without loading them
    from woz_tui.host.companions import Companions
    from woz_tui.host.remote_access import RemoteAccess
    from woz_tui.host.rerun_session import RerunOptions
    from woz_tui.replay.rerun_plan import RerunPlan

#: A thread of a driver or of the recorder keeps the interpreter so long at most while a key waits.
SWITCH_S = 0.0005
#: How long the end of a session may take at most, and what is left of the process after it.
CLOSE_LIMIT_S = 30.0
EXIT_LIMIT_S = 3.0

#: Seconds from a line to the sync that sees it onto the disk: the robot's move comes first.
SYNC_AFTER_S = 0.002

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class HostOptions:
    """What `woz host` was told.

    `name` is the socket's (empty: the session's code); a session without a code gets the next free
    one. `recordings` the folder of logs; `spill` a second folder for when the
    first one fails. `announce` writes one JSON line with socket and log to standard output.
    `restarted`: the codes are those of a session that crashed, and the file may have changed;
    `left_out` are then the sorts of those that it no longer allows.
    `starts`: with what the session begins, by the feature that starts with it. `kind`: the feature
    whose kind of session it is; empty: one with a participant. `rerun`: which log's commands are
    run again. `robot`: the one that plays instead of the file's own; `fitted`: the file without
    what it cannot do. `listen`: where other machines can join; empty: nowhere.
    """

    experiment: Path
    identity: SessionIdentity
    name: str
    recordings: Path
    spill: Path | None = None
    announce: bool = False
    restarted: bool = False
    left_out: tuple[str, ...] = ()
    starts: Mapping[str, object] = field(default_factory=dict)
    kind: str = ""
    rerun: RerunOptions | None = None
    robot: str = ""
    fitted: bool = False
    listen: str = ""


def run(options: HostOptions) -> int:
    """Serve one session until it ends; the exit code.

    Raises `ExperimentError`, `SessionSocketError`, `PluginError`, `RequestError` or `OSError`
    before anything has begun; afterwards everything is handled here.
    """
    _fill_standard_streams()
    # Git says whether the program was edited, while the file is read.
    looked_up = threading.Thread(target=software, args=(GROUP,))
    looked_up.start()
    catalogue = installed()
    experiment = _read(options, catalogue)
    withdrawn: frozenset[str] = frozenset()
    doubt = ""  # why it is not known which codes nobody gets again
    try:
        withdrawn = withdrawn_codes([options.recordings])
    except WithdrawalRecordError as error:
        doubt = str(error)
    if options.restarted:
        options = _without_refused(options, experiment, withdrawn)
    _check_identity(options.identity, experiment, withdrawn)
    for name, value in options.starts.items():
        _check_start(name, value, experiment)
    plan: RerunPlan | None = None
    if options.rerun is not None:
        from woz_tui.host.rerun_session import read_plan  # noqa: PLC0415

        plan = read_plan(options.rerun, experiment)
    identity = _kind(options).identity(options.identity, experiment)
    options = replace(options, identity=identity)
    looked_up.join()
    return asyncio.run(
        _serve(options, catalogue, experiment, plan, withdrawn=withdrawn, doubt=doubt)
    )


def _kind(options: HostOptions) -> SessionKind:
    return pieces("session_kind", SessionKind)[options.kind] if options.kind else SessionKind()


def _read(options: HostOptions, catalogue: Catalogue) -> Experiment:
    """The experiment's file as it is now, for this kind of session."""
    experiment = load(options.experiment, catalogue, robot=options.robot)
    check_guards(experiment)
    if options.fitted:
        experiment = fitted(experiment)
    if options.rerun is not None:
        from woz_tui.host.rerun_session import without_model  # noqa: PLC0415

        return without_model(experiment)
    return _kind(options).experiment(experiment)


def check_guards(experiment: Experiment) -> None:
    """Raise `ExperimentError` where the file uses a feature with rows of the gate of which a piece
    cannot be loaded: what it is to forbid would happen.
    """
    parts, gates = pieces("session", type), pieces("gate", FeatureGate)
    place = FilePosition(experiment.path.name, 1, 1)
    problems = [
        Problem(
            place,
            name,
            Sentence(
                "host.feature_unusable",
                "the feature cannot be used: {why}",
                why=left_out().get(name) or Sentence("host.not_whole", "it is not whole"),
            ),
        )
        for name, section in pieces("section", FeatureSection).items()
        if features()[name].gate
        and features()[name].session
        and (name not in parts or name not in gates)
        and section.of(experiment) != section.empty
    ]
    if problems:
        raise ExperimentError(problems)


def _fill_standard_streams() -> None:
    """Where they were closed, the log or a socket would take their numbers, and get what a child
    process has to say.
    """
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(number, True)
    os.close(number)


def _check_identity(
    identity: SessionIdentity, experiment: Experiment, withdrawn: frozenset[str]
) -> None:
    if identity.session:
        check_code(identity.session, "session")
    if identity.wizard:
        check_code(identity.wizard, "wizard")
    if identity.participant:
        check_participant(identity.participant, experiment.participant_pattern)
        check_not_withdrawn(identity.participant, withdrawn)
    identity.changed(experiment, None, identity.condition or None, None)


def _check_start(name: str, value: object, experiment: Experiment) -> None:
    in_session: type[SessionFeature] = pieces("session", type)[name]
    in_session.check_start(value, experiment)


def _is_refused(check: Callable[..., object], *values: object) -> bool:
    try:
        check(*values)
    except RequestError:
        return True
    return False


def _without_refused(
    options: HostOptions, experiment: Experiment, withdrawn: frozenset[str]
) -> HostOptions:
    """`options` without the codes that the file does not allow any more: a crash in the middle of
    a study is no moment for looking up what was renamed.
    """
    who, starts = options.identity, dict(options.starts)
    left_out = []
    pattern = experiment.participant_pattern
    if who.participant and (
        _is_refused(check_participant, who.participant, pattern) or who.participant in withdrawn
    ):
        who = replace(who, participant="")
        left_out.append("participant")
    if _is_refused(who.changed, experiment, None, who.condition or None, None):
        who = replace(who, condition="")
        left_out.append("condition")
    for name, value in options.starts.items():
        if name != options.kind and _is_refused(_check_start, name, value, experiment):
            del starts[name]
            option = features()[name].start
            left_out.append(option.what if option is not None else name)
    return replace(options, identity=who, starts=starts, left_out=tuple(left_out))


def _tell_left_out(session: Session, left_out: tuple[str, ...]) -> None:
    """Without the code itself: the wizard may be blind to the conditions."""
    without = {each.start.what: each.start.without for each in features().values() if each.start}
    for what in left_out:
        remedy = Sentence("host.choose_again", "choose the {what} again", what=what)
        if without.get(what):
            remedy = Sentence(
                "host.until_then", "{what}; until then {then}", what=remedy, then=without[what]
            )
        session.hub.publish(
            m.Notice(
                level="warning",
                text=Sentence(
                    "host.not_allowed",
                    "no {what}: the file no longer allows the one from before the crash",
                    what=what,
                ),
                remedy=remedy,
            )
        )


async def _serve(
    options: HostOptions,
    catalogue: Catalogue,
    experiment: Experiment,
    plan: RerunPlan | None,
    *,
    withdrawn: frozenset[str],
    doubt: str,
) -> int:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)  # a closed terminal does not end the session
    clock = RealClock()
    sessions: list[Session] = []

    def recorder_moved(state: m.RecorderState) -> None:
        for session in sessions:  # none yet while the recorder makes its files
            session.recorder_moved(state)

    identity, path, listener, recorder = _begin_files(options, clock, recorder_moved)
    drivers = _kind(options).drivers(catalogue)
    session = Session(experiment, drivers, identity, recorder, clock, withdrawn)
    sessions.append(session)
    participants: set[str] = set()
    session.hub.listen(functools.partial(_note_participant, participants), m.SessionChanged)
    for name, value in options.starts.items():
        session.features.start(name, value)
    read = functools.partial(load, options.experiment, catalogue, robot=options.robot)
    handlers = RequestHandlers(session, lambda: _read(options, catalogue), read)
    host = SessionServer(session, path, handlers)
    rerun: RerunSession | None = None
    if plan is not None and options.rerun is not None:
        from woz_tui.host.rerun_session import RerunSession  # noqa: PLC0415

        rerun = RerunSession(host, plan, options.rerun)
    for number in (signal.SIGTERM, signal.SIGINT):
        asyncio.get_running_loop().add_signal_handler(number, host.end, "terminated")
    LoopWatchdog(session.drivers, session.hub)
    reason = "crashed"
    remote: RemoteAccess | None = None
    companions: list[Companions] = []
    try:
        await session.open()
        _tell_left_out(session, options.left_out)
        if doubt:
            text = Sentence(
                "host.withdrawals_unknown",
                "nobody knows which codes were withdrawn: {doubt}",
                doubt=doubt,
            )
            session.hub.publish(m.Notice(level="warning", text=text))
        if not options.kind:
            await session.features.prepare()
        host.listen(listener)
        if options.listen:
            remote = _let_in(options.listen, host)
        companions = _companions(host)
        if options.announce:
            _announce(path, recorder)
        else:
            _say(f"session {identity.session} is ready; join it with `woz attach {path.stem}`")
        notify("READY=1", f"STATUS=session {identity.session}: woz attach {path.stem}")
        _give_keys_priority()
        if rerun is not None:
            rerun.begin_when_ready()
        reason = await host.serve()
    finally:
        notify("STOPPING=1")
        _leave_within(CLOSE_LIMIT_S)
        try:
            if rerun is not None:
                rerun.end("the session ends")
        finally:  # whatever that came to: the robot rests and the log is finished
            await session.close(reason)
            _name_log(recorder.path, participants)
            if remote is not None:
                await remote.close()
            await host.close()
            _leave_within(EXIT_LIMIT_S)
            for each in companions:
                await each.close()
            if not options.announce:
                _say(f"session {identity.session} has ended; its log is in {recorder.path.parent}")
    return 0


def _begin_files(
    options: HostOptions, clock: RealClock, moved: Callable[[m.RecorderState], None]
) -> tuple[SessionIdentity, Path, socket.socket, Recorder]:
    """Session code, socket and log, while no other session of this user chooses its own."""
    identity = options.identity
    with starting():
        if not identity.session:
            identity = replace(identity, session=next_session(options.recordings, running()))
        path = socket_path(options.name or identity.session)
        listener = bind(path)
        recorder = Recorder(
            options.recordings,
            file_stem(clock.wall(), identity.participant, identity.session),
            clock,
            spill=options.spill,
            on_state=moved,
            defer=functools.partial(asyncio.get_running_loop().call_later, SYNC_AFTER_S),
        )
    return identity, path, listener, recorder


def _give_keys_priority() -> None:
    """Tune the scheduler and the interpreter so that nothing delays a key's way to the robot."""
    ask_for_short_turns()
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(SWITCH_S)


def _let_in(address: str, host: SessionServer) -> RemoteAccess:
    """Let other machines join at `address`, as whom the experiment says."""
    from woz_tui.host.remote_access import RemoteAccess  # noqa: PLC0415 - few sessions are open

    hub, session = host.session.hub, host.session
    remote = RemoteAccess(host.path, address, hub.publish)
    remote.start(session.experiment.session.access)

    def adopt(message: m.ExperimentReloaded) -> None:
        remote.adopt(session.experiment.session.access)

    hub.listen(adopt, m.ExperimentReloaded)
    return remote


def _companions(host: SessionServer) -> list[Companions]:
    """Start the programs that features want beside the session, also after a reload. None or one;
    most sessions have none.
    """
    hub, features_of = host.session.hub, host.session.features
    running: list[Companions] = []

    def adopt(message: m.ExperimentReloaded | None = None) -> None:
        commands = features_of.companions()
        if commands and not running:
            from woz_tui.host.companions import Companions  # noqa: PLC0415 - few sessions have one

            running.append(Companions(host.path, hub.publish))
        for each in running:
            each.adopt(commands)

    hub.listen(adopt, m.ExperimentReloaded)
    adopt()
    return running


def _note_participant(participants: set[str], message: m.SessionChanged) -> None:
    if message.participant:
        participants.add(message.participant)


def _name_log(path: Path, participants: set[str]) -> None:
    """The one participant that was chosen stands in the names of the files; of several, none."""
    if len(participants) == 1:
        try:
            name_after(path, *participants)
        except OSError as error:
            log.warning("the log keeps its name: %s", error)


def _leave_within(seconds: float) -> None:
    """No driver keeps the process, neither by blocking the loop nor by a job that goes on."""

    def leave() -> None:
        log.error("a driver does not stop; the robot process ends without it")
        os._exit(1)

    timer = threading.Timer(seconds, leave)
    timer.daemon = True
    timer.start()


def _say(text: str) -> None:
    """For who started it by hand, or a service's journal; a closed terminal does not matter."""
    with contextlib.suppress(OSError):
        print(f"woz: {text}", file=sys.stderr, flush=True)  # noqa: T201 - a command's own word


def _announce(path: Path, recorder: Recorder) -> None:
    """Tell the parent, then let go of its pipes: the robot process outlives the terminal.

    From here on standard error goes to a file beside the log. A parent that has died in the
    meantime is no other case than one that dies later.
    """
    own_log = recorder.path.with_suffix(".host.log")
    said = {"socket": str(path), "log": str(recorder.path), "host_log": str(own_log)}
    file = -1
    with contextlib.suppress(OSError):
        file = os.open(own_log, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o600)
    with contextlib.suppress(BrokenPipeError):
        print(json.dumps(said), flush=True)  # noqa: T201 - the one line of this protocol
    null = os.open(os.devnull, os.O_RDWR)
    os.dup2(null, 0)
    for number in (1, 2):
        os.dup2(file if file >= 0 else null, number)
    os.close(null)
    if file >= 0:
        os.close(file)
