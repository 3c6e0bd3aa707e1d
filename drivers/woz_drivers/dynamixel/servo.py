"""One servo as the loop knows it, and how it is checked before anything is asked of it."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field

from woz_drivers.dynamixel import tables
from woz_drivers.dynamixel.calibration import Calibration, calibrate
from woz_drivers.dynamixel.motion import Follow, Track
from woz_drivers.dynamixel.settings import Joint, Settings
from woz_drivers.dynamixel.tables import Model, Register, Table
from woz_drivers.dynamixel.wire import Wire, refusal
from woz_tui.core.driver import DriverError
from woz_tui.motion.safety import Limits

#: Reads that must fail in a row before a servo counts as silent: noise costs one, a cable all.
MISSES = 3
#: A servo this far beyond its own limits, in degrees of the joint, is still taken to its limit
#: when its torque goes on: gears have play, and the limit may be the joint's mechanical stop.
HOLDABLE = 2.0
#: A protocol 1 servo that shut itself down cannot be restarted over the wire.
PROTOCOL_1_REMEDY = "take the load off and let it cool, then switch the servos' power off and on"


class Standing(enum.Enum):
    """Whether a servo can be used."""

    SILENT = "silent"
    UNFIT = "unfit"
    READY = "ready"


class UnfitError(DriverError):
    """The servo answers but must not be moved."""


class SilentError(DriverError):
    """It did not answer."""

    def __init__(self) -> None:
        super().__init__("does not answer", "check its cable, its power and its id")


@dataclass(slots=True)
class Servo:
    """State of one servo. `present` and `setpoint` are the joint's degrees."""

    name: str
    joint: Joint
    standing: Standing = Standing.SILENT
    trouble: str = "has not answered yet"
    remedy: str = ""
    model: Model | None = None
    calibration: Calibration | None = None
    limits: Limits = field(default_factory=lambda: Limits(0.0, 0.0, 1.0))
    present: float = 0.0
    setpoint: float = 0.0
    written: int | None = None
    torque: bool = False
    misses: int = 0
    alarms: tuple[str, ...] = ()
    #: What the torque limit was set to when the torque went on; any other value: it restarted.
    torque_limit: int | None = None
    #: What drives the setpoint now: a track since `track_began`, or a target to follow.
    track: Track | None = None
    track_began: float = 0.0
    follow: Follow | None = None
    #: Whether it has met the body that it follows, since it last held still.
    met: bool = False

    @property
    def label(self) -> str:
        """For messages: name and id."""
        return f"{self.name} (id {self.joint.id})"

    @property
    def moves(self) -> bool:
        """Whether a setpoint would have any effect."""
        return self.standing is Standing.READY and self.torque

    def hold(self) -> None:
        """Nothing drives the setpoint any more: it stays where it is."""
        self.track = None
        self.follow = None
        self.met = False

    def settle(self) -> None:
        """Hold where the servo is now."""
        self.hold()
        self.setpoint = self.present

    def lose(self, why: str, remedy: str, standing: Standing = Standing.SILENT) -> None:
        """It cannot be used until it has been checked again."""
        self.hold()
        self.standing = standing
        self.trouble = why
        self.remedy = remedy
        self.misses = 0


