"""Drivers of this computer that run in a process of their own: what they do there holds up nobody.

They are served as those of another computer are (`driver_server`), over a socket instead of a
network. What is different: files are written and read where the session's are, hands reach them,
and a process that does not hear the stop is ended.
"""

from __future__ import annotations

import asyncio
import contextlib
import pickle
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import msgspec

from woz_tui.drivers.contract import (
    Driver,
    DriverContext,
    DriverError,
    HandInput,
    RejectedError,
    Scope,
    StopReport,
)
from woz_tui.network.child_line import ChildLine
from woz_tui.network.driver_server import OfferedDriver
from woz_tui.network.remote_driver import RemoteDriver
from woz_tui.network.shared_child import SharedChild

#: The module that it runs.
DRIVERS = "woz_tui.session.driver_child"
#: What it is called in sentences.
PLACE = "its process"
#: A process, or a session, that has not spoken for so long counts as lost, in seconds. Its end is
#: seen at once.
SILENCE_S = 2.0
#: A process that has said nothing for so long since the stop is ended, in seconds.
KILL_S = 2.0


class ProcessSetup(msgspec.Struct, frozen=True):
    """What the process is told: the drivers, pickled, and the robot file's folder."""

    offers: bytes
    folder: str
    silence_s: float


class DriverProcess(SharedChild):
    """A process for drivers that work together; it runs from the first that joins to the last.

    Args:
        offers: Those drivers.
        folder: The robot file's.
        silence_s: See `SILENCE_S`.

    Raises:
        ValueError: Their settings cannot be handed over.
    """

    def __init__(
        self, offers: Sequence[OfferedDriver], folder: Path, silence_s: float = SILENCE_S
    ) -> None:
        super().__init__()
        self.silence_s = silence_s
        self.name = f"the process of {' and '.join(offer.name for offer in offers)}"
        try:
            drivers = pickle.dumps([*offers])
        except Exception as error:  # whatever a stranger's settings raise
            raise ValueError(f"{type(error).__name__}: {error}") from error
        setup = ProcessSetup(drivers, str(folder.absolute()), silence_s)
        self._setup = msgspec.msgpack.encode(setup)

    def _admit(self, place: str) -> None:
        """All of them may."""

    async def _opened(self) -> ChildLine:
        line = ChildLine(DRIVERS, self._setup, self.name)
        await line.begin()
        return line

    def revoked(self, place: str) -> str:
        """Nobody is kept out."""
        return ""

    def gone(self, place: str) -> str:
        """What has become of it."""
        return f"{place} {'is gone' if self._line is None else self._line.why}"

    @property
    def heard(self) -> float:
        """When it spoke last, on the loop's clock; 0: it has not begun."""
        return 0.0 if self._line is None else self._line.heard

    def kill(self, why: str) -> None:
        """End it without a word; it is begun anew."""
        if self._line is not None:
            self._line.kill(why)


class ProcessDriver(RemoteDriver):
    """A driver of this session that runs in a process of its own.

    Args:
        name: In full, as for every driver.
        settings: Decoded here, and handed to the process.
        context: The session.
        local: The driver's class.
        kind: Its type in robot files.
        process: Where it runs.
    """

    summary = "A driver in a process of its own"
    awaited: ClassVar[tuple[str, str]] = ("its process begins", "")
    lost: ClassVar[tuple[str, str]] = (
        "nobody knows what its hardware does until it is back",
        "it is begun anew by itself; what it said last is in the *.host.log beside the log",
    )
    unreachable: ClassVar[str] = "see the *.host.log beside the session's log"
    unfinished: ClassVar[str] = "its process is ended"

    def __init__(
        self,
        name: str,
        settings: Any,
        context: DriverContext,
        *,
        local: type[Driver],
        kind: str,
        process: DriverProcess,
    ) -> None:
        super().__init__(
            *(name, settings, context), local=local, kind=kind, router=process, place=PLACE
        )
        self._process = process
        self._has_hands = local.take_hand is not Driver.take_hand
        #: Why its hand is not taken, by client.
        self._refused: dict[str, RejectedError] = {}
        self._media_told = ""

    async def stop(self, scope: Scope) -> StopReport | None:
        """One that does not hear it cannot be stopped: its process is ended, and the driver that is
        made anew begins stopped.
        """
        pressed = asyncio.get_running_loop().time()
        try:
            return await super().stop(scope)
        finally:
            if scope is Scope.ALL and self._is_silent(pressed):
                self._spawn(self._kill_if_silent(pressed))

    def _is_silent(self, since: float) -> bool:
        """Whether its process, which had begun its work, has said nothing since then."""
        return 0 < self._process.heard <= since

    async def _kill_if_silent(self, since: float) -> None:
        left_s = max(0.0, since + KILL_S - asyncio.get_running_loop().time())
        if not await self._closed_within(left_s) and self._is_silent(since):
            self._process.kill("did not hear the stop and was ended")

    def _on_presence(self, there: bool) -> None:
        """Of one that was silent before it is told, too, what has become of it."""
        silent = not self._bound
        super()._on_presence(there)
        if not there and silent and not self._closed.is_set():
            self._lose(self._process.gone(PLACE))

    def take_hand(self, hand: HandInput) -> None:
        """Handed on; a refusal is told with the next one of the same client."""
        if not self._has_hands:
            Driver.take_hand(self, hand)
        if not self._bound:
            raise RejectedError(f"{PLACE} cannot be reached", self.unreachable)
        self._spawn(self._hand_on(hand))
        if (refusal := self._refused.get(hand.client)) is not None:
            raise refusal

    async def _hand_on(self, hand: HandInput) -> None:
        try:
            await self._call("take_hand", [msgspec.to_builtins(hand)], None)
        except RejectedError as refusal:
            self._refused[hand.client] = refusal
        except DriverError:  # lost meanwhile: health says it
            pass
        else:
            self._refused.pop(hand.client, None)

    def lose_hand(self, client: str) -> None:
        self._refused.pop(client, None)
        if self._has_hands and self._bound:
            self._spawn(self._lose_hand(client))

    async def _lose_hand(self, client: str) -> None:
        with contextlib.suppress(DriverError):  # a process that is lost lets go by itself
            await self._call("lose_hand", [client], None)

    def _media(self) -> str:
        self._media_told = str(self.context.media.absolute())
        return self._media_told

    def _look(self) -> None:
        """The session's folder for files moves with its log."""
        if self._bound and self._media_told != str(self.context.media.absolute()):
            self._spawn(self._move_media())

    async def _move_media(self) -> None:
        with contextlib.suppress(DriverError):
            await self._call("move_media", [self._media()], None)
