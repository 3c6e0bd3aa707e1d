"""`woz doctor` for servos: port, adapter, ids, models, alarms, voltage; nothing moves."""

from __future__ import annotations

from collections.abc import Iterator

from woz_drivers.dynamixel import control_tables
from woz_drivers.dynamixel import servo as servos
from woz_drivers.dynamixel.port import (
    AMPLE_MS,
    ServoPort,
    latency_file,
    latency_timer,
    slow_answers,
)
from woz_drivers.dynamixel.settings import ServoJointSettings, ServoSettings
from woz_drivers.dynamixel.wire import ServoWire
from woz_tui.drivers.contract import DeviceLostError, Finding

#: Bauds that servos are usually left at, tried where the configured one finds nobody.
USUAL_BAUDS = (57_600, 1_000_000, 115_200, 2_000_000, 3_000_000, 4_000_000)
#: An FTDI adapter passes bytes on after this time unless told otherwise, in milliseconds.
SLOW_LATENCY_MS = 2.0
#: Servos of size 330 with firmware 51 were seen to turn on after their bus watchdog had tripped
#: (ROBOTIS forum, thread 4814, "Watchdog of XC330-T288-T does not stop motor"; the maker confirmed
#: it for all models of that size). Nothing is published about older versions.
DOUBTED_SIZE = ("XL330", "XC330")
DOUBTED_FIRMWARE = 51


def examine(settings: ServoSettings) -> list[Finding]:
    """Everything there is to know from outside; blocks for some seconds, never raises."""
    findings = [
        Finding("error", path, text, "correct the robot file") for path, text in settings.problems()
    ]
    if findings:
        return findings
    port = ServoPort(settings.port, settings.baud, settings.reply_timeout)
    try:
        port.open()
    except DeviceLostError as lost:
        return [Finding("error", settings.port, lost.what, lost.remedy)]
    wire = ServoWire(port, settings.protocol)
    try:
        findings.append(Finding("ok", settings.port, f"open at {settings.baud} baud"))
        findings.append(_latency(settings, port))
        findings.append(_watchdog(settings))
        findings.extend(_servos(wire, settings))
    except DeviceLostError as lost:
        findings.append(Finding("error", settings.port, lost.what, lost.remedy))
    finally:
        wire.close()
    return findings


def _latency(settings: ServoSettings, port: ServoPort) -> Finding:
    timer = latency_timer(settings.port)
    if timer is None:
        return Finding("info", settings.port, "no latency timer: not an FTDI adapter")
    allowed = 1000.0 / timer
    text = f"latency timer {timer:g} ms: at most {allowed:.0f} rounds a second"
    if timer <= SLOW_LATENCY_MS or allowed > 2 * settings.rate:
        return Finding("ok", settings.port, text)
    return Finding(
        "warning",
        settings.port,
        f"{text}, and the loop wants {settings.rate:g}",
        f"echo 1 | sudo tee {latency_file(settings.port)}, or a udev rule that does it",
    )


def _watchdog(settings: ServoSettings) -> Finding:
    if settings.protocol == 1:
        return Finding(
            "info",
            "bus watchdog",
            "protocol 1 servos have none: they hold their last goal if the program dies",
            "keep the power switch at hand",
        )
    if settings.watchdog == 0:
        return Finding(
            "warning",
            "bus watchdog",
            "is off: servos hold their last goal if the program dies",
            "set `watchdog: 500`",
        )
    return Finding(
        "ok", "bus watchdog", f"servos stop after {settings.watchdog} ms without a command"
    )


def _servos(wire: ServoWire, settings: ServoSettings) -> Iterator[Finding]:
    ids = [joint.id for joint in settings.joints.values()]
    longest = wire.measure(ids)
    if longest is not None:
        slow = slow_answers(settings.port, longest)
        yield Finding("warning", settings.port, *wire.port.blame(*slow))
    found = wire.scan(ids)
    # The broadcast can lose answers on a noisy line: ask the configured ones by name.
    for servo in ids:
        if servo not in found and (number := wire.ping(servo)) is not None:
            found[servo] = number
    for name, joint in settings.joints.items():
        yield from _joint(wire, settings, name, joint, found.get(joint.id))
    for servo in sorted(set(found) - set(ids)):
        model = control_tables.by_number(settings.protocol, found[servo])
        called = f"a {model.name}" if model is not None else f"model number {found[servo]}"
        yield Finding(
            "warning",
            f"id {servo}",
            f"{called} answers, but no joint has this id",
            "give it to a joint, or take it off the wire",
        )
    missing = [servo for servo in ids if servo not in found]
    if missing:
        wire.close()
        yield from _elsewhere(settings, missing)


def _joint(
    wire: ServoWire,
    settings: ServoSettings,
    name: str,
    joint: ServoJointSettings,
    number: int | None,
) -> Iterator[Finding]:
    subject = f"{name} (id {joint.id})"
    if number is None:
        told = wire.port.blame("does not answer", "check its cable, its power, its id and its baud")
        yield Finding("error", subject, *told)
        return
    model = control_tables.by_number(settings.protocol, number)
    if model is None:
        yield Finding("error", subject, f"has model number {number}, which is in no table")
        return
    wanted = control_tables.by_name(joint.model) if joint.model else None
    if wanted is not None and wanted is not model:
        yield Finding(
            "error",
            subject,
            f"is a {model.name}, but the settings say {wanted.name}",
            "correct `model`, or put the right servo on this id",
        )
    else:
        yield Finding("ok", subject, f"is a {model.name}")
    yield from _condition(wire, settings, subject, joint, model)


