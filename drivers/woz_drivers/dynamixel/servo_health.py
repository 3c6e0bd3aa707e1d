"""Looking after servos once a second, one question a tick: alarms, torque, heat, load, voltage."""

from __future__ import annotations

import abc
from collections import Counter, deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from woz_drivers.dynamixel import control_tables
from woz_drivers.dynamixel import servo as servos
from woz_drivers.dynamixel.servo import Servo, ServoStatus, SilentError, UnfitError
from woz_drivers.dynamixel.settings import ServoSettings
from woz_drivers.dynamixel.verbs import POWER, servo_verbs
from woz_drivers.dynamixel.wire import ServoAnswer, ServoWire
from woz_tui.drivers.contract import DriverContext, Health

#: Every servo is looked after once in so many seconds.
ROUND_S = 1.0
#: A warning is repeated only after the value has fallen back by this share of its limit.
EASING = 0.05

POWER_REMEDY = (
    "check its power supply and plugs, make sure that nobody is in reach, then `torque: on`"
)


@dataclass(frozen=True, slots=True)
class WarningLimit:
    """A value worth a warning on one `side` of `limit`: above or below."""

    limit: float
    side: str

    def beyond(self, value: float) -> float:
        """How far the value is beyond the limit; negative: how far it is from it."""
        return value - self.limit if self.side == "above" else self.limit - value


class ServoUpkeep(abc.ABC):
    """The servos of a chain, and the chores that look after them; belongs to the loop's thread."""

    def __init__(self, wire: ServoWire, settings: ServoSettings, context: DriverContext) -> None:
        self.wire = wire
        self.settings = settings
        self.servos = {name: Servo(name, joint) for name, joint in settings.joints.items()}
        self._context = context
        self._chores: deque[tuple[Callable[[Servo], None], Servo]] = deque()
        self._next_round = 0.0
        self._warned: set[tuple[str, str, str]] = set()
        bounds = (
            ("temperature", settings.temperature_warning, "above"),
            ("load", settings.load_warning, "above"),
            ("voltage", settings.voltage_low, "below"),
            ("voltage", settings.voltage_high, "above"),
        )
        self._bounds = [
            (kind, WarningLimit(limit, side)) for kind, limit, side in bounds if limit is not None
        ]

    @abc.abstractmethod
    def let_go(self, servo: Servo, why: str) -> None:
        """A joint cannot take part any more: it lost its torque or stopped by itself."""

    def one_chore(self, now: float) -> None:
        """Ask one servo one thing, if it is time; a round takes two ticks a servo."""
        if not self._chores and now >= self._next_round:
            self._next_round = now + ROUND_S
            for servo in self.servos.values():
                if servo.status is ServoStatus.READY:
                    self._chores += ((self._status, servo), (self._sensors, servo))
        if self._chores:
            chore, servo = self._chores.popleft()
            chore(servo)

    # -- alarms, torque, watchdog --------------------------------------------------------------

    def _status(self, servo: Servo) -> None:
        if servo.status is not ServoStatus.READY or servo.model is None:
            return
        table = servo.model.table
        answer = self.wire.read(servo.joint.id, table.status_block())
        if answer is None:
            return
        self._alarms(servo, table, answer)
        self.check_torque(servo, table, answer)
        if table.watchdog is not None:
            self._watchdog(servo, table.watchdog.within(table.status_block(), answer.data))

    def check_torque(
        self, servo: Servo, table: control_tables.ControlTable, status: ServoAnswer
    ) -> None:
        """Compare the torque with what it should be: off by itself, or on without a command."""
        if servo.torque and not servos.still_holds(servo, table, status.data):
            self._alarms(servo, table, status)
            self._went_limp(servo)
        if not servo.torque and servos.torque_enabled(table, status.data):
            self.wire.write(servo.joint.id, table.torque, 0)  # unanswered: the next look finds it

    def _alarms(
        self, servo: Servo, table: control_tables.ControlTable, status: ServoAnswer
    ) -> None:
        block = table.status_block()
        bits = status.error if table.alarm is None else table.alarm.within(block, status.data)
        alarms = tuple(control_tables.alarms(table, bits))
        if alarms == servo.alarms:
            return
        servo.alarms = alarms
        if alarms:
            remedy = servos.alarm_remedy(servo)
            self._context.notice("error", f"{servo.label}: {', '.join(alarms)}", remedy)
        else:
            self._context.notice("info", f"{servo.label}: the alarm is over")

    def _went_limp(self, servo: Servo) -> None:
        servo.torque = False
        why = f"lost its torque ({', '.join(servo.alarms) or 'it may have restarted'})"
        self.let_go(servo, why)
        remedy = servos.alarm_remedy(servo) if servo.alarms else POWER_REMEDY
        self._context.notice("error", f"{servo.label} {why}", remedy)

    def _watchdog(self, servo: Servo, value: int) -> None:
        """Clear it if it bit; set it again also where that was cut short the last time."""
        if value == servos.watchdog_units(self.settings.watchdog):
            return
        assert servo.model is not None
        bitten = value == control_tables.WATCHDOG_BITTEN
        if bitten:
            self.let_go(servo, "stopped by itself: its bus watchdog bit")
        try:
            line = servos.ServoRegisters(self.wire, servo.joint.id, servo.model.table)
            servos.rearm(line, self.settings.watchdog)
        except (SilentError, UnfitError):
            return  # the next round finds it again
        finally:
            servo.written = None
        if bitten:
            self._context.notice(
                "warning",
                f"{servo.label} stopped by itself: it received nothing for"
                f" {self.settings.watchdog} ms",
                "the computer was too busy; close other programs, or raise `watchdog`",
            )

    # -- heat, load, voltage -------------------------------------------------------------------

    def _sensors(self, servo: Servo) -> None:
        if servo.status is not ServoStatus.READY or servo.model is None:
            return
        table = servo.model.table
        block = table.sensor_block()
        answer = self.wire.read(servo.joint.id, block)
        if answer is None:
            return
        heat = table.temperature.within(block, answer.data)
        volt = table.voltage.within(block, answer.data)
        load = signed_load(table, table.load.within(block, answer.data))
        self._publish(servo, "temperature", float(heat), "C", heat)
        self._publish(servo, "voltage", volt * control_tables.VOLT, "V", volt)
        self._publish(servo, "load", 100.0 * abs(load) / servo.model.full_load, "%", load)

    def _publish(self, servo: Servo, kind: str, value: float, unit: str, raw: int) -> None:
        self._context.reading(f"{kind}.{servo.name}", round(value, 2), unit=unit, raw=raw)
        for bound in (bound for name, bound in self._bounds if name == kind):
            key = (servo.name, kind, bound.side)
            beyond = bound.beyond(value)
            if beyond > 0 and key not in self._warned:
                self._warned.add(key)
                self._context.notice(
                    "warning",
                    f"{servo.label}: {kind} {value:.4g} {unit},"
                    f" {bound.side} {bound.limit:g} {unit}",
                    "let it rest, or take some load off",
                )
            elif beyond < -EASING * abs(bound.limit):
                self._warned.discard(key)


