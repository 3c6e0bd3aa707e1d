"""What happens at each tick: look at servos and camera, ask the engine, hand on what it says.

Inputs come from the event loop at any time and go into the engine at once, under the one lock that
a tick holds only while it computes.
"""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import Future

from woz_drivers.body.joining import Joining
from woz_drivers.body.lateness import Lateness
from woz_drivers.body.publishing import Due, Publishing
from woz_drivers.body.settings import Settings
from woz_tui.core.driver import DriverError, Health, Outlet
from woz_tui.core.messages import Json
from woz_tui.motion.engine import Engine
from woz_tui.motion.modes import Hand
from woz_tui.motion.move import Move
from woz_tui.motion.setpoints import FACE, SEEN, SETPOINTS, STATE, Lit, Seen, Setpoints
from woz_tui.motion.ticks import Answer, Ended, Tick

#: What the camera said counts for so long, in seconds.
SEEN_S = 1.0
#: Panels are told so often where the controls stand, and right after every input.
STATE_S = 0.1

log = logging.getLogger(__name__)


class BodyLoop:
    """An engine, its inputs and its feeds.

    Args:
        settings: The body.
        outlet: Whom to tell.
        lateness: How punctual the ticks are; told once a second.
        on_ended: Called in the ticking thread with inputs that are over.
    """

    def __init__(
        self,
        settings: Settings,
        outlet: Outlet,
        lateness: Lateness,
        on_ended: Callable[[tuple[Ended, ...]], None],
    ) -> None:
        #: What it can play now.
        self.moves = settings.repertoire.moves
        self.engine = Engine(settings, self.moves, seed=settings.seed)
        #: Said to the servos, which let go only then: see `Setpoints`.
        self.at_rest: bool | None = None
        self._outlet = outlet
        self._lateness = lateness
        self._on_ended = on_ended
        self._publishing = Publishing(settings, outlet)
        self._joining = Joining(settings, outlet) if settings.servos else None
        self._zero = {name: joint.zero for name, joint in settings.joints.items()}
        self._detail = _detail(settings)
        self._lock = threading.Lock()
        self._waiting: list[Future[None]] = []
        self._state_due = Due(STATE_S)
        self._touched = False
        self._setpoints, self._face = outlet.feed(SETPOINTS), outlet.feed(FACE)
        self._state = outlet.feed(STATE)
        self._seen = outlet.feed(SEEN, of=settings.camera) if settings.camera else None
        self._seen_serial = 0
        self._sees = False
        self._lit: Lit | None = None

    # -- from the event loop ---------------------------------------------------------------------

    def apply(self, verb: str, args: Mapping[str, Json], hand: Hand) -> Answer:
        """Give the engine an input. Raises `ticks.Refused`."""
        with self._lock:
            self._touched = True
            return self.engine.apply(verb, args, hand)

    def learn(self, moves: Mapping[str, Move]) -> None:
        """Play these moves from now on; one under way goes on as it began."""
        with self._lock:
            self.moves = moves
            self.engine.learn(moves)

    def drop(self, token: int) -> None:
        """End an input that takes time where it is now."""
        with self._lock:
            self.engine.drop(token)

    def freeze(self) -> Future[None]:
        """Stand still; the future is done when the servos have been given those setpoints."""
        done: Future[None] = Future()
        with self._lock:
            self.engine.freeze()
            self._touched = True
            self._waiting.append(done)
        return done

    def resume(self) -> None:
        """The stop was released."""
        with self._lock:
            self.engine.resume()
            self._touched = True

    # -- at each tick ----------------------------------------------------------------------------

    def step(self, now: float) -> None:
        """One tick at `now`, in seconds of CLOCK_MONOTONIC. Never raises."""
        with self._lock:
            waiting, self._waiting = self._waiting, []
        failure: DriverError | None = None
        try:
            self._step(now)
        except Exception as error:  # whatever it was, the next tick may be better
            log.exception("the body's tick failed")
            failure = DriverError(f"the body's tick failed: {error!r}")
            self._outlet.health(
                Health.FAULTED, f"a tick failed: {error!r}", "report this, with the log"
            )
        else:
            self._outlet.health(Health.CONNECTED, self._detail)
        for future in waiting:
            if not future.set_running_or_notify_cancel():
                continue  # the tick came so late that nobody waits for this one any more
            if failure is None:
                future.set_result(None)
            else:
                future.set_exception(failure)

    def _step(self, now: float) -> None:
        with self._lock:
            self._look(now)
            tick = self.engine.tick(now)
            state = None
            if self._touched or tick.ended or self._state_due(now):
                self._touched = False
                state = self.engine.state()
            values = self.engine.values() if self._publishing.wants_values(now) else None
        self._setpoints.put(
            Setpoints(
                round(now * 1e6),
                {name: angle + self._zero[name] for name, angle in tick.joints.items()},
                self._zero,
                self.at_rest,
            )
        )
        self._light(tick)
        if state is not None:
            self._state.put(state)
        if tick.ended:
            self._on_ended(tick.ended)
        self._publishing.tick(tick)
        if values is not None:
            self._publishing.values(values)
        if self._publishing.wants_lateness(now):
            self._publishing.lateness(self._lateness.recent())

    def _look(self, now: float) -> None:
        """Take what servos and camera say."""
        if self._joining is not None:
            if self._touched:
                self._joining.touched(now)
            place = self._joining.place(now, self.engine.state())
            if place is not None:
                self.engine.restart(place)
        if self._seen is None:
            return
        newest = self._seen.latest()
        seen = newest.value
        fresh = isinstance(seen, Seen) and now - seen.t_us / 1e6 <= SEEN_S
        if fresh and newest.serial != self._seen_serial:
            self._seen_serial, self._sees = newest.serial, True
            self.engine.see(seen)
        elif not fresh and self._sees:
            self._sees = False
            self.engine.see(None)

    def _light(self, tick: Tick) -> None:
        """Hand the face on, if it is another one than before."""
        if tick.face is None:
            return
        lit = Lit(tick.face, tick.brightness)
        if lit != self._lit:
            self._lit = lit
            self._face.put(lit)


def _detail(settings: Settings) -> str:
    joints = "1 joint" if len(settings.joints) == 1 else f"{len(settings.joints)} joints"
    moved = f"moved by {settings.servos}" if settings.servos else "without servos"
    return f"{joints} at {settings.rate:g} Hz, {moved}"
