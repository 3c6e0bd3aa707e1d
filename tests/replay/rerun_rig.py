"""Sessions in virtual time: one is recorded, and its log is run again in another one."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterable
from pathlib import Path

import msgspec

from tests.session.rig import SessionRig
from woz_tui.analysis.played_actions import PlayedSession, played_session
from woz_tui.config.experiment import Call
from woz_tui.config.file_position import FilePosition
from woz_tui.gate.questions import RequestOrigin
from woz_tui.log.log_reader import read
from woz_tui.protocol import codec
from woz_tui.protocol import messages as m
from woz_tui.replay.rerun_plan import REPLAY, RerunPlan, fitted, plan_of
from woz_tui.replay.rerun_player import RerunPlayer

KEY = RequestOrigin("key", "h", "con1")
HAND = RequestOrigin("key", "h", "con9")
NOWHERE = FilePosition("", 0, 0)
Scenario = Callable[[SessionRig], Awaitable[None]]


def record_session(folder: Path, scenario: Scenario) -> Path:
    """A session in which `scenario` happens; its log."""
    return SessionRig(folder).run(scenario).recorder.path


class RerunRig(SessionRig):
    """A session in which a log is run again."""

    player: RerunPlayer

    @property
    def log(self) -> Path:
        return self.recorder.path

    def sent_commands(self) -> list[m.RerunSent]:
        return self.of(m.RerunSent)

    def calls(self) -> list[tuple[str, dict[str, m.Json]]]:
        """What reached the driver."""
        return [call for call in self.driver().calls if call[0] not in ("rest", "close")]


def player_of(rig: SessionRig, plan: RerunPlan) -> RerunPlayer:
    """A player as the robot process makes it."""

    def send(command: m.Command, on_end: Callable[[m.End], None]) -> m.Command:
        call = Call(command.verb, dict(command.args), command.driver, NOWHERE)
        return rig.session.runner.send(
            call, RequestOrigin(REPLAY), "queue", None, on_end, like=command
        )

    return RerunPlayer(plan, rig.session.hub, send, rig.session.runner.cancel)


async def rerun_over(rig: SessionRig, player: RerunPlayer) -> None:
    """Return when the re-run has ended."""
    ended = asyncio.Event()
    rig.session.hub.listen(
        lambda message: ended.set() if isinstance(message, m.RerunEnded) else None
    )
    if player.over is None:
        await ended.wait()


def run_again(folder: Path, log: Path, meanwhile: Scenario | None = None) -> RerunRig:
    """Run `log` again to its end, with `meanwhile` beside it."""

    async def rerun(rig: RerunRig) -> None:
        rig.player = player_of(rig, fitted(plan_of(log), rig.experiment))
        rig.player.begin()
        if meanwhile is not None:
            await meanwhile(rig)
        await rerun_over(rig, rig.player)

    # Eight seconds for whatever is still under way, and nothing more.
    return RerunRig(folder).run(rerun, 8)


def played_in(log: Path, name: str = "") -> PlayedSession:
    """What `woz compare` reads of a log."""
    lines = read(log, samples=False)
    found = played_session("made", [line.message for line in lines if line.message is not None])
    found.name = name or found.name
    return found


def write_log(path: Path, messages: Iterable[tuple[float, m.Message]]) -> Path:
    """A log made by hand: each message with its time in seconds."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        for seq, (seconds, message) in enumerate(messages):
            stamped = msgspec.structs.replace(
                message, seq=seq, t=round(seconds * 1_000_000), ts="2026-03-01T10:00:00.000000Z"
            )
            file.write(codec.encode(stamped))
    return path