def _condition(
    wire: ServoWire,
    settings: ServoSettings,
    subject: str,
    joint: ServoJointSettings,
    model: control_tables.ServoModel,
) -> Iterator[Finding]:
    table = model.table
    try:
        servos.check_answers(servos.ServoRegisters(wire, joint.id, table))
    except (servos.SilentError, servos.UnfitError) as error:
        silent = isinstance(error, servos.SilentError)
        told = (error.what, error.remedy)
        yield Finding("error", subject, *(wire.port.blame(*told) if silent else told))
        if silent:
            return
    voltage = wire.read(joint.id, table.voltage)
    if voltage is None:
        told = wire.port.blame("stopped answering", "check its cable, or raise `reply_timeout`")
        yield Finding("error", subject, *told)
        return
    volts = table.voltage.decode(voltage.data) * control_tables.VOLT
    firmware = wire.number(joint.id, table.firmware)
    version = "unknown" if firmware is None else str(firmware)
    yield Finding("info", subject, f"{volts:.1f} V, firmware {version}")
    if settings.watchdog and table.watchdog is not None:
        yield from _watchdog_doubts(wire, subject, joint, model, firmware)
    if table.startup is not None:
        yield from _startup(wire.number(joint.id, table.startup) or 0, subject)
    yield from _place(wire, subject, joint, model)
    bits = voltage.error if table.alarm is None else wire.number(joint.id, table.alarm) or 0
    for alarm in control_tables.alarms(table, bits):
        yield Finding("error", subject, f"alarm: {alarm}", "let it cool, then restart it")
    delay = wire.number(joint.id, table.return_delay)
    if delay:
        yield Finding(
            "info",
            subject,
            f"waits {delay * 2} us before it answers",
            "set `return_delay: 0` to have it answer at once",
        )


def _startup(bits: int, subject: str) -> Iterator[Finding]:
    """Whether the servo does something by itself as soon as it has power."""
    if bits & control_tables.TORQUE_AT_START_BIT:
        goal = ", and may go to a goal that was saved" if bits & control_tables.RESTORE_BIT else ""
        yield Finding(
            "warning",
            subject,
            f"switches its torque on by itself when it gets power{goal}: no stop and no session"
            " is there then",
            "set Startup Configuration (60) to 0 with the maker's tool, DYNAMIXEL Wizard",
        )


def _place(
    wire: ServoWire, subject: str, joint: ServoJointSettings, model: control_tables.ServoModel
) -> Iterator[Finding]:
    """Whether the servo, as it is set and where it stands, can be this joint."""
    line = servos.ServoRegisters(wire, joint.id, model.table)
    try:
        calibration = servos.read_calibration(line, joint, model)
        stray = calibration.stray(calibration.degrees(line.number(model.table.present)))
        if stray is not None:
            raise stray
    except (servos.SilentError, servos.UnfitError) as unfit:
        yield Finding("error", subject, unfit.what, unfit.remedy)
        return
    low, high = calibration.low, calibration.high
    if max(low - joint.min, joint.max - high) > servos.HOLDABLE:
        yield Finding(
            "warning",
            subject,
            f"goes from {low:.4g} to {high:.4g} degrees, and not from {joint.min:g} to"
            f" {joint.max:g}: the position limits stored in the servo are narrower",
            "correct them with the maker's tool, or correct zero, min and max",
        )
    if calibration.several_turns and calibration.turn < high - low + 2 * servos.STRAY:
        yield Finding(
            "warning",
            subject,
            f"counts turns, and forgets them without power: one is {calibration.turn:.4g} degrees"
            " of the joint, so that a wrong count cannot be told from a right one",
            "after each loss of power compare the joint with its reading before `torque: on`",
        )


def _watchdog_doubts(
    wire: ServoWire,
    subject: str,
    joint: ServoJointSettings,
    model: control_tables.ServoModel,
    firmware: int | None,
) -> Iterator[Finding]:
    """Reasons not to trust the bus watchdog of this servo."""
    try_it = "then pull the adapter during a slow move and see that the joint stops"
    if (
        model.name.startswith(DOUBTED_SIZE)
        and firmware is not None
        and firmware <= DOUBTED_FIRMWARE
    ):
        known = "" if firmware == DOUBTED_FIRMWARE else "; whether older ones do is not known"
        yield Finding(
            "warning",
            subject,
            f"may not stop when its bus watchdog trips: servos of this size with firmware"
            f" {DOUBTED_FIRMWARE} did not (ROBOTIS forum, thread 4814){known}",
            f"update its firmware with the maker's tool, {try_it}",
        )
    mode, offset = (
        wire.number(joint.id, register) if register is not None else None
        for register in (model.table.operating_mode, model.table.homing_offset)
    )
    if mode in control_tables.EXTENDED_MODES and offset:
        yield Finding(
            "warning",
            subject,
            f"counts several turns with a homing offset ({offset}): such servos were seen to begin"
            " to move when their bus watchdog tripped (DynamixelSDK issue 584)",
            f"set Homing Offset (20) to 0 and use `zero`, or update its firmware; {try_it}",
        )


def _elsewhere(settings: ServoSettings, missing: list[int]) -> Iterator[Finding]:
    """Missing servos may have been left at another speed: ask for them there."""
    for baud in USUAL_BAUDS:
        if baud == settings.baud or not missing:
            continue
        port = ServoPort(settings.port, baud, settings.reply_timeout or AMPLE_MS)
        other = ServoWire(port, settings.protocol)
        try:
            port.open()
            there = [servo for servo in missing if other.ping(servo) is not None]
        except DeviceLostError:
            continue  # the adapter cannot do this speed
        finally:
            other.close()
        missing = [servo for servo in missing if servo not in there]
        if there:
            yield Finding(
                "warning",
                settings.port,
                f"at {baud} baud these ids answer: {', '.join(map(str, there))}",
                "set `baud` to that, or change the servos' speed with the maker's tool",
            )
