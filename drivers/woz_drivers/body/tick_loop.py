"""What happens at each tick: look at servos and camera, ask the engine, hand on what it says.

Inputs come from the event loop at any time and go into the engine at once, under the one lock that
a tick holds only while it computes.
"""

from __future__ import annotations

import functools
import logging
import threading
import time
from array import array
from collections.abc import Callable, Mapping
from concurrent.futures import Future

from woz_drivers.body.servo_feedback import FRESH_S, MotionWatch, ServoFeedback
from woz_drivers.body.settings import BodySettings
from woz_tui.drivers.contract import Ask, DriverContext, DriverError, Health
from woz_tui.motion.body_feeds import (
    FACE,
    PRESENT,
    SEEN,
    SETPOINTS,
    STATE,
    VOICE,
    BodyState,
    FacePicture,
    JointPositions,
    Setpoints,
    Sighting,
    VoiceLevels,
)
from woz_tui.motion.engine import Engine
from woz_tui.motion.engine_io import EndedInput, InputResult, Tick
from woz_tui.motion.light_frames import LightFrame
from woz_tui.motion.modes import Mode, Operator
from woz_tui.motion.move_types import Move, SoundCue
from woz_tui.protocol.messages import BodyChanged, FaceShown, Json
from woz_tui.system.rate_limit import RateLimit

# -- lateness -------------------------------------------------------------------------------------
# How punctual ticks were, counted without keeping them.

#: Width of a bin in milliseconds, and how many there are; later ticks share the last one.
BIN_MS = 0.05
BINS = 4000


class Lateness:
    """A histogram of milliseconds, cheap enough for every tick of a long session.

    Attributes:
        ticks: How many were counted.
        missed: Ticks that were left out because the one before came too late.
        worst: The latest tick, in milliseconds.
    """

    def __init__(self) -> None:
        self.ticks = 0
        self.missed = 0
        self.worst = 0.0
        self._bins = array("L", [0]) * BINS
        self._recent = 0.0

    def count(self, late_ms: float, missed: int = 0) -> None:
        """A tick came `late_ms` after its time, and `missed` were left out before it."""
        self.ticks += 1
        self.missed += missed
        self.worst = max(self.worst, late_ms)
        self._recent = max(self._recent, late_ms)
        self._bins[min(max(int(late_ms / BIN_MS), 0), BINS - 1)] += 1

    def quantile(self, share: float) -> float:
        """Milliseconds that at least `share` (0..1) of the ticks kept to; 0 without any."""
        left = share * self.ticks
        for index, number in enumerate(self._bins):
            left -= number
            if left <= 0 and number:
                return min((index + 1) * BIN_MS, self.worst)
        return self.worst

    def recent(self) -> float:
        """The latest tick, in milliseconds, since this was last asked."""
        recent, self._recent = self._recent, 0.0
        return recent

    def __str__(self) -> str:
        return (
            f"{self.ticks} ticks, late by {self.quantile(0.5):.2f} ms (half of them),"
            f" {self.quantile(0.99):.2f} ms (99 %), {self.worst:.1f} ms (the latest);"
            f" {self.missed} left out"
        )


# --------------------------------------------------------------------------------------------------

log = logging.getLogger(__name__)

#: Does what is due at a moment, in seconds of CLOCK_MONOTONIC.
Step = Callable[[float], None]


