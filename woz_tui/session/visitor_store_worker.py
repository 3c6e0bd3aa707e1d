"""Works on the store of visitors, one job after the other, in a thread of its own."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import threading
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeVar

from woz_tui.sensing.visitor_store import Visitor, VisitorFileError, VisitorsError, VisitorStore

T = TypeVar("T")

log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class StoreJob:
    """`make` changes something in the store, and may raise `VisitorsError`; whom it is about."""

    make: Callable[[VisitorStore], object]
    name: str = ""


@dataclass(frozen=True, slots=True)
class StoreJobResult:
    """What became of a job: `error` is what it raised. `people`: whom the store knows after it,
    None if it cannot be read. `unsaved`: how many changes the file lacks. `given_up`: sentences
    about such that do not fit any more. `unmade`: the change holds nowhere, not even in memory.
    """

    job: StoreJob
    people: list[Visitor] | None
    unsaved: int
    given_up: tuple[str, ...]
    error: Exception | None

    @property
    def unmade(self) -> bool:
        """A change that waits for a file that can be read."""
        return isinstance(self.error, VisitorFileError)


class VisitorStoreWorker:
    """See the module's text. `report` is called in the thread after each job.

    The thread lives for as long as there are jobs, so that the process neither ends before they
    are done nor stays for a thread that has nothing to do.
    """

    def __init__(self, store: VisitorStore, report: Callable[[], object]) -> None:
        self._store = store
        self._report = report
        self._jobs: deque[StoreJob] = deque()
        self._outcomes: deque[StoreJobResult] = deque()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None

    def do(self, *jobs: StoreJob) -> None:
        """Have these done after those that wait."""
        with self._lock:
            self._jobs.extend(jobs)
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="visitors")
                self._thread.start()

    def outcomes(self) -> Iterator[StoreJobResult]:
        """Take out what has become of jobs, in order."""
        while self._outcomes:
            yield self._outcomes.popleft()

    def wait(self, seconds: float) -> None:
        """Wait until all jobs have been tried, at most so long."""
        thread = self._thread
        if thread is not None:
            thread.join(seconds)

    async def waited(self, seconds: float) -> bool:
        """The same without holding up the event loop; whether all have been tried.

        A thread waits, and not the loop's executor: that may be full of what hangs as well.
        """
        thread = self._thread
        if thread is None:
            return True
        loop = asyncio.get_running_loop()
        over = asyncio.Event()

        def watch() -> None:
            thread.join(seconds)
            with contextlib.suppress(RuntimeError):  # the loop has closed: nobody waits any more
                loop.call_soon_threadsafe(over.set)

        threading.Thread(target=watch, name="visitors are waited for", daemon=True).start()
        await over.wait()
        return not thread.is_alive()

    # -- the thread --------------------------------------------------------------------------------

    def _next(self) -> StoreJob | None:
        with self._lock:
            if self._jobs:
                return self._jobs.popleft()
            self._thread = None
            return None

    def _work(self) -> None:
        while (job := self._next()) is not None:
            self._outcomes.append(self._done(job))
            try:
                self._report()
            except RuntimeError:  # the loop has closed: the session is over
                log.warning("nobody hears any more what became of the store of visitors")

    def _done(self, job: StoreJob) -> StoreJobResult:
        _, error = _tried(lambda: job.make(self._store))
        people, unreadable = _tried(self._store.everybody)
        given_up, self._store.given_up = tuple(self._store.given_up), []
        return StoreJobResult(job, people, self._store.unsaved, given_up, error or unreadable)


def _tried(call: Callable[[], T]) -> tuple[T | None, Exception | None]:
    """What comes of it, or what it raises: the thread lives on in any case."""
    try:
        return call(), None
    except (VisitorsError, OSError) as error:
        return None, error
    except Exception as error:
        log.exception("the store of visitors failed")
        return None, error