def report(settings: ServoSettings, servos_: Iterable[Servo]) -> tuple[Health, str, str]:
    """How the chain is, for `DriverContext.health`: a fault of any servo is one of the whole."""
    known = list(servos_)
    faults = [f"{servo.label} {servo.trouble}" for servo in known if servo.trouble]
    remedies = [servo.remedy for servo in known if servo.trouble and servo.remedy]
    for servo in known:
        if servo.alarms and not servo.trouble:
            faults.append(f"{servo.label}: {', '.join(servo.alarms)}")
            remedies.append(servos.alarm_remedy(servo))
    if faults:
        return Health.FAULTED, "; ".join(faults), "; ".join(dict.fromkeys(remedies))
    models = Counter(servo.model.name for servo in known if servo.model is not None)
    found = ", ".join(f"{count} x {name}" for name, count in sorted(models.items()))
    return Health.CONNECTED, f"{settings.port}: {found}", ""


def unable_verbs(settings: ServoSettings, servos_: Iterable[Servo]) -> tuple[tuple[str, ...], str]:
    """What moves joints, where no servo could: for `DriverContext.unable`."""
    obstacles = [servo.obstacle for servo in servos_]
    whys = dict.fromkeys(each.what for each in obstacles if each is not None)
    if any(each is None for each in obstacles):
        return (), ""
    moving = (verb.name for verb in servo_verbs(settings) if verb.lane != POWER)
    return tuple(moving), "; ".join(whys)


def signed_load(table: control_tables.ControlTable, raw: int) -> int:
    """The load register as a signed number."""
    if table.load_sign_bit is None:
        return raw
    sign = 1 << table.load_sign_bit
    return -(raw & (sign - 1)) if raw & sign else raw & (sign - 1)
