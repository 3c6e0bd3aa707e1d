"""Serial ports: which there are, whether they may be opened, and how fast USB hands bytes over."""

from __future__ import annotations

import grp
import os
import pwd
from pathlib import Path

from woz_tui.drivers.contract import Finding

#: The group that owns serial ports on Debian and its children.
GROUP = "dialout"
DEV = Path("/dev")
USB_SERIAL = Path("/sys/bus/usb-serial/devices")

_UDEV_RULE = 'ACTION=="add", SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", ATTR{latency_timer}="1"'


def serial_ports(dev: Path = DEV) -> list[Finding]:
    """One finding for each adapter under `/dev/serial/by-id`."""
    links = sorted((dev / "serial" / "by-id").glob("*"))
    if not links:
        return [Finding("info", "serial ports", "no USB serial adapter is plugged in")]
    return [_port(link) for link in links]


def _port(link: Path) -> Finding:
    target = link.resolve()
    if not target.exists():
        return Finding(
            "warning", link.name, f"points to {target}, which does not exist", "plug it in again"
        )
    if not os.access(target, os.R_OK | os.W_OK):
        return Finding(
            "error", link.name, f"you have no permission to open {target}", _join_group()
        )
    return Finding("ok", link.name, str(target))


def serial_group() -> list[Finding]:
    """Whether this login may open serial ports."""
    try:
        group = grp.getgrnam(GROUP)
    except KeyError:
        return [Finding("info", "serial access", f"this system has no group {GROUP}")]
    if os.geteuid() == 0:
        return [Finding("ok", "serial access", "root can open every port")]
    if group.gr_gid in {os.getegid(), *os.getgroups()}:
        return [Finding("ok", "serial access", f"you are in the group {GROUP}")]
    if _user() in group.gr_mem:
        text = f"you are in the group {GROUP}, but you logged in before you were added"
        return [Finding("warning", "serial access", text, "log out and in again")]
    text = f"you are not in the group {GROUP}: serial ports will refuse you"
    return [Finding("warning", "serial access", text, _join_group())]


def _join_group() -> str:
    return f"sudo adduser {_user()} {GROUP}, then log out and in again"


def _user() -> str:
    try:
        return pwd.getpwuid(os.getuid()).pw_name
    except KeyError:
        return str(os.getuid())


def latency_timers(usb_serial: Path = USB_SERIAL) -> list[Finding]:
    """How long each FTDI adapter holds bytes back, in milliseconds; 16 unless somebody set it.

    A control loop waits for at least one such period a turn (FTDI AN232B-04).
    """
    findings = []
    for timer in sorted(usb_serial.glob("*/latency_timer")):
        port = timer.parent.name
        try:
            milliseconds = int(timer.read_text())
        except (OSError, ValueError):
            continue
        subject = f"latency of {port}"
        if milliseconds <= 1:
            findings.append(Finding("ok", subject, f"{milliseconds} ms"))
        else:
            text = f"{milliseconds} ms: at most {1000 // milliseconds} reads a second"
            remedy = f"echo 1 | sudo tee {timer}; for good, a udev rule: {_UDEV_RULE}"
            findings.append(Finding("warning", subject, text, remedy))
    return findings