class ThreadTicker:
    """Ticks in a thread of its own, at absolute deadlines of CLOCK_MONOTONIC.

    A late tick does not push the next ones back, and ticks that were missed altogether are not made
    up for: whoever ticks goes by the time, not by the number of ticks.

    The interpreter's switch interval stays as it is. It belongs to the whole process, and 0.5 ms in
    place of 5 ms made no difference that stood out from one run of `benchmarks/motion_rate.py` to
    the next: the event loop hardly ever computes for as long as that.
    """

    def __init__(self, rate: float, name: str) -> None:
        self.lateness = Lateness()
        self._period = 1.0 / rate
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"body {name}", daemon=True)
        self._step: Step = lambda now: None

    def start(self, step: Step) -> None:
        """Begin to call `step`."""
        self._step = step
        self._thread.start()

    def end(self) -> None:
        """Let the thread end; one that waits wakes up for it."""
        self._closing.set()

    @property
    def ended(self) -> bool:
        """Whether the thread is not there, or no more."""
        return not self._thread.is_alive()

    def _run(self) -> None:
        due = time.monotonic()
        while not self._closing.wait(max(0.0, due - time.monotonic())):
            now = time.monotonic()
            if now < due:  # a wait may end a moment early
                continue
            late = now - due
            missed = int(late / self._period)
            self.lateness.count(late * 1000, missed)
            try:
                self._step(now)
            except Exception:  # the thread must outlive whatever a tick meets
                log.exception("a tick failed")
            due += (1 + missed) * self._period


# -- joining --------------------------------------------------------------------------------------
# Where the joints really are before servos hold them.

#: A hand has moved a limp joint when it is so many degrees from where it was last found.
MOVED = 2.0
#: So long after an input the body goes by what was asked of it, in seconds.
BUSY_S = 3.0


class LimpJointWatch:
    """Finds out when the engine must begin anew at the pose in which the servos are.

    While no joint is held, hands may move them; the engine then goes on from where they were left.
    What is asked of the body in the meantime, to rehearse it, is not disturbed.
    """

    def __init__(self, settings: BodySettings, context: DriverContext) -> None:
        self._zero = {name: joint.zero for name, joint in settings.joints.items()}
        self._feed = context.feed(PRESENT, of=settings.servos)
        self._serial = 0
        self._found: Mapping[str, float] = {}
        self._busy_until = float("-inf")

    def touched(self, now: float) -> None:
        """An input has come: ignore hands for a while."""
        self._busy_until = now + BUSY_S

    def place(self, now: float, state: BodyState) -> Mapping[str, float] | None:
        """The joints' angles, in the body's degrees, if the engine is to begin at them."""
        newest = self._feed.latest()
        present = newest.value
        if newest.serial == self._serial or not isinstance(present, JointPositions):
            return None
        self._serial = newest.serial
        if now - present.t_us / 1e6 > FRESH_S:
            return None
        joints = {
            name: angle - self._zero[name]
            for name, angle in present.joints.items()
            if name in self._zero
        }
        busy = now < self._busy_until or state.move or state.mode != Mode.NORMAL.value
        if present.held or busy or not self._moved(joints):
            return None
        self._found = {**self._found, **joints}
        return joints

    def _moved(self, joints: Mapping[str, float]) -> bool:
        return any(
            name not in self._found or abs(angle - self._found[name]) > MOVED
            for name, angle in joints.items()
        )


# -- publishing -----------------------------------------------------------------------------------
# What a body tells of its ticks: often enough to be seen, seldom enough to be read.

#: Least seconds between two readings of a joint, two faces, two descriptions of the body.
READING_S, FACE_S, VALUES_S = 0.1, 0.04, 0.2
#: Every so many seconds the latest tick is told.
PUNCTUAL_S = 1.0
#: Deadlines may be met a moment early: ticks do not come at even times.
SLACK_S = 0.002


_limit = functools.partial(RateLimit, slack=SLACK_S)


