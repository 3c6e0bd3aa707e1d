"""A program that stays loaded and answers lines of JSON: a transcriber, a voice.

It writes `{"ready": true}` once it has loaded. Each line that it then reads is a request with an
`id`; what it writes with the same `id` is the answer, or with `"final": false` a part of it, or
with `"error"` why there is none. Other lines are passed over: libraries print what they like.

One request is under way at a time. A program that dies is started again, with longer and longer
pauses; so is one that does not answer in time, or never ends a line. Its temporary files lie in a
folder of its own (`TMPDIR`), which is deleted when it has ended, however that happened.
"""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from woz_drivers.programs import child_process, command_lines
from woz_drivers.programs.child_process import Child, RestartPauses
from woz_tui.drivers.contract import DriverError
from woz_tui.protocol.messages import Json
from woz_tui.system.foreign_json import decode_foreign
from woz_tui.system.tasks import end_tasks

#: Until it must have loaded, in seconds; large models on a slow card take long.
LOADS_WITHIN_S = 180.0
#: A longer line is no answer, in bytes.
LONGEST_LINE = 1 << 20
#: Stands in a command for the interpreter that runs this program, with its packages.
_PYTHON = {"python": sys.executable}

T = TypeVar("T")


def resident_words(command: str | Sequence[str], setting: str) -> tuple[str, ...]:
    """A command as its words, `{python}` filled in; () for none. Raises `DriverError`."""
    if not command:
        return ()
    words = command_lines.split(command, setting)
    command_lines.placeholders(words, _PYTHON, setting)
    return command_lines.fill(words, _PYTHON)


@dataclass(frozen=True, slots=True)
class _Pending:
    """The request under way."""

    number: int
    answer: asyncio.Future[dict[str, Any]]
    on_part: Callable[[dict[str, Any]], None] | None


