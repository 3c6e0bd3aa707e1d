"""One servo as the loop knows it, and how it is checked before anything is asked of it."""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field

from woz_drivers.dynamixel import control_tables
from woz_drivers.dynamixel.control_tables import ControlTable, Register, ServoModel
from woz_drivers.dynamixel.setpoint_planning import JointTrack, TargetFollower
from woz_drivers.dynamixel.settings import ServoJointSettings, ServoSettings
from woz_drivers.dynamixel.wire import ServoWire, refusal
from woz_tui.drivers.contract import DriverError, RejectedError
from woz_tui.motion.safety import Limits


class UnfitError(DriverError):
    """The servo answers but must not be moved."""


class SilentError(DriverError):
    """It did not answer."""

    def __init__(
        self,
        what: str = "does not answer",
        remedy: str = "check its cable, its power and its id",
    ) -> None:
        super().__init__(what, remedy)


# -- calibration ----------------------------------------------------------------------------------
# Degrees of a joint <-> counts of its servo.

#: A joint found so far outside its range, in degrees, comes in with its next movement: limp joints
#: sag to a stop a little beyond it, and hands are not exact. One further out is not where it is
#: believed to be (another turn, a wrong `zero`), or has passed its stop: nobody knows what is in
#: the way back.
STRAY = 10.0

#: Counts that extended position control accepts to either side.
MULTI_TURN = 1_048_575


@dataclass(frozen=True, slots=True)
class Calibration:
    """How one joint's degrees and its servo's counts belong together.

    `low` and `high` are the joint's limits in degrees after the servo's own limits were taken
    into account (`low > high`: the two do not meet); `low_raw` and `high_raw` the counts that the
    servo accepts as a goal.
    """

    model: ServoModel
    zero: int
    degrees_per_count: float
    low: float
    high: float
    low_raw: int
    high_raw: int

    @property
    def several_turns(self) -> bool:
        """Whether the servo counts turns, which it forgets without power."""
        return self.low_raw == -MULTI_TURN

    @property
    def turn(self) -> float:
        """Degrees of the joint in one turn of the servo."""
        return 360.0 / self.model.degrees_per_step * abs(self.degrees_per_count)

    def stray(self, degrees: float) -> UnfitError | None:
        """What to say of a joint that stands too far outside its range to be moved; None: it may
        be moved, also if it first has to come in.
        """
        excess = max(self.low - degrees, degrees - self.high)
        if excess <= STRAY:
            return None
        what = (
            f"stands at {degrees:.0f} degrees, {excess:.0f} outside"
            f" {self.low:.4g} to {self.high:.4g}"
        )
        turns = round((degrees - (self.low + self.high) / 2) / self.turn)
        inside = self.low <= degrees - turns * self.turn <= self.high
        if self.several_turns and turns and inside:
            return UnfitError(
                f"{what}: its count is wrong by {abs(turns)} turn{'s' if abs(turns) > 1 else ''}",
                "`reboot` it, or switch its power off and on: it then forgets the turns it has"
                " counted; in Operating Mode (11) 3 it counts none",
            )
        return UnfitError(
            what,
            "switch its torque off and turn it back by hand, then `torque: on`; if it stands where"
            " it should, correct `zero`, `direction`, `gear`, min and max",
        )

    def degrees(self, raw: int) -> float:
        """The joint's angle at the servo's count `raw`."""
        return (raw - self.zero) * self.degrees_per_count

    def raw(self, degrees: float) -> int:
        """The count for an angle, bounded by the servo's own limits; NaN is refused."""
        if not math.isfinite(degrees):
            raise ValueError(f"{degrees} degrees cannot be written to a servo")
        count = self.zero + round(degrees / self.degrees_per_count)
        return min(max(count, self.low_raw), self.high_raw)

    def speed_count(self, degrees_per_s: float) -> int:
        """Speed register for the joint's speed, rounded up, at least 1 (0 means no limit)."""
        servo_speed = degrees_per_s * self.model.degrees_per_step / abs(self.degrees_per_count)
        top = 32_767 if self.model.table.protocol == 2 else 1023
        return min(max(1, math.ceil(servo_speed / self.model.speed_unit)), top)

    def goal_value(self, raw: int, degrees_per_s: float) -> int:
        """The number for the table's `goal_block`: the goal, in protocol 1 with the speed."""
        table = self.model.table
        if table.goal_block() == table.goal:
            return raw
        return raw | self.speed_count(degrees_per_s) << 8 * table.goal.size


