"""The visitors that the robot knows; a thread reads and writes their file.

What is known is in memory; the file (`woz_tui.sensing.visitor_store`) is read at the beginning,
then looked at and changed by a thread of its own. Whom others forget or rename meanwhile is
forgotten or renamed here too. A file that cannot be read or written costs a notice and nothing
else: names stay in memory, and go into the file with the next change that it takes.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import TypeVar

from msgspec.structs import replace

from woz_tui.config.visitor_names import key_of
from woz_tui.protocol import messages as m
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.visitor_store import (
    Visitor,
    VisitorFileError,
    VisitorRefusedError,
    VisitorsError,
    VisitorStore,
)

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
    """Works on the store of visitors in a thread. `report` is called there after each job.

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
        """Take out the results of jobs, in order."""
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

    def _next_job(self) -> StoreJob | None:
        with self._lock:
            if self._jobs:
                return self._jobs.popleft()
            self._thread = None
            return None

    def _work(self) -> None:
        while (job := self._next_job()) is not None:
            _, error = _tried(job.make, self._store)
            people, unreadable = _tried(self._store.everybody)
            given_up, self._store.given_up = tuple(self._store.given_up), []
            self._outcomes.append(
                StoreJobResult(job, people, self._store.unsaved, given_up, error or unreadable)
            )
            try:
                self._report()
            except RuntimeError:  # the loop has closed: the session is over
                log.warning("nobody hears any more what became of the store of visitors")


def _tried(call: Callable[..., T], *args: VisitorStore) -> tuple[T | None, Exception | None]:
    """The result of `call`, or what it raised: the thread goes on in any case."""
    try:
        return call(*args), None
    except (VisitorsError, OSError) as error:
        return None, error
    except Exception as error:
        log.exception("the store of visitors failed")
        return None, error


_FACTS = ("age_group", "address")
#: A disk that takes longer at the end of a session is worth a notice, in seconds.
_AT_ONCE_S = 0.5
_LOOK = Sentence("session.look", "look at it with `woz visitors`")


