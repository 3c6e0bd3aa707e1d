"""The one thread that owns the port: it opens it, keeps the rate, and opens it again.

The asyncio side never touches a port or a servo. It hands in functions (`ask`, `tell`), which run
in the thread between two ticks, at once if it is asleep.
"""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, TypeVar

from woz_drivers.dynamixel.body_following import BodyFollower
from woz_drivers.dynamixel.chain import ServoChain
from woz_drivers.dynamixel.port import ServoPort
from woz_drivers.dynamixel.servo import ServoStatus
from woz_drivers.dynamixel.servo_health import report, unable_verbs
from woz_drivers.dynamixel.settings import ServoSettings
from woz_drivers.dynamixel.wire import ServoWire
from woz_tui.drivers.contract import DeviceLostError, DriverContext, Health

#: A missing port is looked for so often, in seconds.
LOOK_S = 0.5
#: Readings of positions and setpoints go out so often, in seconds.
READING_S = 0.1

log = logging.getLogger(__name__)

T = TypeVar("T")
Action = Callable[[ServoChain, float], T]


class ServoLoop:
    """Runs a chain at its rate in a thread of its own, through losses of the port."""

    def __init__(self, name: str, settings: ServoSettings, context: DriverContext) -> None:
        self.ticks = 0
        #: Whether servos answer now, and whether any held its joint when they last did.
        self.online = False
        self.holding = False
        #: The stop is pressed: no torque goes on by itself.
        self.stopped = False
        self._settings = settings
        self._context = context
        self.following = BodyFollower(settings, context) if settings.follows else None
        self._requests: queue.SimpleQueue[tuple[Action[Any], Future[Any]]] = queue.SimpleQueue()
        self._wake = threading.Event()
        self._closing = False
        self._first = True
        #: Nothing is handed in any more once `_ended` is set; `_door` guards it.
        self._ended = False
        self._door = threading.Lock()
        self._lost = DeviceLostError(f"{settings.port} has not been opened yet", "wait a moment")
        self._thread = threading.Thread(target=self._run, name=f"servos {name}", daemon=True)

    # -- from the asyncio side -------------------------------------------------------------------

    def start(self) -> None:
        """Begin to look for the port; returns at once."""
        self._context.health(Health.CONNECTING, f"looking for {self._settings.port}")
        self._thread.start()

    def ask(self, action: Action[T]) -> Future[T]:
        """Run `action(chain, now)` in the thread; the future raises `DeviceLostError` without a
        line.
        """
        future: Future[T] = Future()
        with self._door:
            if self._ended:
                future.set_exception(DeviceLostError("the servo driver is closed"))
                return future
            self._requests.put((action, future))
        self._wake.set()
        return future

    def close(self, timeout: float) -> bool:
        """End the thread and let go of the port; says whether it ended within `timeout` seconds."""
        self._closing = True
        self._wake.set()
        if self._thread.ident is None:
            return True
        self._thread.join(timeout)
        return not self._thread.is_alive()

    # -- the thread --------------------------------------------------------------------------------

    def _run(self) -> None:
        while not self._closing:
            try:
                self._session()
            except DeviceLostError as lost:
                self._lost = lost
                self._context.health(Health.LOST, lost.what, lost.remedy)
                if self.following is not None:
                    joints = self._settings.joints
                    self.following.publish_lost(joints, lost, time.monotonic())
            except Exception as error:  # the thread must outlive its own mistakes
                log.exception("the servo loop failed")
                self._lost = DeviceLostError(
                    f"the servo driver failed: {error!r}", "report this error and attach the log"
                )
                self._context.health(Health.FAULTED, self._lost.what, self._lost.remedy)
            self._wait_offline()
        with self._door:
            self._ended = True
        self._refuse_requests(DeviceLostError("the servo driver is closed"))

    def _session(self) -> None:
        """One opening of the port, until it is lost or the driver closes."""
        settings = self._settings
        port = ServoPort(settings.port, settings.baud, settings.reply_timeout)
        port.open()
        wire = ServoWire(port, settings.protocol)
        chain = ServoChain(wire, settings, self._context, self.following)
        try:
            chain.connect()
            self._begin(chain)
            self.online = True
            self._keep_rate(chain)
        except DeviceLostError as lost:
            chain.fail_all(lost)
            raise
        finally:
            if self.online:
                self.holding = any(servo.torque for servo in chain.servos.values())
            self.online = False
            if self.following is not None:
                self.following.publish_positions((), time.monotonic())
            chain.fail_all(DeviceLostError("the servo driver let go of the port"))
            wire.close()

    def _begin(self, chain: ServoChain) -> None:
        first, self._first = self._first, False
        wanted = first and self._settings.torque
        if wanted:
            # Before the stop is looked at: whoever presses it from here on waits for the servos.
            self.holding = True
            for servo in chain.servos.values():
                if servo.status is ServoStatus.READY and not self.stopped:
                    for name, why in chain.set_torque([servo.name], on=True).items():
                        text = f"no torque on {name}: it {why.what}"
                        self._context.notice("error", text, why.remedy)
        ready = [one for one in chain.servos.values() if one.status is ServoStatus.READY]
        limp = [one.name for one in ready if not one.torque]
        if (wanted or not first) and limp:
            which = "" if len(limp) == len(ready) else f" on {', '.join(limp)}"
            self._context.notice(
                "info",
                f"servos connected; torque is off{which}",
                "make sure that nobody is in reach, then `torque: on`",
            )

    def _keep_rate(self, chain: ServoChain) -> None:
        period = 1.0 / self._settings.rate
        due = time.monotonic()
        next_reading = due
        while not self._closing:
            now = time.monotonic()
            if now >= due:
                chain.tick(now)
                self.ticks += 1
                # A tick missed altogether is not made up for: setpoints go by the clock.
                due = max(due + period, now)
            if now >= next_reading:
                next_reading = now + READING_S
                self._publish(chain)
            self._wake.wait(max(0.0, due - time.monotonic()))
            self._wake.clear()
            self._serve(chain)

    def _serve(self, chain: ServoChain) -> None:
        while True:
            try:
                action, future = self._requests.get_nowait()
            except queue.Empty:
                return
            if not future.set_running_or_notify_cancel():
                continue
            try:
                result = action(chain, time.monotonic())
            except DeviceLostError as lost:
                future.set_exception(lost)
                raise
            except Exception as error:  # noqa: BLE001 - it belongs to whoever asked
                future.set_exception(error)
            else:
                future.set_result(result)

    def _publish(self, chain: ServoChain) -> None:
        self._context.health(*report(self._settings, chain.servos.values()))
        self._context.unable(*unable_verbs(self._settings, chain.servos.values()))
        for servo in chain.servos.values():
            if servo.status is ServoStatus.READY:
                # In a body's degrees, so that it can be held against the body's setpoint.
                zero = self.following.zero(servo.name) if self.following is not None else 0.0
                present = round(servo.present - zero, 3)
                self._context.reading(f"joint.{servo.name}", present, unit="deg")
                if self.following is None:  # else the body tells them
                    self._context.reading(
                        f"setpoint.{servo.name}", round(servo.setpoint, 3), unit="deg"
                    )

    def _wait_offline(self) -> None:
        until = time.monotonic() + LOOK_S
        while not self._closing and (left := until - time.monotonic()) > 0:
            self._wake.wait(left)
            self._wake.clear()
            self._refuse_requests(self._lost)

    def _refuse_requests(self, lost: DeviceLostError) -> None:
        while True:
            try:
                _, future = self._requests.get_nowait()
            except queue.Empty:
                return
            if future.set_running_or_notify_cancel():
                future.set_exception(lost)