def calibrate(
    joint: ServoJointSettings, model: ServoModel, servo_limits: tuple[int, int] | None
) -> Calibration:
    """Put a joint's settings, its model and the limits stored in the servo together.

    Args:
        joint: The settings.
        model: What answered the ping.
        servo_limits: Lowest and highest goal that the servo accepts; None in modes that know no
            limits (several turns).
    """
    zero = joint.zero if joint.zero is not None else model.centre
    per_count = joint.direction * model.degrees_per_step / joint.gear
    low, high = joint.min, joint.max
    if servo_limits is None:
        return Calibration(model, zero, per_count, low, high, -MULTI_TURN, MULTI_TURN)
    reach = sorted((limit - zero) * per_count for limit in servo_limits)
    low, high = max(low, reach[0]), min(high, reach[1])
    return Calibration(model, zero, per_count, low, high, *servo_limits)


# --------------------------------------------------------------------------------------------------

#: Reads that must fail in a row before a servo counts as silent: noise costs one, a cable all.
MISSES = 3
#: A servo this far beyond its own limits, in degrees of the joint, is still taken to its limit
#: when its torque goes on: gears have play, and the limit may be the joint's mechanical stop.
HOLDABLE = 2.0
#: No joint gets so far while its torque goes on, in turns of the servo: it has changed its count. A
#: servo with a homing offset in position mode was seen to do so (ROBOTIS forum, thread 7814).
TURNED = 0.5
#: And so many where this process itself was too late to hear them: then a cable is not the cause.
#: But nobody holds on to a silent servo for longer than that, in seconds.
LATE_MISSES, LATE_S = 25, 1.0
PINGS_ONLY = "answers pings and no reads"
TORQUE_REMEDY = "make sure that nobody is in reach, then switch the torque on (`torque: on`)"
#: Of a servo that shut itself down; one of protocol 1 cannot be restarted over the wire.
X_REMEDY = "remove the load and let it cool, then `reboot` and `torque: on`"
PROTOCOL_1_REMEDY = "remove the load and let it cool, then switch the servos' power off and on"


class ServoStatus(enum.Enum):
    """Whether a servo can be used."""

    SILENT = "silent"
    UNFIT = "unfit"
    READY = "ready"