class KnownVisitors:
    """The known visitors, by name.

    Args:
        path: The store's file.
        publish: Publishes a message; called in the session's thread.
        later: Has something called in the session's thread; may be called from any thread.
    """

    def __init__(
        self,
        path: Path,
        publish: Callable[[m.Message], object],
        later: Callable[[Callable[[], object]], object],
    ) -> None:
        self.path = path
        self._publish = publish
        self._store = VisitorStore(path)
        self._worker = VisitorStoreWorker(self._store, lambda: later(self._catch_up))
        self._by_name: dict[str, Visitor] = {}
        #: Jobs of which it is not known yet what becomes; those of them that must be tried again.
        self._open: list[StoreJob] = []
        self._unmade: list[StoreJob] = []
        self._unsaved = 0
        #: Who was named in the log, by key.
        self._named: dict[str, str] = {}
        self._last_problem = ""
        self._here = ""

    def read(self) -> None:
        """Learn from the file who is known; what is wrong with it becomes a notice."""
        try:
            self._know(self._store.everybody())
        except (VisitorsError, OSError, ValueError) as error:
            self._report_problem(error)

    def refresh(self) -> None:
        """Learn soon what others have changed, and try again to save what is not in the file."""
        if len(self._open) == len(self._unmade):
            self._do(StoreJob(VisitorStore.save))

    async def finish(self, seconds: float) -> None:
        """The session ends: try once more to save everything, for at most so long, and tell what
        could not be saved. The event loop goes on meanwhile; a disk that does not answer at once is
        told of.
        """
        self._catch_up()
        if self.lacks:
            self.refresh()
        first = min(_AT_ONCE_S, seconds)
        if not await self._worker.waited(first) and seconds > first:
            text = Sentence(
                "session.visitors_file_slow",
                "visitors: {path} does not respond; the session ends within {seconds:g} s",
                path=self.path,
                seconds=seconds,
            )
            self._publish(m.Notice(level="warning", text=text))
            await self._worker.waited(seconds - first)
        self._catch_up()
        if self.lacks:
            text = Sentence(
                "session.visitors_unsaved",
                "visitors: {count} changes of this session could not be saved in {path}",
                one="visitors: 1 change of this session could not be saved in {path}",
                count=self.lacks,
                path=self.path,
            )
            remedy = Sentence(
                "session.changes_in_log",
                "the log has them (`visitor.changed`); enter them with `woz visitors`",
            )
            self._publish(m.Notice(level="error", text=text, remedy=remedy))

    def wait(self, seconds: float) -> None:
        """Wait until all changes have been tried, at most so long."""
        self._worker.wait(seconds)

    @property
    def lacks(self) -> int:
        """How many changes are not in the file as far as it is known here."""
        return self._unsaved + sum(1 for job in self._open if job.name)

    # -- asked -------------------------------------------------------------------------------------

    def called(self, label: str) -> Visitor | None:
        """Who has this name, or whose face a recogniser calls so."""
        key = key_of(label)
        named = (each for each in self._by_name.values() if key in map(key_of, each.labels))
        return self._by_name.get(key) or next(named, None)

    def is_taken(self, name: str) -> bool:
        return self.called(name) is not None

    # -- changed -----------------------------------------------------------------------------------

    def meet(self, name: str, today: date) -> None:
        """They are here, recognised by a sensor; a meeting is counted once until they leave."""
        visitor = self.called(name)
        if visitor is None or visitor.name == self._here:
            return
        self._here = visitor.name
        self._log(visitor, "met")
        self._do(StoreJob(lambda store: store.met(visitor.name, on=today), visitor.name))

    def left(self) -> None:
        """Nobody is here any more."""
        self._here = ""

    def introduce(self, name: str, facts: dict[str, str], today: date) -> None:
        """Somebody is called `name`: a new visitor is learnt, a known one met and told more of.

        A fact that stands already is never replaced: a notice tells.
        """
        visitor = self.called(name)
        if visitor is None:
            self._learn(name, facts, today)
        else:
            self.meet(visitor.name, today)
            self._add_facts(visitor, facts)

    def _learn(self, name: str, facts: dict[str, str], today: date) -> None:
        day = today.isoformat()
        group, address = (facts.get(fact, "") for fact in _FACTS)
        visitor = Visitor(name, group, address, (), day, day, 1)
        self._by_name[key_of(name)] = visitor
        self._here = name
        self._log(visitor, "learnt")
        self._do(
            StoreJob(
                lambda store: store.add(name, on=today, age_group=group, address=address), name
            )
        )

    def _add_facts(self, visitor: Visitor, facts: dict[str, str]) -> None:
        about = visitor.about
        other = [fact for fact, value in facts.items() if about.get(fact, value) != value]
        new = {fact: value for fact, value in facts.items() if value and fact not in about}
        if other:
            said = ", ".join(f"{fact.replace('_', ' ')} {about[fact]}" for fact in other)
            self._publish(
                m.Notice(
                    level="warning",
                    text=Sentence(
                        "session.visitor_in_file",
                        "{name} is in the file with {said}; the file keeps this",
                        name=visitor.name,
                        said=said,
                    ),
                    remedy=Sentence("session.woz_visitors", "change it with `woz visitors`"),
                    tells=("identity",),
                )
            )
        if new:
            more = replace(visitor, **new)
            self._by_name[key_of(visitor.name)] = more
            self._log(more, "profile")
            group, address = new.get("age_group"), new.get("address")
            self._do(
                StoreJob(
                    lambda store: store.profile(visitor.name, age_group=group, address=address),
                    visitor.name,
                )
            )

    def _log(self, visitor: Visitor, what: str) -> None:
        self._named[key_of(visitor.name)] = visitor.name
        self._publish(m.VisitorChanged(visitor=visitor.name, what=what, about=visitor.about))

    # -- the store ---------------------------------------------------------------------------------

    def _do(self, job: StoreJob) -> None:
        """Have a job done, after those that could not be done before."""
        again, self._unmade = self._unmade, []
        self._open.append(job)
        self._worker.do(*again, job)

    def _catch_up(self) -> None:
        """Take in the results of jobs."""
        for outcome in self._worker.outcomes():
            if outcome.unmade and outcome.job.name:
                self._unmade.append(outcome.job)
            else:
                self._open.remove(outcome.job)
            self._unsaved = outcome.unsaved
            if outcome.people is not None:
                self._know(outcome.people)
            self._report(outcome)

    def _know(self, people: Iterable[Visitor]) -> None:
        """Take over the visitors of the store; those whose job still waits stay."""
        before, self._by_name = self._by_name, {key_of(visitor.name): visitor for visitor in people}
        for key in {key_of(job.name) for job in self._open if job.name}:
            if key in before:
                self._by_name[key] = before[key]
        for key in self._named.keys() - self._by_name.keys():
            self._publish(m.VisitorChanged(visitor=self._named.pop(key), what="forgotten"))

    # -- told --------------------------------------------------------------------------------------

    def _report(self, outcome: StoreJobResult) -> None:
        if outcome.given_up:
            text = f"visitors: {'; '.join(outcome.given_up)}"
            self._publish(m.Notice(level="warning", text=text, remedy=_LOOK, tells=("identity",)))
        if outcome.error is not None:
            self._report_problem(outcome.error)
        elif not outcome.unsaved:
            self._last_problem = ""

    def _report_problem(self, error: Exception) -> None:
        """Publish a notice unless it is the last one again."""
        text = f"visitors: {getattr(error, 'reason', '') or error}"
        if text == self._last_problem:
            return
        self._last_problem = text
        level = "warning" if isinstance(error, VisitorRefusedError) else "error"
        remedy = getattr(error, "remedy", "")
        self._publish(m.Notice(level=level, text=text, remedy=remedy, tells=("identity",)))
