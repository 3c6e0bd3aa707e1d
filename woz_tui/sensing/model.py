"""The engagement model: samples and events in, states of the conversation out.

A pure object. Time comes in as stamps `t` in whole microseconds, in any order; what passes is the
model's own time, which never goes back (`passing.py`). `docs/engagement.md` tells the policies.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace

from woz_tui.core.engaged import EngagementShown
from woz_tui.core.envelope import Json
from woz_tui.experiment.engagement import CONDITION, FILTERS, RUNS, SIGNS, EngagementSettings
from woz_tui.sensing import samples
from woz_tui.sensing.machine import Edge, Event, State, View, edges_from
from woz_tui.sensing.passing import SECOND, Passing, microseconds
from woz_tui.sensing.signs import FRESH, Identity, Sign
from woz_tui.sensing.voice import Voice

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
class Change:
    """One edge that was taken, at the stamp `t` in microseconds.

    `verdicts`: presence, gaze and distance as 0, 1 or None, identity as a name or "Unknown".
    `forced`: the wizard moved it, or a verdict that it rests on is the wizard's.
    """

    t: int
    was: str
    now: str
    outcome: str
    why: str
    verdicts: dict[str, Json]
    visitor: str
    forced: bool


class Engagement:
    """One visitor after the other, as the settings see them. `t` is where the stamps begin.

    `cuts`: a microphone's driver cuts speech itself and tells the events; loudness is only shown.
    """

    def __init__(self, settings: EngagementSettings, t: int = 0, *, cuts: bool = False) -> None:
        self.settings = settings
        self._time = Passing(t, microseconds(1 / settings.rate))
        self._signs = {name: Sign(name, settings, t) for name in CONDITION}
        self._identity = Identity(settings, t)
        self._uses = [self._signs[name] for name in CONDITION if name in settings.signs]
        self.cuts = cuts
        self.voice = Voice(settings.sound.threshold, settings.sound.hang_over)
        self.social_distance = settings.social_distance
        self.state = State.WAIT
        self.since = t
        self._trail: deque[str] = deque([State.WAIT.value], maxlen=TRAIL)
        self._run = settings.start
        #: The handshake's question, counted by whoever leads it.
        self.attempt = 0
        #: What the robot attends to beside the visitor; only shown.
        self.attention = ""
        self._failed = 0
        self._told = ""
        self.visitor = ""
        self._events: deque[Event] = deque(maxlen=WAITING)
        self._held: deque[Event] = deque(maxlen=WAITING)
        self._engaged = False
        self._turned = t
        self._nameless_since = t
        self._stands: tuple[bool, bool, bool] | None = None

    # -- what comes in --------------------------------------------------------------------------

    def advance(self, t: int) -> None:
        """The stamps stand at `t`: time has passed, and signs may have become stale."""
        self._time.to(t)
        now = self._time.now
        for sign in self._signs.values():
            sign.pass_to(now)
        self._identity.pass_to(now)
        ended = self.voice.pass_to(now)
        if ended is not None and not self.cuts:
            self._events.append(ended)
        self._look()

    def sample(self, sign: str, value: object, name: str = "") -> bool:
        """A value of presence, gaze, distance, identity or loudness, whatever it is, at present.

        Returns whether it says anything; `samples.py` knows what. ValueError for another sign.
        """
        now = self._time.now
        if sign == "loudness":
            return self._hear(value, now)
        if sign == "identity":
            taken = self._identity.take(value, name, now)
        else:
            taken = self._sign(sign).take(value, now)
        self._look()
        return taken

    def override(self, sign: str, value: object | None, name: str = "") -> None:
        """The wizard's verdict, which no filter delays and which is never stale; None: no more.

        A truth value or 0/1; for distance a truth value or metres; a name for identity. ValueError
        with a sentence for anything else.
        """
        if sign == "identity":
            self._identity.forced = _name(value, name)
        else:
            self._sign(sign).forced = _verdict(sign, value)
        self._look()

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
        _check(sign, kind, samples, threshold)
        if sign == "identity":
            self._identity.configure(samples, threshold)
        else:
            self._signs[sign].configure(kind, samples, threshold)
        self._look()

    def near_within(self, metres: float) -> None:
        """Another social distance. ValueError outside 0.1 m to what the sensor reaches."""
        if not 0.1 <= metres < self.settings.farthest:
            raise ValueError(f"{metres:g} m is not 0.1 to less than {self.settings.farthest:g} m")
        self.social_distance = metres
        self._signs["distance"].near_within(metres)
        self._look()

    def set_threshold(self, rms: object) -> None:
        """The loudness of speech as the microphone has learnt it."""
        self.voice.tell_threshold(rms)

    def known_as(self, name: str) -> None:
        """The visitor's code, from the handshake or the wizard; forgotten with the visitor."""
        self._told = name
        self.visitor = name
        self._look()

    def adopt(self, settings: EngagementSettings) -> None:
        """Go on with settings that were read again: state, name and verdicts by hand stay, queues
        as far as they fit, and what was set while running unless it is that which was edited.
        """
        was, self.settings = self.settings, settings
        for sign in (*self._signs.values(), self._identity):
            sign.adopt(settings, was)
        if settings.social_distance != was.social_distance:
            self.near_within(settings.social_distance)
        if settings.sound != was.sound:
            self.voice = Voice(settings.sound.threshold, settings.sound.hang_over)
        self._uses = [self._signs[name] for name in CONDITION if name in settings.signs]
        self._look()

    @property
    def run(self) -> str:
        """`run`; `hold`: only by hand; `off`."""
        return self._run

    @run.setter
    def run(self, run: str) -> None:
        if run not in RUNS:
            raise ValueError(f"{run!r} is none of {', '.join(RUNS)}")
        self._run = run
        self._held.clear()

    # -- what follows ---------------------------------------------------------------------------

    def step(self, event: Event | None = None) -> Change | None:
        """Take one edge at most: with `event`, or with what was heard, or by the signs alone."""
        if event is None and self._events:
            event = self._events.popleft()
        if self._run != "run":
            if event is not None and self._run == "hold":
                self._held.append(event)
            return None
        edge = self._edge(event)
        return None if edge is None else self._take(edge, event)

    def step_once(self) -> Change | None:
        """In `hold`: take the edge that is pending, by hand."""
        found = self._waiting()
        if found is None:
            return None
        edge, event = found
        while event is not None and self._held.popleft() is not event:
            pass
        return self._take(edge, event, by_hand="stepped by the wizard: ")

    def force(self, to: str) -> Change:
        """Go to a state, or along an outcome of the present one.

        It stands until the signs say something else than now. ValueError with a sentence if there
        is no such state or outcome, or it is there already.
        """
        edge = self._edge_to(to)
        self._held.clear()
        change = self._take(edge, None, by_hand="forced by the wizard: ")
        self._stands = self._verdict()
        return change

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
        now = self._time.now
        return bool(self._uses) and all(
            sign.verdict == 1 and sign.fresh(now) for sign in self._uses
        )

    @property
    def present(self) -> bool:
        """Whether somebody is there: by presence, or by any sign used if presence is not."""
        if "presence" in self.settings.signs:
            return self._signs["presence"].verdict == 1
        return any(sign.verdict == 1 for sign in self._uses)

    @property
    def known(self) -> bool:
        """Whether there is a name, by the filter or as somebody told it."""
        return self._identity.known or bool(self._told)

    @property
    def verdicts(self) -> dict[str, Json]:
        """Presence, gaze, distance (near) as 0, 1 or None; identity as a name or "Unknown"."""
        found: dict[str, Json] = {name: sign.verdict for name, sign in self._signs.items()}
        return {**found, "identity": self._identity.name_given}

    @property
    def stale(self) -> list[str]:
        """The signs whose sensors were heard once, and are not heard any more."""
        everyone = (*self._signs.values(), self._identity)
        return [sign.name for sign in everyone if sign.stale and sign.ever]

    @property
    def reason(self) -> str:
        """What the signs say, in words."""
        now = self._time.now
        said = [sign.words(now) for sign in self._uses]
        return ", ".join([*said, self._identity.words()])

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
            signs={
                **{name: sign.shown() for name, sign in self._signs.items()},
                "identity": self._identity.shown(),
            },
            run=self._run,
            uses=[sign.name for sign in self._uses],
            social_distance=self.social_distance,
            engaged=self.engaged,
            next=self.pending,
            waits_since=-1 if waits < 0 else self._time.stamp(waits),
            visitor=self.visitor,
            attempt=self.attempt,
            attention=self.attention,
        )

    # -- inside ---------------------------------------------------------------------------------

    def _sign(self, name: str) -> Sign:
        if name not in self._signs:
            raise ValueError(f"{name!r} is none of {', '.join(SIGNS)}")
        return self._signs[name]

    def _hear(self, value: object, now: int) -> bool:
        taken, event = self.voice.take(value, now)
        if event is not None and not self.cuts:
            self._events.append(event)
        return taken

    def _verdict(self) -> tuple[bool, bool, bool]:
        return self.present, self.engaged, self.known

    def _look(self) -> None:
        """Notice when the condition, or the name, comes and goes."""
        now = self._time.now
        engaged = self.engaged
        name = self._identity.name_given
        if self._identity.known and name != self.visitor:
            self.visitor = name
            self._told = ""
        if engaged != self._engaged:
            self._engaged = engaged
            self._turned = now
        if not engaged or self.known:
            self._nameless_since = now
        if self._stands is not None and self._stands != self._verdict():
            self._stands = None

    def _view(self, event: Event | None) -> View:
        now = self._time.now
        shakes = self.settings.handshake
        return View(
            event=event,
            presence=self.present,
            engaged=self._engaged,
            known=self.known,
            elapsed=(now - self.since) / SECOND,
            lost_for=0.0 if self._engaged else (now - self._turned) / SECOND,
            nameless_for=(now - self._nameless_since) / SECOND,
            tries_left=(1 if shakes.by == "robot" else shakes.attempts) - self._failed,
            timeouts=self.settings.timeouts,
            handshake=shakes,
        )

    def _edge(self, event: Event | None) -> Edge | None:
        """The first edge that holds; signs that the wizard has overruled move nothing."""
        view = self._view(event)
        for edge in edges_from(self.state):
            if edge.when(view) and (self._stands is None or not _by_signs(edge, view)):
                return edge
        return None

    def _waiting(self) -> tuple[Edge, Event | None] | None:
        """The edge that a held machine would take, and the event that it needs."""
        for event in self._held:
            edge = self._edge(event)
            if edge is not None:
                return edge, (None if edge is self._edge(None) else event)
        edge = self._edge(None)
        return None if edge is None else (edge, None)

    def _edge_to(self, to: str) -> Edge:
        for edge in edges_from(self.state):
            if to == edge.outcome:
                return edge
        if to == self.state.value:
            raise ValueError(f"it is {to} already")
        if to not in {state.value for state in State}:
            leave = ", ".join(dict.fromkeys(edge.outcome for edge in edges_from(self.state)))
            raise ValueError(
                f"{to!r} is neither a state nor an outcome of {self.state.value}"
                + (f" ({leave})" if leave else "")
            )
        target = State(to)
        known = (edge for edge in edges_from(self.state) if edge.target is target)
        beyond = Edge(self.state, target, "forced", lambda _: True, "{reason}")
        return next(known, beyond)

    def _take(self, edge: Edge, event: Event | None, by_hand: str = "") -> Change:
        forced = bool(by_hand) or self._rests_on_wizard(edge, event)
        why = self.reason if by_hand.startswith("forced") else edge.why.format(reason=self.reason)
        self.state = edge.target
        self.since = self._time.now
        self._trail.append(edge.target.value)
        self._stands = None
        self._enter(edge)
        return Change(
            t=self._time.stamp(self.since),
            was=edge.source.value,
            now=edge.target.value,
            outcome=edge.outcome,
            why=by_hand + why,
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
            self._told = ""
        if edge.target in (State.WAIT, State.UNKNOWN):
            self.visitor = self._told or (self._identity.known and self._identity.name_given) or ""
        self.attempt = self._failed + 1 if edge.target is State.HANDSHAKE else 0

    def _rests_on_wizard(self, edge: Edge, event: Event | None) -> bool:
        if not _by_signs(edge, self._view(event)):
            return False
        presence = edge.outcome in ("human_presence", "human_absence")
        signs = self._uses
        if presence and "presence" in self.settings.signs:
            signs = [self._signs["presence"]]
        named = edge.outcome in ("recognized", "unrecognized")
        return any(sign.forced is not None for sign in signs) or (
            named and self._identity.forced is not None
        )

    def _deadlines(self) -> Iterator[int]:
        for sign in (*self._signs.values(), self._identity):
            if not sign.stale:
                yield sign.heard_at + sign.stale_after + 1
        yield from (sign.heard_at + FRESH + 1 for sign in self._uses)
        ends = self.voice.ends_at()
        if ends is not None:
            yield ends
        timeouts = self.settings.timeouts
        limit: float | None = getattr(timeouts, _LIMITS.get(self.state, ""), None)
        if limit is not None:
            yield self.since + microseconds(limit)
        if self.state is State.HANDSHAKE:
            yield self.since + microseconds(self.settings.handshake.seconds)
        if not self._engaged:
            yield self._turned + microseconds(timeouts.lost)
        elif not self.known:
            yield self._nameless_since + microseconds(timeouts.unrecognized)


def _by_signs(edge: Edge, view: View) -> bool:
    """Whether an edge that holds does so by the signs alone: without event, without time limit."""
    return edge.when(replace(view, event=None, elapsed=0.0))


def _verdict(sign: str, value: object | None) -> float | bool | None:
    if value is None or isinstance(value, bool):
        return value
    number = samples.number(value)
    if sign == "distance":
        if number is None or not number > 0.0:
            raise ValueError(f"{value!r} is no distance: a number of metres, on or off")
        return number
    if number not in (0.0, 1.0):
        raise ValueError(f"{value!r} is no verdict on {sign}: on or off")
    return bool(number)


def _name(value: object | None, name: str) -> str | None:
    if value is None and not name:
        return None
    found = samples.name(value if isinstance(value, str) else "", name)
    if found is None:
        raise ValueError(f"{value!r} is no name of a visitor")
    return found


def _check(sign: str, kind: str | None, count: int | None, threshold: float | None) -> None:
    if sign not in SIGNS:
        raise ValueError(f"{sign!r} is none of {', '.join(SIGNS)}")
    if kind is not None and kind not in FILTERS:
        raise ValueError(f"{kind!r} is none of {', '.join(FILTERS)}")
    if kind == "median" and sign != "distance":
        raise ValueError(f"a median is for distance, not for {sign}")
    if count is not None and not 1 <= count <= 1000:
        raise ValueError(f"{count} is not 1 to 1000 places")
    if threshold is not None and not 0 <= threshold <= 1:
        raise ValueError(f"{threshold:g} is not 0 to 1")