@dataclass(slots=True)
class Servo:
    """State of one servo. `present` and `setpoint` are the joint's degrees."""

    name: str
    joint: ServoJointSettings
    status: ServoStatus = ServoStatus.SILENT
    trouble: str = "has not answered yet"
    remedy: str = ""
    model: ServoModel | None = None
    calibration: Calibration | None = None
    limits: Limits = field(default_factory=lambda: Limits(0.0, 0.0, 1.0))
    present: float = 0.0
    setpoint: float = 0.0
    written: int | None = None
    torque: bool = False
    misses: int = 0
    #: When the first of them was, on the monotonic clock.
    missed_since: float = 0.0
    alarms: tuple[str, ...] = ()
    #: What the torque limit was set to when the torque went on; any other value: it restarted.
    torque_limit: int | None = None
    #: What drives the setpoint now: a track since `track_began`, or a target to follow.
    track: JointTrack | None = None
    track_began: float = 0.0
    follow: TargetFollower | None = None
    #: Whether it has met the body that it follows, since it last held still.
    met: bool = False

    @property
    def label(self) -> str:
        """For messages: name and id."""
        return f"{self.name} (id {self.joint.id})"

    @property
    def moves(self) -> bool:
        """Whether a setpoint would have any effect."""
        return self.status is ServoStatus.READY and self.torque

    @property
    def answers(self) -> bool:
        """Whether it answered when it was last asked."""
        return self.status is ServoStatus.READY and not self.misses

    @property
    def obstacle(self) -> DriverError | None:
        """Why no movement may begin where its setpoint is now; None: one may."""
        if self.status is not ServoStatus.READY:
            return UnfitError(self.trouble, self.remedy)
        if not self.torque:
            return RejectedError("torque is off", TORQUE_REMEDY)
        return self.calibration.stray(self.setpoint) if self.calibration is not None else None

    def hold(self) -> None:
        """Nothing drives the setpoint any more: it stays where it is."""
        self.track = None
        self.follow = None
        self.met = False

    def settle(self) -> None:
        """Hold where the servo is now."""
        self.hold()
        self.setpoint = self.present

    def lose(self, why: str, remedy: str, status: ServoStatus = ServoStatus.SILENT) -> None:
        """It cannot be used until it has been checked again."""
        self.hold()
        self.status = status
        self.trouble = why
        self.remedy = remedy
        self.misses = 0


@dataclass(frozen=True, slots=True)
class ServoRegisters:
    """One servo on the wire. Raises `SilentError` or `UnfitError` where it does not do as asked."""

    wire: ServoWire
    servo: int
    table: ControlTable

    def number(self, register: Register) -> int:
        """A register as a number."""
        value = self.wire.number(self.servo, register)
        if value is None:
            raise SilentError()
        return value

    def write(self, register: Register, value: int) -> None:
        """Write, once more if it went unanswered."""
        error = self.wire.write(self.servo, register, value)
        if error is None:
            error = self.wire.write(self.servo, register, value)
        if error is None:
            raise SilentError()
        why = refusal(error) if self.table.protocol == 2 else ""
        if why:
            raise UnfitError(
                f"refuses to take {value} at address {register.address}: {why}",
                "look at its alarm; `reboot` clears one",
            )


def check(wire: ServoWire, servo: Servo, settings: ServoSettings, *, fresh: bool) -> None:
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
    line = ServoRegisters(wire, servo.joint.id, table)
    status = wire.read(servo.joint.id, table.status_block())
    if status is None:
        check_answers(line)
        raise SilentError()
    keep = servo.torque and not fresh and still_holds(servo, table, status.data)
    switch_off = torque_enabled(table, status.data) and not keep
    # Before anything is judged: a servo found turning like a wheel must not go on doing so.
    taken = wire.write(servo.joint.id, table.torque, 0) if switch_off else 0
    try:
        check_answers(line)
    except SilentError:
        raise SilentError() from None  # it has answered a read, so that its level is not the cause
    except UnfitError:
        wire.write(servo.joint.id, table.torque, 0)  # it takes it, and says nothing
        raise
    if taken != 0:
        line.write(table.torque, 0)
    if switch_off:
        servo.torque = False
    calibration = read_calibration(line, servo.joint, model)
    if settings.return_delay is not None:
        wanted = settings.return_delay // 2
        if line.number(table.return_delay) != wanted:
            line.write(table.return_delay, wanted)
    _set_fences(line, servo, settings, calibration)
    raw = line.number(table.present)
    servo.model, servo.calibration = model, calibration
    servo.limits = Limits(
        calibration.low, calibration.high, servo.joint.speed, servo.joint.acceleration
    )
    servo.present = calibration.degrees(raw)
    servo.settle()
    servo.written = None
    servo.torque = keep
    servo.misses = 0
    servo.status, servo.trouble, servo.remedy = ServoStatus.READY, "", ""