def check(wire: Wire, servo: Servo, settings: Settings, *, fresh: bool) -> None:
    """Ping a servo, compare it with its settings, and make it ready without moving it.

    Args:
        wire: An open line.
        servo: Whose fields are set.
        settings: Those of the chain.
        fresh: The line was just opened: the torque goes off, whatever it was. Otherwise the servo
            fell silent for a while and keeps its torque if it still has it.

    Raises:
        SilentError: No answer, or none that could be understood.
        UnfitError: It answers, but is not what the settings say.
    """
    number = wire.ping(servo.joint.id)
    if number is None:
        raise SilentError()
    model = _model(servo.joint, settings.protocol, number)
    table = model.table
    # Before anything is judged: a servo found turning like a wheel must not go on doing so.
    status = wire.read(servo.joint.id, table.status_block())
    if status is None:
        raise SilentError()
    keep = servo.torque and not fresh and holds(servo, table, status.data)
    if enabled(table, status.data) and not keep:
        _must(wire, servo.joint.id, table, table.torque, 0)
        servo.torque = False
    extended = _mode(wire, servo.joint.id, table)
    servo_limits = None if extended else _servo_limits(wire, servo.joint.id, model)
    calibration = calibrate(servo.joint, model, servo_limits)
    if calibration.low >= calibration.high:
        raise UnfitError(
            f"min {servo.joint.min:g} to max {servo.joint.max:g} lies outside what the servo"
            " itself allows",
            "correct zero, min and max, or the position limits stored in the servo",
        )
    if settings.return_delay is not None:
        wanted = settings.return_delay // 2
        if _need(wire.number(servo.joint.id, table.return_delay)) != wanted:
            _must(wire, servo.joint.id, table, table.return_delay, wanted)
    _fence(wire, servo, settings, calibration)
    raw = _need(wire.number(servo.joint.id, table.present))
    servo.model, servo.calibration = model, calibration
    servo.limits = Limits(
        calibration.low, calibration.high, servo.joint.speed, servo.joint.acceleration
    )
    servo.present = calibration.degrees(raw)
    servo.settle()
    servo.written = None
    servo.torque = keep
    servo.misses = 0
    servo.standing, servo.trouble, servo.remedy = Standing.READY, "", ""


def _model(joint: Joint, protocol: int, number: int) -> Model:
    model = tables.by_number(protocol, number)
    wanted = tables.by_name(joint.model) if joint.model else None
    if model is None:
        raise UnfitError(
            f"answers with model number {number}, which is not in the tables",
            "use a model from the list of `woz check`, or add its table",
        )
    if wanted is not None and wanted is not model:
        raise UnfitError(
            f"is a {model.name}, but the settings say {wanted.name}",
            "correct `model`, or put the right servo on this id",
        )
    return model


def _mode(wire: Wire, servo: int, table: Table) -> bool:
    """Whether the servo counts several turns; `UnfitError` if it does not hold positions."""
    if table.operating_mode is None:
        return False
    mode = _need(wire.number(servo, table.operating_mode))
    if mode not in tables.POSITION_MODES:
        raise UnfitError(
            f"is in operating mode {mode}, not in a position mode",
            "set Operating Mode (11) to 3 with the maker's tool",
        )
    return mode in tables.EXTENDED_MODES


def _servo_limits(wire: Wire, servo: int, model: Model) -> tuple[int, int]:
    low = _need(wire.number(servo, model.table.low_limit))
    high = _need(wire.number(servo, model.table.high_limit))
    if low >= high:
        # Protocol 1: both 0 is wheel mode, both at the top is multi-turn mode.
        raise UnfitError(
            f"has position limits {low} and {high}: it turns without end",
            "set the position limits stored in the servo to one turn",
        )
    return low, high


def enabled(table: Table, status: bytes) -> bool:
    """Whether the torque is on, by the status block."""
    return table.torque.within(table.status_block(), status) != 0


def holds(servo: Servo, table: Table, status: bytes) -> bool:
    """Whether the torque is on, by the status block, and has been since `torque_on`.

    A protocol 1 servo that restarted may have been switched on again by a goal; but then its torque
    limit is no longer the one it was given. A servo of 0 has shut itself down.
    """
    if table.torque_limit is None:
        return enabled(table, status)
    limit = table.torque_limit.within(table.status_block(), status)
    return enabled(table, status) and limit == servo.torque_limit