class ResidentProgram:
    """Keeps one program running from its first request, or `start`, until `close`.

    `on_state(state, why, remedy)` hears `loading`, `ready` and `lost`.
    """

    def __init__(
        self,
        words: Sequence[str],
        folder: Path,
        on_state: Callable[[str, str, str], None] = lambda state, why, remedy: None,
        *,
        humble: bool = False,
    ) -> None:
        self._words = tuple(words)
        self._folder = folder
        self._on_state = on_state
        self._humble = humble
        self._remedy = f"try it in a terminal: {' '.join(words)}"
        self._child: Child | None = None
        self._task: asyncio.Task[None] | None = None
        self._turn = asyncio.Lock()
        self._numbers = 0
        self._pending: _Pending | None = None
        #: Set while it can be asked.
        self._ready = asyncio.Event()
        #: Why the last run ended before it had loaded.
        self._trouble: DriverError | None = None
        #: Set while there is one; nobody waits for a program that does not come up.
        self._hopeless = asyncio.Event()
        #: Why the present run has to be given up, once it has.
        self._given_up: asyncio.Future[DriverError] | None = None
        self._line = bytearray()
        self._passed_over = ""
        #: How long the last answer took from when the program had the request, in seconds.
        self.answered_in = 0.0

    @property
    def program(self) -> str:
        """How it is named in sentences: the module or the script, if an interpreter runs it."""
        words = self._words
        if "-m" in words[1:-1]:
            return words[words.index("-m") + 1].rpartition(".")[2]
        script = next((word for word in words[1:] if word.endswith(".py")), words[0])
        return Path(script).name

    def start(self) -> None:
        """Begin to load it."""
        if self._task is None:
            self._task = asyncio.create_task(self._keep_running(), name=self.program)

    async def close(self) -> None:
        """End it and everything it started."""
        task, self._task = self._task, None
        await end_tasks(task)

    async def load(self, within: float) -> float | None:
        """Load it; seconds that took, or None if it is still loading after `within` seconds. Raises
        `DriverError` if it ended.
        """
        loop = asyncio.get_running_loop()
        began = loop.time()
        self.start()
        try:
            async with asyncio.timeout(within):
                await self._until_ready()
        except TimeoutError:
            return None
        return loop.time() - began

    async def ask(
        self,
        request: Mapping[str, Json],
        kind: type[T],
        seconds: float,
        on_part: Callable[[dict[str, Any]], None] | None = None,
    ) -> T:
        """Its answer, as a `kind`. One that is loading is waited for; `seconds` count from when it
        has the request. Raises `DriverError`: it does not come up, died, or gave no answer.
        """
        async with self._turn:
            self.start()
            child = await self._until_ready()
            self._numbers += 1
            future: asyncio.Future[dict[str, Any]] = asyncio.get_running_loop().create_future()
            self._pending = _Pending(self._numbers, future, on_part)
            self._passed_over = ""
            line = json.dumps({"id": self._numbers, **request})
            loop = asyncio.get_running_loop()
            asked = loop.time()
            child.write(line.encode() + b"\n")
            try:
                async with asyncio.timeout(seconds):
                    answer = await future
                self.answered_in = loop.time() - asked
            except TimeoutError:
                raise self._give_up(f"did not answer within {seconds:g} s") from None
            finally:
                self._pending = None
        if error := answer.get("error"):
            raise DriverError(f"{self.program}: {str(error)[:200]}", self._remedy)
        return self.convert(answer, kind)

    def convert(self, answer: Mapping[str, Any], kind: type[T]) -> T:
        """A line as a `kind`. Raises `DriverError`."""
        try:
            return msgspec.convert(answer, kind)
        except msgspec.ValidationError as error:
            what = f"{self.program} gave a wrong answer: {error}"
            raise DriverError(what, self._remedy) from error

    async def _until_ready(self) -> Child:
        while True:
            child = self._child
            if self._ready.is_set() and child is not None and child.running:
                return child
            self._ready.clear()
            if self._hopeless.is_set() and self._trouble is not None:
                raise self._trouble
            await _first(self._ready.wait(), self._hopeless.wait())

    def _give_up(self, why: str) -> DriverError:
        """Have it started again; what is to be said of it."""
        wrote = f"; it wrote {self._passed_over!r}" if self._passed_over else ""
        error = DriverError(f"{self.program} {why}{wrote}", self._remedy)
        self._ready.clear()
        if self._given_up is not None and not self._given_up.done():
            self._given_up.set_result(error)
        return error

    # -- keeping it running --------------------------------------------------------------------

    async def _keep_running(self) -> None:
        pauses = RestartPauses()
        loop = asyncio.get_running_loop()
        while True:
            loaded_at = None
            self._on_state("loading", f"{self.program} is loading", "")
            try:
                with child_process.temporary_folder() as temporary:
                    try:
                        child = await self._load(temporary)
                        loaded_at = loop.time()
                        trouble = await self._until_end(child)
                    finally:
                        await self._end()
            except DriverError as error:
                trouble = error
            if loaded_at is None:
                self._trouble = trouble
                self._hopeless.set()
            if self._pending is not None and not self._pending.answer.done():
                self._pending.answer.set_exception(trouble)
            self._on_state("lost", trouble.what, trouble.remedy)
            await asyncio.sleep(
                pauses.after_run(0 if loaded_at is None else loop.time() - loaded_at)
            )

    async def _load(self, temporary: str) -> Child:
        """It runs, with its temporary files in that folder, and is ready. Raises `DriverError`."""
        self._given_up = asyncio.get_running_loop().create_future()
        self._line.clear()
        self._passed_over = ""
        child = self._child = await child_process.start(
            self._words,
            self._folder,
            on_output=self._received,
            keeps_reading=True,
            humble=self._humble,
            environment={"TMPDIR": temporary},
        )
        await _first(
            self._ready.wait(), child.wait(), asyncio.shield(self._given_up), within=LOADS_WITHIN_S
        )
        if self._ready.is_set():
            return child
        if self._given_up.done():
            raise self._given_up.result()
        if not child.running:
            raise await self._ended(child)
        raise self._give_up(f"was not ready within {LOADS_WITHIN_S:g} s")

    async def _until_end(self, child: Child) -> DriverError:
        """Why it ended, or had to be given up."""
        assert self._given_up is not None
        await _first(child.wait(), asyncio.shield(self._given_up))
        return self._given_up.result() if self._given_up.done() else await self._ended(child)

    async def _ended(self, child: Child) -> DriverError:
        why = child.reason(await child.wait())
        return DriverError(f"{self.program} ended: {why}", self._remedy)

    async def _end(self) -> None:
        self._ready.clear()
        child, self._child = self._child, None
        if child is not None:
            await child.end()

    # -- what it writes ------------------------------------------------------------------------

    def _received(self, data: bytes) -> None:
        *lines, rest = data.split(b"\n")
        for line in lines:
            whole, self._line = bytes(self._line + line), bytearray()
            self._heard(whole)
        self._line += rest
        if len(self._line) > LONGEST_LINE:
            self._line.clear()
            self._give_up(f"wrote a line of more than {LONGEST_LINE >> 20} MiB")

    def _heard(self, line: bytes) -> None:
        try:
            told = decode_foreign(line)
        except ValueError:
            told = None
        if not isinstance(told, dict):
            self._passed_over = line.decode("utf-8", "replace").strip()[:80] or self._passed_over
        elif told.get("ready") is True and not self._ready.is_set():
            self._trouble = None
            self._hopeless.clear()
            self._ready.set()
            self._on_state("ready", str(told.get("name") or self.program)[:80], "")
        elif self._pending is not None and told.get("id") == self._pending.number:
            self._answered(self._pending, told)

    def _answered(self, pending: _Pending, told: dict[str, Any]) -> None:
        if pending.answer.done():
            return
        if told.get("final") is False:
            if pending.on_part is not None:
                pending.on_part(told)
        else:
            pending.answer.set_result(told)


async def _first(*awaited: Awaitable[Any], within: float | None = None) -> None:
    """Return when the first of them is done, or `within` seconds have passed."""
    waits = [asyncio.ensure_future(one) for one in awaited]
    try:
        await asyncio.wait(waits, timeout=within, return_when=asyncio.FIRST_COMPLETED)
    finally:
        for one in waits:
            one.cancel()