def check_answers(line: ServoRegisters) -> None:
    """Whether a servo that has answered a ping answers the rest; writes nothing.

    Raises:
        SilentError: It does not even answer reads.
        UnfitError: It answers no writes, so that nobody would know whether it took them.
    """
    register = line.table.return_level
    levels = [line.wire.number(line.servo, register)]
    if levels[0] is not None and levels[0] < control_tables.ANSWERS_ALL:
        # An adapter that is late may have passed on the answer to an earlier question.
        levels.append(line.wire.number(line.servo, register))
    level = None if None in levels else max(each for each in levels if each is not None)
    called = f"Status Return Level ({register.address})"
    if level is None:
        raise SilentError(
            f"{PINGS_ONLY}, as with a {called} of {control_tables.ANSWERS_PINGS}",
            f"set it to {control_tables.ANSWERS_ALL} with the maker's tool; if that is what it"
            " is, check its cable",
        )
    if level < control_tables.ANSWERS_ALL:
        raise UnfitError(
            f"answers reads and no writes: its {called} is {level}",
            f"set it to {control_tables.ANSWERS_ALL} with the maker's tool",
        )


def read_calibration(
    line: ServoRegisters, joint: ServoJointSettings, model: ServoModel
) -> Calibration:
    """Put a joint's settings and what its servo has stored together; writes nothing.

    Raises:
        SilentError: No answer.
        UnfitError: Set like this the servo cannot be a joint.
    """
    servo_limits = None if _counts_turns(line) else _servo_limits(line)
    calibration = calibrate(joint, model, servo_limits)
    if calibration.low >= calibration.high:
        raise UnfitError(
            f"min {joint.min:g} to max {joint.max:g} lies outside what the servo itself allows",
            "correct zero, min and max, or the position limits stored in the servo",
        )
    return calibration


def _model(joint: ServoJointSettings, protocol: int, number: int) -> ServoModel:
    model = control_tables.by_number(protocol, number)
    wanted = control_tables.by_name(joint.model) if joint.model else None
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


def _counts_turns(line: ServoRegisters) -> bool:
    """Whether the servo counts several turns; `UnfitError` if it does not hold positions."""
    if line.table.operating_mode is None:
        return False
    mode = line.number(line.table.operating_mode)
    if mode not in control_tables.POSITION_MODES:
        raise UnfitError(
            f"is in operating mode {mode}, not in a position mode",
            "set Operating Mode (11) to 3 with the maker's tool",
        )
    return mode in control_tables.EXTENDED_MODES


def _servo_limits(line: ServoRegisters) -> tuple[int, int]:
    low, high = line.number(line.table.low_limit), line.number(line.table.high_limit)
    if low >= high:
        # Protocol 1: both 0 is wheel mode, both at the top is multi-turn mode.
        raise UnfitError(
            f"has position limits {low} and {high}: it turns without end",
            "set the position limits stored in the servo to one turn",
        )
    return low, high


def torque_enabled(table: ControlTable, status: bytes) -> bool:
    """Whether the torque is on, by the status block."""
    return table.torque.within(table.status_block(), status) != 0


def still_holds(servo: Servo, table: ControlTable, status: bytes) -> bool:
    """Whether the torque is on, by the status block, and has been since `torque_on`.

    A protocol 1 servo that restarted may have been switched on again by a goal; but then its torque
    limit is no longer the one it was given. A servo of 0 has shut itself down.
    """
    if table.torque_limit is None:
        return torque_enabled(table, status)
    limit = table.torque_limit.within(table.status_block(), status)
    return torque_enabled(table, status) and limit == servo.torque_limit


def _set_fences(
    line: ServoRegisters, servo: Servo, settings: ServoSettings, calibration: Calibration
) -> None:
    """Set what a servo forgets without power, and what stops it where this program does not."""
    table = line.table
    if table.watchdog is not None:
        rearm(line, settings.watchdog)
    timed = (
        table.drive_mode is not None
        and line.number(table.drive_mode) & control_tables.TIME_PROFILE_BIT
    )
    if not timed:
        # Second fence behind our own: the servo itself never goes faster either.
        line.write(table.speed_limit, calibration.speed_count(servo.joint.speed))


