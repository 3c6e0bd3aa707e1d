"""The engagement model: samples and events in, states of the conversation out.

A pure object. Time comes in as stamps `t` in whole microseconds, in any order; what passes is the
model's own time, which never goes back (`model_time.py`). `docs/explanation/engagement.md` tells
the policies.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_words import RUNS, SIGNS, VISITOR
from woz_tui.protocol.envelope import Json
from woz_tui.protocol.messages import EngagementShown
from woz_tui.protocol.requesters import WIZARD
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.loudness_speech import LoudnessSpeechDetector
from woz_tui.sensing.model_time import SECOND, ModelClock, microseconds, periods
from woz_tui.sensing.signs import Signs
from woz_tui.sensing.state_machine import (
    BY_SIGNS,
    TURN,
    Edge,
    Event,
    ModelView,
    State,
    always,
    by_signs,
    edge_to,
    edges_from,
)

#: The outcome with which the state of an earlier participant ends; no way of the table.
NEW_PARTICIPANT = "new_participant"
_ANOTHER_PARTICIPANT = Sentence("why.participant", "another participant")
#: Who moved the machine by hand; `why` is what the signs say, or the reason of the way.
_FORCED = Sentence("why.forced_by", "forced by {by}: {why}", by="{by}", why="{why}")
_STEPPED = Sentence("why.stepped_by", "stepped by {by}: {why}", by="{by}", why="{why}")
#: States of the trail.
TRAIL = 12
#: Events that wait while the machine is held, or for the next step.
WAITING = 16
#: The time limit of a state: a name of `Timeouts`.
_LIMITS = {
    State.DETECTED: "approach",
    State.USER_SPEAKS: "listening",
    State.THINKS: "thinking",
    State.REPLIES: "talking",
    State.ROBOT_SPEAKS: "talking",
}


@dataclass(frozen=True, slots=True)
class Transition:
    """One edge that was taken, at the stamp `t` in microseconds.

    `verdicts`: presence, gaze and distance as 0, 1 or None, identity as a name or "Unknown".
    `forced`: somebody moved it by hand, or gave a verdict that it rests on.
    """

    t: int
    was: str
    now: str
    outcome: str
    why: str
    verdicts: dict[str, Json]
    visitor: str
    forced: bool


class EngagementModel:
    """One visitor after the other, as the settings see them. `t` is where the stamps begin.

    `cuts`: a microphone's driver cuts speech itself and tells the events; loudness is only shown.
    """

    def __init__(self, settings: EngagementSettings, t: int = 0, *, cuts: bool = False) -> None:
        self.settings = settings
        self.cuts = cuts
        self._time = ModelClock(t, periods(1, settings.rate))
        self.signs = Signs(settings, t)
        self.voice = LoudnessSpeechDetector(settings.sound)
        self.state = State.WAIT
        self.since = t
        self._trail: deque[str] = deque([State.WAIT.value], maxlen=TRAIL)
        self._run = settings.start
        #: The handshake's question, counted by whoever leads it.
        self.attempt = 0
        #: What the robot attends to beside the visitor; only shown.
        self.attention = ""
        self._failed = 0
        #: `visitor`: who it is, in a turn whoever spoke, though somebody else may be there by now.
        self._introduced = self._face = self.visitor = ""
        self._replaced = False
        self._events: deque[Event] = deque(maxlen=WAITING)
        self._queued: deque[Event] = deque(maxlen=WAITING)
        self._engaged = False
        self._turned = t
        self._nameless_since = t
        self._there = False
        self._left = t
        self._stands: tuple[bool, bool, bool] | None = None

    # -- what comes in --------------------------------------------------------------------------

    def advance(self, t: int) -> None:
        """The stamps stand at `t`: time has passed, and signs may have become stale."""
        self._time.to(t)
        now = self._time.now
        self.signs.pass_to(now)
        ended = self.voice.pass_to(now)
        if ended is not None and not self.cuts:
            self._events.append(ended)
        self._notice_changes()

    def sample(self, sign: str, value: object, name: str = "") -> bool:
        """A value of presence, gaze, distance, identity or loudness, whatever it is, at present.

        Returns whether it says anything; `sample_values.py` knows what. `ValueError`: another
        sign.
        """
        now = self._time.now
        if sign == "loudness":
            taken, event = self.voice.add(value, now)
            if event is not None and not self.cuts:
                self._events.append(event)
            return taken
        taken = self.signs.add(sign, value, name, now)
        self._notice_changes()
        return taken

    def override(self, sign: str, value: object | None, name: str = "", by: str = WIZARD) -> None:
        """The verdict of the wizard, or `by` whom it is, which no filter delays and which is never
        stale; None: no more.

        A truth value or 0/1; for distance a truth value or metres; a name for identity. ValueError
        with a sentence for anything else.
        """
        self.signs.override(sign, value, name, by)
        self._notice_changes()

    def configure(
        self,
        sign: str,
        *,
        kind: str | None = None,
        samples: int | None = None,
        threshold: float | None = None,
    ) -> None:
        """Another filter for a sign, or other numbers; its queue keeps what fits.

        ValueError with a sentence for a sign or numbers that there are not.
        """
        self.signs.configure(sign, kind, samples, threshold)
        self._notice_changes()

    def set_threshold(self, rms: object) -> None:
        """The loudness of speech as the microphone has learnt it; the settings go before it."""
        self.voice.tell_threshold(rms)

    def near_within(self, metres: float) -> None:
        """Another social distance; ValueError outside of 0.1 to 10 m."""
        self.signs.near_within(metres)
        self._notice_changes()

    def loudness_events(self) -> list[Event]:
        """Take out what the loudness has brought since the last step."""
        events = list(self._events)
        self._events.clear()
        return events

    def adopt(self, settings: EngagementSettings) -> None:
        """Go on with other settings. State, name and the wizard's verdicts stay; so does what was
        configured by hand, where the settings say what they said before.
        """
        before, self.settings = self.settings, settings
        self._time.period = periods(1, settings.rate)
        self.signs.adopt(settings, before)
        self.voice.adopt(settings.sound)
        self._notice_changes()

    def take_name(self, name: str) -> None:
        """The visitor's code, from the handshake or the wizard; forgotten with the visitor."""
        self._introduced = name
        self._replaced = False
        self.visitor = name or self._recognised()
        self._notice_changes()

    @property
    def run(self) -> str:
        """`run`; `hold`: only by hand; `off`."""
        return self._run

    @run.setter
    def run(self, run: str) -> None:
        if run not in RUNS:
            raise ValueError(f"{run!r} is none of {', '.join(RUNS)}")
        self._run = run
        self._queued.clear()

    # -- what follows ---------------------------------------------------------------------------

    def step(self, event: Event | None = None) -> Transition | None:
        """Take one edge at most: with `event`, or with what was heard, or by the signs alone."""
        if event is None and self._events:
            event = self._events.popleft()
        if self._run != "run":
            if event is not None and self._run == "hold":
                self._queued.append(event)
            return None
        edge = self._edge(event)
        return None if edge is None else self._follow(edge, event)

    def step_once(self, by: str = WIZARD) -> Transition | None:
        """In `hold`: take the edge that is pending, by hand; `by` whom."""
        found = self._waiting()
        if found is None:
            return None
        edge, event = found
        while event is not None and self._queued.popleft() is not event:
            pass
        return self._follow(edge, event, _STEPPED, by)

    def force(self, to: str, by: str = WIZARD) -> Transition:
        """Go to a state, or along an outcome of the present one; it stands until the signs say
        something else than now. ValueError with a sentence if there is no such state or outcome,
        or it is there already.
        """
        edge = edge_to(self.state, to)
        self._queued.clear()
        change = self._follow(edge, None, _FORCED, by)
        self._stands = self._verdict()
        return change

    def begin_anew(self) -> Transition | None:
        """Another participant comes: nobody is there yet, whatever holds of the one before."""
        for sign in SIGNS:
            self.override(sign, None)
        self.take_name("")
        if self.state is State.WAIT:
            return None
        self._queued.clear()
        return self._follow(
            Edge(self.state, State.WAIT, NEW_PARTICIPANT, always, _ANOTHER_PARTICIPANT), None
        )

    @property
    def pending(self) -> str:
        """The state to which a held machine would go; empty if to none."""
        found = self._waiting() if self._run == "hold" else None
        return "" if found is None else found[0].target.value

    def due(self) -> int | None:
        """The next stamp at which something could happen without any sample or event."""
        now = self._time.now
        if self._events or (self._run == "run" and self._edge(None) is not None):
            return self._time.stamp(now)
        moment = min((at for at in self._deadlines() if at > now), default=None)
        return None if moment is None else self._time.stamp(moment)

    # -- how it stands --------------------------------------------------------------------------

    @property
    def now(self) -> int:
        """The model's time in microseconds."""
        return self._time.now

    @property
    def trail(self) -> list[str]:
        """The last states, oldest first; the present one at the end."""
        return list(self._trail)

    @property
    def engaged(self) -> bool:
        """The condition of engagement: all signs that the experiment uses say yes, and lately."""
        return self._engaged

    @property
    def has_name(self) -> bool:
        """Whether there is a name, by the filter or as somebody told it."""
        return self.signs.identity.has_name or bool(self._introduced)

    @property
    def verdicts(self) -> dict[str, Json]:
        """Presence, gaze, distance (near) as 0, 1 or None; identity as a name or "Unknown"."""
        return self.signs.verdicts

    @property
    def reason(self) -> str:
        """What the signs say, in words."""
        return self.signs.reason(self._time.now, self._introduced)

    @property
    def waits_since(self) -> int:
        """Since when, in the model's time, the visitor waits for an answer; -1: nobody does."""
        return self.since if self.state is State.THINKS else -1

    def shown(self) -> EngagementShown:
        """All of it for the screen; times as stamps."""
        waits = self.waits_since
        return EngagementShown(
            state=self.state.value,
            since=self._time.stamp(self.since),
            trail=self.trail,
            signs=self.signs.shown(),
            run=self._run,
            uses=[sign.name for sign in self.signs.uses],
            social_distance=self.signs.near,
            engaged=self.engaged,
            next=self.pending,
            waits_since=-1 if waits < 0 else self._time.stamp(waits),
            visitor=self.visitor,
            attempt=self.attempt,
            attention=self.attention,
        )

    # -- inside ---------------------------------------------------------------------------------

    def _verdict(self) -> tuple[bool, bool, bool]:
        return self.signs.present, self._engaged, self.has_name

    def _notice_changes(self) -> None:
        """Notice when the condition, the name, or whoever is there comes and goes."""
        now = self._time.now
        engaged = self.signs.engaged(now)
        recognised = self._recognised()
        if recognised and recognised != self._face:  # somebody else: what was told is over
            self._face, self._introduced = recognised, ""
            corrected = self.signs.identity.forced is not None  # the wizard knows better who it is
            spoke = self.state in TURN and self.visitor not in ("", recognised)
            self._replaced = spoke and not corrected
            if not self._replaced:
                self.visitor = recognised
        elif self.state is State.WAIT or not self.visitor:
            self._face, self.visitor = recognised, self._introduced or recognised
        if engaged != self._engaged:
            self._engaged = engaged
            self._turned = now
        if self.signs.present != self._there:
            self._there = not self._there
            self._left = now
        if not engaged or self.has_name:
            self._nameless_since = now
        if self._stands is not None and self._stands != self._verdict():
            self._stands = None

    def _view(self, event: Event | None) -> ModelView:
        now = self._time.now
        shakes = self.settings.handshake
        return ModelView(
            event=event,
            presence=self.signs.present,
            engaged=self._engaged,
            known=self.has_name,
            elapsed=(now - self.since) / SECOND,
            lost_for=0.0 if self._engaged else (now - self._turned) / SECOND,
            nameless_for=(now - self._nameless_since) / SECOND,
            absent_for=0.0 if self._there else (now - self._left) / SECOND,
            replaced=self._replaced,
            turns=self.settings.turns,
            tries_left=(1 if shakes.by == "robot" else shakes.attempts) - self._failed,
            timeouts=self.settings.timeouts,
            handshake=shakes,
        )

    def _edge(self, event: Event | None) -> Edge | None:
        """The first edge that holds; signs that the wizard has overruled move nothing."""
        view = self._view(event)
        for edge in edges_from(self.state):
            if edge.when(view) and (self._stands is None or not by_signs(edge, view)):
                return edge
        return None

    def _waiting(self) -> tuple[Edge, Event | None] | None:
        """The edge that a held machine would take, and the event that it needs."""
        for event in self._queued:
            edge = self._edge(event)
            if edge is not None:
                return edge, (None if edge is self._edge(None) else event)
        edge = self._edge(None)
        return None if edge is None else (edge, None)

    def _follow(
        self, edge: Edge, event: Event | None, by_hand: Sentence | None = None, by: str = ""
    ) -> Transition:
        """Take the edge. `by_hand`: that it was moved `by` somebody, and why, which are open."""
        forced = by_hand is not None or self._rests_on_wizard(edge, event)
        why = BY_SIGNS if by_hand is _FORCED else edge.why
        why = self.signs.explained(why, self._time.now, self._introduced)
        if by_hand is not None:
            why = by_hand.filled(by=by, why=why)
        self.state, self.since = edge.target, self._time.now
        self._trail.append(edge.target.value)
        if event is None or self.settings.turns != VISITOR:
            self._stands = None  # else whom the wizard has put there may speak and get an answer
        self._enter(edge)
        return Transition(
            t=self._time.stamp(self.since),
            was=edge.source.value,
            now=edge.target.value,
            outcome=edge.outcome,
            why=why,
            verdicts=self.verdicts,
            visitor=self.visitor,
            forced=forced,
        )

    def _enter(self, edge: Edge) -> None:
        """Whom the model remembers in the state that begins."""
        if edge.outcome == "eng2unknow":
            self._failed += 1
        if edge.target in (State.WAIT, State.DETECTED):
            self._failed = 0
        if edge.target is State.WAIT:
            self._introduced = ""
        if self._replaced and edge.target not in TURN:
            self._replaced = False
            self.visitor = self._introduced or self._face
        if edge.target in (State.WAIT, State.UNKNOWN):
            self.visitor = self._introduced or self._recognised()
        self.attempt = self._failed + 1 if edge.target is State.HANDSHAKE else 0

    def _rests_on_wizard(self, edge: Edge, event: Event | None) -> bool:
        if not by_signs(edge, self._view(event)):
            return False
        presence = edge.outcome in ("human_presence", "human_absence")
        named = edge.outcome in ("recognized", "unrecognized")
        return self.signs.overruled(presence, not presence, named)

    def _recognised(self) -> str:
        identity = self.signs.identity
        return identity.name_given if identity.has_name else ""

    def _deadlines(self) -> Iterator[int]:
        yield from self.signs.deadlines()
        ends = self.voice.ends_at()
        if ends is not None:
            yield ends
        timeouts = self.settings.timeouts
        limit: float | None = getattr(timeouts, _LIMITS.get(self.state, ""), None)
        if limit is not None:
            yield self.since + microseconds(limit)
        if self.state is State.HANDSHAKE:
            yield self.since + microseconds(self.settings.handshake.seconds)
        if timeouts.absent is not None and not self._there:
            yield self._left + microseconds(timeouts.absent)
        if not self._engaged:
            yield self._turned + microseconds(timeouts.lost)
            if timeouts.turn_lost is not None:
                yield self._turned + microseconds(timeouts.turn_lost)
        elif not self.has_name:
            yield self._nameless_since + microseconds(timeouts.unrecognized)