class TickPublisher:
    """Belongs to the ticking thread."""

    def __init__(self, settings: BodySettings, context: DriverContext) -> None:
        self._context = context
        self._alone = not settings.servos
        self._readings, self._faces = _limit(READING_S), _limit(FACE_S)
        #: When it is time to look at the body's values again, and to say how punctual ticks are.
        self.values_due, self.lateness_due = _limit(VALUES_S), _limit(PUNCTUAL_S)
        self._face: tuple[LightFrame, str, float, float] | None = None
        self._values: Mapping[str, Json] | None = None
        self._unheard: set[str] = set()

    def tick(self, tick: Tick) -> None:
        """Everything but the body's values."""
        for notice in tick.notices:
            self._context.notice("info", notice, tells=("request",))
        self._context.mode(tick.mode.value, tick.notices[0] if tick.notices else "")
        for cue in tick.cues:
            self._sound(cue)
        self._show_face(tick)
        if self._readings(tick.t):
            for name, angle in tick.wanted.items():
                self._context.reading(f"setpoint.{name}", round(angle, 3), unit="deg")
            if self._alone:
                for name, angle in tick.joints.items():
                    self._context.reading(f"joint.{name}", round(angle, 3), unit="deg")

    def values(self, values: Mapping[str, Json]) -> None:
        """Say how the body is, if it is otherwise than before."""
        if values != self._values:
            self._values = values
            self._context.show(BodyChanged(values=dict(values)))

    def lateness(self, late_ms: float) -> None:
        """The latest tick of the last second."""
        self._context.reading("tick", round(late_ms, 3), unit="ms")

    def _show_face(self, tick: Tick) -> None:
        if tick.face is None:
            return
        face = (tick.face, tick.emotion, round(tick.intensity, 3), round(tick.brightness, 3))
        if face != self._face and self._faces(tick.t):
            self._face = face
            self._context.show(
                FaceShown(
                    width=tick.face.width,
                    rows=tick.face.hex,
                    emotion=face[1],
                    intensity=face[2],
                    brightness=face[3],
                )
            )

    def _sound(self, cue: SoundCue) -> None:
        if not cue.sound or cue.volume <= 0:
            return

        def heard(carried: bool, why: str) -> None:
            if not carried and why not in self._unheard:
                self._unheard.add(why)
                text = f"the sound {cue.sound} was not played: {why}"
                self._context.notice("warning", text, tells=("request",))

        self._context.ask(Ask("verb", "sound", {"file": cue.sound}, source="body"), heard)


# --------------------------------------------------------------------------------------------------

#: What the camera said counts for so long, in seconds.
SEEN_S = 1.0
#: Panels are told so often where the controls stand, and right after every input.
STATE_S = 0.1
#: So often it is said whether the servos can move the joints.
UNABLE_S = 0.2

log = logging.getLogger(__name__)


