"""From something that wants an answer to the wizard's next act."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any

from woz_tui.analysis.course import Course, Handlers
from woz_tui.analysis.figures import Cue, Training
from woz_tui.analysis.series import Series
from woz_tui.analysis.tally import Tally
from woz_tui.core import messages as m

#: An answer within this time is one (microseconds), unless somebody says otherwise.
WINDOW_US = 10_000_000
#: Two cues within this time stand for one event: the end of speech leads the engagement model into
#: its next state.
ECHO_US = 1_000_000
#: An act within this time before a cue, while the visitor was still speaking or the model still
#: waiting for the end of it, is the answer: whoever listens hears the end of a sentence coming, and
#: a microphone reports it late, after a second of silence.
EARLY_US = 1_000_000
#: States of the engagement model in which the visitor waits for an answer.
WAITING = ("RobotThinks",)
#: Markers that no human has set.
UNMEANT = frozenset({"action", "preflight"})
#: Acts that may come before the line of the cue they answer.
_KEPT = 16


@dataclass(slots=True)
class _Open:
    sort: str
    t: int
    what: str
    tally: Tally
    trial: int
    echo: bool = False


class Cues:
    """Matches cues with acts. A cue is open until the next act, the end of the window, or until it
    is overtaken: by another one of its sort, by the visitor going on to speak, or by the engagement
    model leaving the state. One that is not a marker may be answered before it comes.

    Args:
        course: Where the session stands.
        window_us: Within this time after a cue the answer must come.
        waiting: States of the engagement model that are cues.
    """

    def __init__(
        self, course: Course, window_us: int = WINDOW_US, waiting: Collection[str] = WAITING
    ) -> None:
        self._course = course
        self._window = window_us
        self._waiting = frozenset(waiting)
        self._open: dict[str, _Open] = {}
        self._anticipated: _Open | None = None
        self._acts: deque[tuple[int, str, str]] = deque(maxlen=_KEPT)
        self._taught: dict[str, tuple[m.CueGiven, _Open]] = {}
        self._judged = dict.fromkeys(("right", "wrong", "missed", "uncalled"), 0)
        self._given = 0
        self._trained = False
        self._times = Series()

    def handlers(self) -> Handlers:
        """What it listens to."""
        return {
            m.SpeechStarted: self._speaks,
            m.SpeechEnded: self._spoke,
            m.EngagementChanged: self._engagement,
            m.Marker: self._marker,
            m.CueGiven: self._taught_cue,
            m.CueAnswered: self._taught_answer,
        }

    def act(self, name: str, run: str) -> None:
        """The wizard does something: it answers what is open."""
        t = self._course.t
        self._acts.append((t, name, run))
        for sort in list(self._open):
            self._answer(self._open.pop(sort), t, name, run)

    def finish(self) -> None:
        """The log is over."""
        for cue in self._open.values():
            self._close(cue, "missed" if self._late(cue) else "cut")
        for _, cue in self._taught.values():
            self._close(cue, "cut")

    @property
    def training(self) -> Training | None:
        """None if this was none."""
        if not self._trained:
            return None
        judged = self._judged
        return Training(
            cues=self._given,
            right=judged["right"],
            wrong=judged["wrong"],
            missed=judged["missed"],
            uncalled=judged["uncalled"],
            times=self._times,
        )

    # -- cues -------------------------------------------------------------------------------------

    def _speaks(self, message: m.SpeechStarted) -> None:
        self._overtake("speech")

    def _spoke(self, message: m.SpeechEnded) -> None:
        course = self._course
        course.tally.speech.add(message.ended - message.began)
        ended = message.ended if 0 <= message.ended <= course.t else course.t
        self._give("speech", ended, f"utterance {message.segment}", message.began)

    def _engagement(self, message: m.EngagementChanged) -> None:
        self._overtake("engagement")
        if message.now in self._waiting:
            self._give("engagement", self._course.t, message.now, 0)

    def _marker(self, message: m.Marker) -> None:
        if message.source not in UNMEANT:
            self._give("marker", self._course.t, message.text)

    def _give(self, sort: str, t: int, what: str, since: int | None = None) -> None:
        """A cue at `t`. An act after `since` may have anticipated it; None: nothing can."""
        course = self._course
        self._overtake(sort)
        cue = _Open(sort, t, what, course.tally, course.trial)
        others = [each for each in self._open.values() if not each.echo]
        if self._anticipated is not None:
            others.append(self._anticipated)
        cue.echo = any(abs(t - each.t) <= ECHO_US for each in others)
        early = None if since is None else self._act(max(since, t - EARLY_US), t)
        if early is not None:
            if not cue.echo:
                self._anticipated = cue
            self._close(cue, "anticipated", action=early[1], run=early[2])
        elif (already := self._act(t + 1, course.t)) is not None:
            self._answer(cue, *already)
        else:
            self._open[sort] = cue

    def _act(self, begin: int, end: int) -> tuple[int, str, str] | None:
        """The first act in this time, both ends included."""
        return next((act for act in self._acts if begin <= act[0] <= end), None)

    def _overtake(self, sort: str) -> None:
        cue = self._open.pop(sort, None)
        if cue is not None:
            self._close(cue, "missed" if self._late(cue) else "overtaken")

    def _late(self, cue: _Open) -> bool:
        return self._course.t - cue.t > self._window

    def _answer(self, cue: _Open, t: int, name: str, run: str) -> None:
        reaction = t - cue.t
        if reaction > self._window:
            self._close(cue, "missed")
        else:
            self._close(cue, "answered", reaction_us=reaction, action=name, run=run)

    def _close(self, cue: _Open, fate: str, **answer: Any) -> None:
        cue.tally.cues.append(
            Cue(
                sort=cue.sort,
                t=cue.t,
                what=cue.what,
                fate=fate,
                echo=cue.echo,
                participant=cue.tally.participant,
                condition=cue.tally.condition,
                trial=cue.trial,
                **answer,
            )
        )

    # -- training ---------------------------------------------------------------------------------

    def _taught_cue(self, message: m.CueGiven) -> None:
        course = self._course
        self._given += 1
        self._trained = True
        cue = _Open("training", course.t, message.sort, course.tally, course.trial)
        self._taught[message.cue] = (message, cue)

    def _taught_answer(self, message: m.CueAnswered) -> None:
        self._trained = True
        if message.judged in self._judged:
            self._judged[message.judged] += 1
        given = self._taught.pop(message.cue, None)
        if given is None:
            return
        if message.judged == "void":  # the stop came in between, or the end: nobody's failure
            self._given -= 1
            self._close(given[1], "cut")
            return
        reaction = message.reaction_us if message.reaction_us >= 0 else None
        fate = "answered" if message.judged in ("right", "wrong") else "missed"
        if reaction is not None and fate == "answered":
            self._times.add(reaction)
        self._close(
            given[1],
            fate,
            reaction_us=reaction,
            action=message.action,
            run=message.run,
            judged=message.judged,
        )