def _fence(wire: Wire, servo: Servo, settings: Settings, calibration: Calibration) -> None:
    """Set what a servo forgets without power, and what stops it where this program does not."""
    table = calibration.model.table
    number = servo.joint.id
    if table.watchdog is not None:
        rearm(wire, number, table, settings.watchdog)
    timed = (
        table.drive_mode is not None
        and _need(wire.number(number, table.drive_mode)) & tables.TIME_PROFILE_BIT
    )
    if not timed:
        # Second fence behind our own: the servo itself never goes faster either.
        _must(wire, number, table, table.speed_limit, calibration.speed_count(servo.joint.speed))


def rearm(wire: Wire, servo: int, table: Table, milliseconds: int) -> None:
    """Clear the bus watchdog, which also takes it out of its error, and set it again."""
    assert table.watchdog is not None
    _must(wire, servo, table, table.watchdog, 0)
    units = watchdog_units(milliseconds)
    if units:
        _must(wire, servo, table, table.watchdog, units)


def watchdog_units(milliseconds: int) -> int:
    """What the bus watchdog reads when it is set to so many milliseconds; 0: off."""
    return min(milliseconds // tables.WATCHDOG_UNIT_MS, tables.WATCHDOG_MAX)


def torque_on(wire: Wire, servo: Servo, settings: Settings) -> None:
    """Let a servo hold the pose it is in now. Raises `SilentError` or `UnfitError`.

    The goal is written first, and it is the present pose: neither the servo's last goal nor ours
    can make it jump. A pose that the servo does not take as a goal (it was turned by hand beyond
    its own limits) cannot be held, so there the joint stays limp.
    """
    calibration = servo.calibration
    assert calibration is not None
    table, number = calibration.model.table, servo.joint.id
    raw = _need(wire.number(number, table.present))
    servo.present = calibration.degrees(raw)
    servo.settle()
    servo.written = min(max(raw, calibration.low_raw), calibration.high_raw)
    beyond = abs(servo.present - calibration.degrees(servo.written))
    if beyond > HOLDABLE:
        raise UnfitError(
            f"stands {beyond:.0f} degrees beyond what the servo itself allows:"
            " turn it back by hand first",
            "turn it back by hand, then `torque: on`",
        )
    _fence(wire, servo, settings, calibration)
    if table.torque_limit is not None and table.max_torque is not None:
        servo.torque_limit = _mark(wire, number, table, table.torque_limit, table.max_torque)
    goal = calibration.goal_value(servo.written, servo.joint.speed)
    _must(wire, number, table, table.goal_block(), goal)
    _must(wire, number, table, table.torque, 1)
    servo.torque = True


def _mark(
    wire: Wire, servo: int, table: Table, torque_limit: Register, max_torque: Register
) -> int:
    """Make sure that the torque limit is not what it is after a restart: one count (0.1 %) less."""
    limit = _need(wire.number(servo, torque_limit))
    stored = _need(wire.number(servo, max_torque))
    if limit == 0:
        raise UnfitError(
            "has a torque limit of 0: it shut itself down, or its Max Torque (14) is 0",
            PROTOCOL_1_REMEDY,
        )
    if limit == stored > 1:
        limit = stored - 1
        _must(wire, servo, table, torque_limit, limit)
    return limit


def torque_off(wire: Wire, servo: Servo) -> None:
    """Let a servo go limp. Raises `SilentError` or `UnfitError`."""
    assert servo.calibration is not None
    table = servo.calibration.model.table
    _must(wire, servo.joint.id, table, table.torque, 0)
    servo.torque = False
    servo.hold()


def _must(wire: Wire, servo: int, table: Table, register: Register, value: int) -> None:
    """Write, once more if it went unanswered; `SilentError` or `UnfitError` if it was not taken."""
    error = wire.write(servo, register, value)
    if error is None:
        error = wire.write(servo, register, value)
    if error is None:
        raise SilentError()
    why = refusal(error) if table.protocol == 2 else ""
    if why:
        raise UnfitError(
            f"refuses to take {value} at address {register.address}: {why}",
            "look at its alarm; `reboot` clears one",
        )


def _need(value: int | None) -> int:
    if value is None:
        raise SilentError()
    return value