class BodyLoop:
    """An engine, its inputs and its feeds.

    Args:
        settings: The body.
        context: Whom to tell.
        lateness: How punctual the ticks are; told once a second.
        on_ended: Called in the ticking thread with inputs that are over.
        on_stroke: Called there with the token of a move that comes to its stroke.
    """

    def __init__(
        self,
        settings: BodySettings,
        context: DriverContext,
        lateness: Lateness,
        on_ended: Callable[[tuple[EndedInput, ...]], None],
        on_stroke: Callable[[int], None] = lambda token: None,
    ) -> None:
        #: What it can play now.
        self.moves = settings.repertoire.moves
        self.engine = Engine(settings, self.moves, seed=settings.seed)
        #: Said to the servos, which let go only then: see `Setpoints`.
        self.at_rest: bool | None = None
        self._context = context
        self._lateness = lateness
        self._on_ended = on_ended
        self._on_stroke = on_stroke
        self._publishing = TickPublisher(settings, context)
        self._joining = LimpJointWatch(settings, context) if settings.servos else None
        #: What servos show; None: there are none.
        self.feedback = ServoFeedback(settings, context) if settings.servos else None
        #: Of the motions under way; from the event loop.
        self.watches: tuple[MotionWatch, ...] = ()
        self._unable_due = _limit(UNABLE_S)
        self._zero = {name: joint.zero for name, joint in settings.joints.items()}
        self._detail = _detail(settings)
        self._lock = threading.Lock()
        self._waiting: list[Future[None]] = []
        self._state_due = _limit(STATE_S)
        self._touched = False
        self._setpoints, self._face = context.feed(SETPOINTS), context.feed(FACE)
        self._state = context.feed(STATE)
        self._seen = context.feed(SEEN, of=settings.camera) if settings.camera else None
        self._voice = context.feed(VOICE, of=settings.voice) if settings.voice else None
        self._seen_serial = 0
        self._sighting_known = False
        self._lit: FacePicture | None = None

    # -- from the event loop ---------------------------------------------------------------------

    def apply(self, verb: str, args: Mapping[str, Json], hand: Operator) -> InputResult:
        """Give the engine an input. Raises `RejectedError`."""
        with self._lock:
            self._touched = True
            return self.engine.apply(verb, args, hand)

    def predict(self, verb: str, args: Mapping[str, Json]) -> InputResult:
        """How many seconds an input would take now, and when its stroke would come. Raises
        `RejectedError`.
        """
        with self._lock:
            return self.engine.predict(verb, args)

    def set_moves(self, moves: Mapping[str, Move]) -> None:
        """Play these moves from now on; one under way goes on as it began."""
        with self._lock:
            self.moves = moves
            self.engine.set_moves(moves)

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
            self._context.health(
                Health.FAULTED, f"a tick failed: {error!r}", "report this error and attach the log"
            )
        else:
            self._context.health(Health.CONNECTED, self._detail)
        for future in waiting:
            if not future.set_running_or_notify_cancel():
                continue  # the tick came so late that nobody waits for this one any more
            if failure is None:
                future.set_result(None)
            else:
                future.set_exception(failure)

    def _step(self, now: float) -> None:
        with self._lock:
            self._read_feeds(now)
            tick = self.engine.tick(now)
            state = None
            if self._touched or tick.ended or self._state_due(now):
                self._touched = False
                state = self.engine.state()
            values = self.engine.values() if self._publishing.values_due(now) else None
        self._setpoints.put(
            Setpoints(
                round(now * 1e6),
                {name: angle + self._zero[name] for name, angle in tick.joints.items()},
                self._zero,
                self.at_rest,
            )
        )
        for watch in self.watches:
            watch.tick(now, tick.joints)
        if self.feedback is not None and self._unable_due(now):
            self._context.unable(*self.feedback.unable(now))
        self._publish_face(tick)
        if state is not None:
            self._state.put(state)
        if tick.stroke:
            self._on_stroke(tick.stroke)
        if tick.ended:
            self._on_ended(tick.ended)
        self._publishing.tick(tick)
        if values is not None:
            self._publishing.values(values)
        if self._publishing.lateness_due(now):
            self._publishing.lateness(self._lateness.recent())

    def _read_feeds(self, now: float) -> None:
        """Take what servos, voice and camera say."""
        if self._joining is not None:
            if self._touched:
                self._joining.touched(now)
            place = self._joining.place(now, self.engine.state())
            if place is not None:
                self.engine.restart(place)
        if self._voice is not None:
            voice = self._voice.latest().value
            self.engine.speak(voice.at(now) if isinstance(voice, VoiceLevels) else 0.0)
        if self._seen is None:
            return
        newest = self._seen.latest()
        seen = newest.value
        fresh = isinstance(seen, Sighting) and now - seen.t_us / 1e6 <= SEEN_S
        if fresh and newest.serial != self._seen_serial:
            self._seen_serial, self._sighting_known = newest.serial, True
            self.engine.see(seen)
        elif not fresh and self._sighting_known:
            self._sighting_known = False
            self.engine.see(None)

    def _publish_face(self, tick: Tick) -> None:
        """Hand the face on, if it is another one than before."""
        if tick.face is None:
            return
        lit = FacePicture(tick.face, tick.brightness)
        if lit != self._lit:
            self._lit = lit
            self._face.put(lit)


def _detail(settings: BodySettings) -> str:
    joints = "1 joint" if len(settings.joints) == 1 else f"{len(settings.joints)} joints"
    moved = f"moved by {settings.servos}" if settings.servos else "without servos"
    return f"{joints} at {settings.rate:g} Hz, {moved}"
