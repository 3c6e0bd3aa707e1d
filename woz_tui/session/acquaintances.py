"""The visitors whom the robot knows, for a session that must never wait for a disk.

What is known is in memory; the file (`woz_tui.sensing.people`) is read once at the beginning, and
changed by a thread of its own. A file that cannot be read or written costs a notice and nothing
else: names stay in memory, and go into the file with the next change that it takes.
"""

from __future__ import annotations

import functools
import logging
import threading
from collections import deque
from collections.abc import Callable
from datetime import date
from pathlib import Path

from woz_tui.core import messages as m
from woz_tui.sensing.names import BadNameError, key_of
from woz_tui.sensing.people import RefusedError, Visitor, Visitors, VisitorsError

_FACTS = ("age_group", "address")

log = logging.getLogger(__name__)

#: Makes one change in the file; may raise `VisitorsError`.
Job = Callable[[Visitors], object]


class Acquaintances:
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
        self._later = later
        self._store = Visitors(path)
        self._known: dict[str, Visitor] = {}
        self._jobs: deque[Job] = deque()
        self._lock = threading.Lock()
        self._thread: threading.Thread | None = None
        self._told = ""
        self._here = ""

    def read(self) -> None:
        """Learn from the file who is known; what is wrong with it becomes a notice."""
        try:
            self._remember(self._store.everybody())
        except (VisitorsError, OSError, ValueError) as error:
            self._tell(error)

    def wait(self, seconds: float) -> None:
        """Wait until all changes have been tried, at most so long."""
        thread = self._thread
        if thread is not None:
            thread.join(seconds)

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
        self._publish(m.VisitorChanged(visitor=visitor.name, what="met", about=visitor.about))
        self._do(lambda store: store.met(visitor.name, on=today))

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
        self._publish(m.VisitorChanged(visitor=name, what="learnt", about=visitor.about))
        self._do(lambda store: store.add(name, on=today, age_group=group, address=address))

    def _tell_more(self, visitor: Visitor, facts: dict[str, str]) -> None:
        about = visitor.about
        other = [fact for fact, value in facts.items() if about.get(fact, value) != value]
        new = {fact: value for fact, value in facts.items() if value and fact not in about}
        if other:
            said = ", ".join(f"{fact.replace('_', ' ')} {about[fact]}" for fact in other)
            self._publish(
                m.Notice(
                    level="warning",
                    text=f"{visitor.name} stands in the file with {said}; it stays so",
                    remedy="change it with `woz visitors`",
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
            self._publish(m.VisitorChanged(visitor=visitor.name, what="profile", about=more.about))
            group, address = new.get("age_group"), new.get("address")
            self._do(lambda store: store.profile(visitor.name, age_group=group, address=address))

    # -- the thread --------------------------------------------------------------------------------

    def _do(self, job: Job) -> None:
        """Have a change made. The thread lives for as long as there are changes, so that the
        process neither ends before they are made nor stays for a thread that has nothing to do.
        """
        with self._lock:
            self._jobs.append(job)
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="visitors")
                self._thread.start()

    def _next(self) -> Job | None:
        with self._lock:
            if self._jobs:
                return self._jobs.popleft()
            self._thread = None
            return None

    def _work(self) -> None:
        while (job := self._next()) is not None:
            try:
                job(self._store)
                people = self._store.everybody()
            except (VisitorsError, BadNameError, OSError) as error:
                self._hand_over(functools.partial(self._tell, error))
            except Exception as error:
                log.exception("the store of visitors failed")
                self._hand_over(functools.partial(self._tell, error))
            else:
                self._hand_over(functools.partial(self._saved, people))

    def _hand_over(self, call: Callable[[], object]) -> None:
        try:
            self._later(call)
        except RuntimeError:  # the loop has closed: the session is over
            log.warning("nobody hears any more what became of the store of visitors")

    def _saved(self, people: list[Visitor]) -> None:
        self._told = ""
        with self._lock:
            waiting = bool(self._jobs)
        if not waiting:  # what others have forgotten or renamed is forgotten here too
            self._known.clear()
        self._remember(people)

    def _remember(self, people: list[Visitor]) -> None:
        self._known.update({key_of(visitor.name): visitor for visitor in people})

    def _tell(self, error: Exception) -> None:
        """A notice, once as long as it is the same."""
        text = f"visitors: {getattr(error, 'reason', '') or error}"
        if text == self._told:
            return
        self._told = text
        level = "warning" if isinstance(error, RefusedError) else "error"
        remedy = getattr(error, "remedy", "")
        self._publish(m.Notice(level=level, text=text, remedy=remedy))
