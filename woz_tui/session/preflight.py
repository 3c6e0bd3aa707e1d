"""Checks the robot side before the first participant comes: drivers, sensors, log, disk, clock."""

from __future__ import annotations

import math

from woz_tui.config.sensor_names import published_names
from woz_tui.drivers.contract import SPEECH, Finding
from woz_tui.machine import machine_checks
from woz_tui.protocol import messages as m
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.sample_values import is_share, percent, state_word
from woz_tui.session.session import Session

#: A sensor that has said nothing for longer than this is silent (microseconds), unless its readings
#: are seldom by nature: then for so many of its own periods.
FRESH_US, PERIODS = 3_000_000, 3
#: Sensors, by their driver's names, that speak when something happens: neither silence nor an old
#: value says that something is wrong.
_ON_EVENTS = frozenset(
    {SPEECH, "direction", "frames", "prepared", "synthesiser", "talk", "transcriber"}
)
#: What a sensor says, below `SURE` and from there on.
_NOBODY = Sentence("session.nobody", "nobody")
_VERDICTS = {
    "presence": (_NOBODY, Sentence("session.somebody", "somebody")),
    "gaze": (Sentence("session.looks_not", "not looking"), Sentence("session.looks", "looking")),
}
#: Sensors whose names are words; others are called as their driver calls them.
_SENSORS = {
    "presence": Sentence("engagement.presence", "presence"),
    "gaze": Sentence("engagement.gaze", "gaze"),
    "distance": Sentence("engagement.distance", "distance"),
    "identity": Sentence("engagement.identity", "identity"),
    "loudness": Sentence("meters.loudness", "loudness"),
}
SURE = 0.5
_CHOOSE = Sentence("session.choose", "choose it")
#: What the findings are about that are none of drivers and sensors.
_FILE = Sentence("preflight.file", "experiment")
_LOG = Sentence("preflight.log", "log")
_SESSION = Sentence("preflight.session", "session")
_STOP = Sentence("preflight.stop", "stop")
#: What a line of the list can be; what is only worth knowing is in order.
LEVELS = ("ok", "warning", "error")


async def preflight(session: Session) -> list[Finding]:
    """Findings of drivers, sensors, log, disk, clock, identity: each in the log, and a marker."""
    findings = [
        *_drivers(session),
        *_sensors(session),
        _recorder(session),
        machine_checks.free_space(session.recorder.path.parent),
        machine_checks.calendar(session.clock.wall()),
        _identity(session),
        *_file(session),
        _stop(session),
        *session.features.findings(),
    ]
    for finding in findings:
        session.hub.publish(
            m.PreflightChecked(
                check=finding.subject,
                level=finding.level if finding.level in LEVELS else "ok",
                detail=finding.text,
                source="robot",
            )
        )
    worst = sum(finding.level == "error" for finding in findings)
    session.hub.publish(
        m.Marker(text=f"preflight: {len(findings)} checks, {worst} failed", source="preflight")
    )
    return findings


def _file(session: Session) -> list[Finding]:
    """The warnings about the experiment file."""
    odd = session.experiment.warnings
    if not odd:
        return []
    first = odd[0].in_line(odd[0].path)
    if len(odd) > 1:
        first = Sentence(
            "session.and_more", "{first}; and {number} more", first=first, number=len(odd) - 1
        )
    return [Finding("warning", _FILE, first, f"woz check {session.experiment.path.name}")]


def _drivers(session: Session) -> list[Finding]:
    findings = []
    for name in session.drivers:
        driver = session.state.drivers.get(name)
        message = driver.health if driver is not None else None
        if isinstance(message, m.DriverConnected):
            shown = session.state.robots.shown.get(name)
            if shown is not None and shown.conflicts:
                findings.append(Finding("warning", name, "; ".join(shown.conflicts)))
            else:
                findings.append(
                    Finding("ok", name, message.detail or Sentence("session.ready", "ready"))
                )
        elif message is None or isinstance(message, m.DriverConnecting):
            findings.append(
                Finding(
                    "warning",
                    name,
                    Sentence("session.searching", "searching for its hardware"),
                )
            )
        else:
            findings.append(
                Finding(
                    "error",
                    name,
                    message.detail or Sentence("session.not_available", "not available"),
                    message.remedy,
                )
            )
    return findings