def rearm(line: ServoRegisters, milliseconds: int) -> None:
    """Clear the bus watchdog, which also takes it out of its error, and set it again."""
    assert line.table.watchdog is not None
    line.write(line.table.watchdog, 0)
    units = watchdog_units(milliseconds)
    if units:
        line.write(line.table.watchdog, units)


def watchdog_units(milliseconds: int) -> int:
    """What the bus watchdog reads when it is set to so many milliseconds; 0: off."""
    return min(milliseconds // control_tables.WATCHDOG_UNIT_MS, control_tables.WATCHDOG_MAX)


def torque_on(wire: ServoWire, servo: Servo, settings: ServoSettings) -> None:
    """Let a servo hold the pose it is in now. Raises `SilentError` or `UnfitError`.

    The goal is written first, and it is the present pose: neither the servo's last goal nor ours
    can make it jump. A pose that the servo does not take as a goal (it was turned by hand beyond
    its own limits) cannot be held, so there the joint stays limp; and so it does where it stands
    too far outside its range to be moved back in.
    """
    calibration = servo.calibration
    assert calibration is not None
    model, table = calibration.model, calibration.model.table
    line = ServoRegisters(wire, servo.joint.id, table)
    raw = line.number(table.present)
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
    if (stray := calibration.stray(servo.present)) is not None:
        raise stray
    _set_fences(line, servo, settings, calibration)
    if table.torque_limit is not None and table.max_torque is not None:
        servo.torque_limit = _mark_torque_limit(line, table.torque_limit, table.max_torque)
    line.write(table.goal_block(), calibration.goal_value(servo.written, servo.joint.speed))
    line.write(table.torque, 1)
    servo.torque = True
    _see_torque(wire, servo, table)
    if abs(line.number(table.present) - raw) > TURNED * model.steps:
        torque_off(wire, servo)
        raise UnfitError(
            "counts another turn as soon as it holds, and would go through the whole of it",
            "set Homing Offset (20) to 0 and use `zero`",
        )


def _see_torque(wire: ServoWire, servo: Servo, table: ControlTable) -> None:
    """One that has shut itself down answers that it takes the torque, and stays limp."""
    status = wire.read(servo.joint.id, table.status_block())
    if status is None:
        raise SilentError()
    if torque_enabled(table, status.data):
        return
    servo.torque = False
    bits = (
        status.error
        if table.alarm is None
        else table.alarm.within(table.status_block(), status.data)
    )
    names = control_tables.alarms(table, bits)
    raise UnfitError(
        f"stays limp: {', '.join(names)}" if names else "stays limp, and reports no alarm",
        alarm_remedy(servo),
    )


def alarm_remedy(servo: Servo) -> str:
    """What to do about a servo that has shut itself down."""
    old = servo.model is not None and servo.model.table.protocol == 1
    return PROTOCOL_1_REMEDY if old else X_REMEDY


def _mark_torque_limit(line: ServoRegisters, torque_limit: Register, max_torque: Register) -> int:
    """Make sure that the torque limit is not what it is after a restart: one count (0.1 %) less."""
    limit, stored = line.number(torque_limit), line.number(max_torque)
    if limit == 0:
        raise UnfitError(
            "has a torque limit of 0: it shut itself down, or its Max Torque (14) is 0",
            PROTOCOL_1_REMEDY,
        )
    if limit == stored > 1:
        limit = stored - 1
        line.write(torque_limit, limit)
    return limit


def torque_off(wire: ServoWire, servo: Servo) -> None:
    """Let a servo go limp. Raises `SilentError` or `UnfitError`."""
    assert servo.calibration is not None
    table = servo.calibration.model.table
    ServoRegisters(wire, servo.joint.id, table).write(table.torque, 0)
    servo.torque = False
    servo.hold()
