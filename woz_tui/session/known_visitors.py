"""The visitors whom the robot knows, for a session that must never wait for a disk.

What is known is in memory; the file (`woz_tui.sensing.visitor_store`) is read at the beginning,
then looked at and changed by a thread of its own. Whom others forget or rename meanwhile is
forgotten or renamed here too. A file that cannot be read or written costs a notice and nothing
else: names stay in memory, and go into the file with the next change that it takes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from datetime import date
from pathlib import Path

from woz_tui.config.visitor_names import key_of
from woz_tui.protocol import messages as m
from woz_tui.sensing.visitor_store import Visitor, VisitorRefusedError, VisitorsError, VisitorStore
from woz_tui.session.visitor_store_worker import StoreJob, StoreJobResult, VisitorStoreWorker

_FACTS = ("age_group", "address")
#: A disk that takes longer at the end of a session is worth a notice, in seconds.
_AT_ONCE_S = 0.5
_LOOK = "look at it with `woz visitors`"


class KnownVisitors:
    """Who is known, by name.

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
        self._clerk = VisitorStoreWorker(self._store, lambda: later(self._catch_up))
        self._known: dict[str, Visitor] = {}
        #: Jobs of which it is not known yet what becomes; those of them that must be tried again.
        self._open: list[StoreJob] = []
        self._unmade: list[StoreJob] = []
        self._unsaved = 0
        #: Who was named in the log, by key.
        self._named: dict[str, str] = {}
        self._complaint = ""
        self._here = ""

    def read(self) -> None:
        """Learn from the file who is known; what is wrong with it becomes a notice."""
        try:
            self._know(self._store.everybody())
        except (VisitorsError, OSError, ValueError) as error:
            self._complain(error)

    def look(self) -> None:
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
            self.look()
        first = min(_AT_ONCE_S, seconds)
        if not await self._clerk.waited(first) and seconds > first:
            text = f"visitors: {self.path} does not respond; the session ends within {seconds:g} s"
            self._publish(m.Notice(level="warning", text=text))
            await self._clerk.waited(seconds - first)
        self._catch_up()
        if self.lacks:
            changes = f"{self.lacks} change{'s' if self.lacks > 1 else ''}"
            text = f"visitors: {changes} of this session could not be saved in {self.path}"
            remedy = "the log has them (`visitor.changed`); enter them with `woz visitors`"
            self._publish(m.Notice(level="error", text=text, remedy=remedy))

    def wait(self, seconds: float) -> None:
        """Wait until all changes have been tried, at most so long."""
        self._clerk.wait(seconds)

    @property
    def lacks(self) -> int:
        """How many changes are not in the file as far as it is known here."""
        return self._unsaved + sum(1 for job in self._open if job.name)

    # -- asked -------------------------------------------------------------------------------------

    def called(self, label: str) -> Visitor | None:
        """Who has this name, or whose face a recogniser calls so."""
        key = key_of(label)
        named = (each for each in self._known.values() if key in map(key_of, each.labels))
        return self._known.get(key) or next(named, None)

    def is_taken(self, name: str) -> bool:
        """Whether somebody has this name."""
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

    def gone(self) -> None:
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
            self._tell_more(visitor, facts)

    def _learn(self, name: str, facts: dict[str, str], today: date) -> None:
        day = today.isoformat()
        group, address = (facts.get(fact, "") for fact in _FACTS)
        visitor = Visitor(name, group, address, (), day, day, 1)
        self._known[key_of(name)] = visitor
        self._here = name
        self._log(visitor, "learnt")
        self._do(
            StoreJob(
                lambda store: store.add(name, on=today, age_group=group, address=address), name
            )
        )

    def _tell_more(self, visitor: Visitor, facts: dict[str, str]) -> None:
        about = visitor.about
        other = [fact for fact, value in facts.items() if about.get(fact, value) != value]
        new = {fact: value for fact, value in facts.items() if value and fact not in about}
        if other:
            said = ", ".join(f"{fact.replace('_', ' ')} {about[fact]}" for fact in other)
            self._publish(
                m.Notice(
                    level="warning",
                    text=f"{visitor.name} is in the file with {said}; the file keeps this",
                    remedy="change it with `woz visitors`",
                    tells=("identity",),
                )
            )
        if new:
            more = Visitor(
                visitor.name,
                new.get("age_group", visitor.age_group),
                new.get("address", visitor.address),
                visitor.labels,
                *(visitor.first_met, visitor.last_met, visitor.meetings),
            )
            self._known[key_of(visitor.name)] = more
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
        self._clerk.do(*again, job)

    def _catch_up(self) -> None:
        """Hear what has become of jobs."""
        for outcome in self._clerk.outcomes():
            if outcome.unmade and outcome.job.name:
                self._unmade.append(outcome.job)
            else:
                self._open.remove(outcome.job)
            self._unsaved = outcome.unsaved
            if outcome.people is not None:
                self._know(outcome.people)
            self._tell(outcome)

    def _know(self, people: Iterable[Visitor]) -> None:
        """Those of the store, and whoever is not there only because a job still waits."""
        before, self._known = self._known, {key_of(visitor.name): visitor for visitor in people}
        for key in {key_of(job.name) for job in self._open if job.name}:
            if key in before:
                self._known[key] = before[key]
        for key in self._named.keys() - self._known.keys():
            self._publish(m.VisitorChanged(visitor=self._named.pop(key), what="forgotten"))

    # -- told --------------------------------------------------------------------------------------

    def _tell(self, outcome: StoreJobResult) -> None:
        if outcome.given_up:
            text = f"visitors: {'; '.join(outcome.given_up)}"
            self._publish(m.Notice(level="warning", text=text, remedy=_LOOK, tells=("identity",)))
        if outcome.error is not None:
            self._complain(outcome.error)
        elif not outcome.unsaved:
            self._complaint = ""

    def _complain(self, error: Exception) -> None:
        """A notice, once as long as it is the same."""
        text = f"visitors: {getattr(error, 'reason', '') or error}"
        if text == self._complaint:
            return
        self._complaint = text
        level = "warning" if isinstance(error, VisitorRefusedError) else "error"
        remedy = getattr(error, "remedy", "")
        self._publish(m.Notice(level=level, text=text, remedy=remedy, tells=("identity",)))