def _sensors(session: Session) -> list[Finding]:
    published = published_names(session.experiment.drivers)
    # Joints and their like, which have a dot in their names, have their driver's own line.
    expected = [
        name
        for names in published.values()
        for sensor, name in names.items()
        if "." not in sensor and sensor not in _ON_EVENTS
    ]
    findings = []
    for sensor in expected:
        subject = _SENSORS.get(sensor, sensor)
        message = session.state.readings.get(sensor)
        changed = session.state.sensors.get(sensor)
        every_s = changed.every_s if changed is not None else 0.0
        limit_us = max(FRESH_US, PERIODS * every_s * 1_000_000)
        if message is None:
            findings.append(
                Finding("warning", subject, Sentence("session.no_value", "no value yet"))
            )
        elif session.hub.now() - message.t > limit_us:
            findings.append(
                Finding(
                    "warning",
                    subject,
                    Sentence("session.value_old", "its last value is too old"),
                    Sentence("session.check_device", "check the device"),
                )
            )
        else:
            findings.append(Finding("ok", subject, _reading_in_words(message)))
    return findings


def _reading_in_words(message: m.Reading) -> str:
    if message.sensor.endswith("identity"):
        return message.text or Sentence("session.nobody_identified", "nobody identified")
    if message.value is None:
        return message.text or Sentence("session.nothing_measured", "nothing measured")
    kind = message.sensor.rpartition(".")[2]
    if (words := _VERDICTS.get(kind)) is not None:
        return words[message.value >= SURE]
    if kind == "loudness" and message.value > 0:
        return f"{20 * math.log10(message.value):.0f} dB"
    if kind == "people":
        return {0.0: _NOBODY, 1.0: Sentence("session.one_person", "1 person")}.get(
            message.value, Sentence("session.people", "{value:.0f} people", value=message.value)
        )
    if word := state_word(message.sensor, message.value):
        return word
    if is_share(message.sensor, message.value, message.unit):
        return percent(message.value)
    if message.unit == "m":
        return f"{message.value:.2f} m"
    return f"{message.value:.3g} {message.unit}".strip()


def _recorder(session: Session) -> Finding:
    state = session.recorder.state()
    if state.level == "ok":
        return Finding(
            "ok",
            _LOG,
            Sentence(
                "session.on_disk",
                "on disk within {ms:.0f} ms",
                ms=state.lag_us / 1000,
            ),
        )
    level = "error" if state.level == "failed" else "warning"
    return Finding(
        level,
        _LOG,
        state.detail or Sentence("session.ms_behind", "{ms:.0f} ms behind", ms=state.lag_us / 1000),
        state.remedy,
    )


def _identity(session: Session) -> Finding:
    identity = session.identity
    if session.experiment.conditions and not identity.condition:
        if identity.participant:
            unset = Sentence("session.unset_condition", "no condition set")
        else:
            unset = Sentence("session.unset_both", "no participant and no condition set")
        return Finding("warning", _SESSION, unset, _CHOOSE)
    if not identity.participant:
        unset = Sentence("session.unset_participant", "no participant set")
        return Finding("warning", _SESSION, unset, _CHOOSE)
    condition = session.state.study.label(identity.condition)
    return Finding("ok", _SESSION, f"{identity.participant} {condition}".strip())


def _stop(session: Session) -> Finding:
    if session.bus.latched:
        return Finding(
            "error",
            _STOP,
            Sentence("gate.stopped", "the stop is pressed"),
            Sentence("session.release_stop", "release the stop"),
        )
    return Finding("ok", _STOP, Sentence("session.stop_released", "released"))
