"""`woz doctor` for the devices of `woz hands`: looks, opens nothing."""

from __future__ import annotations

import os

from woz_drivers.hands.device_models import GAMEPAD, IMU, SPACEMOUSE, STREAM_DECK
from woz_drivers.hands.event_listing import other_kind, present_event_devices
from woz_drivers.hands.gamepad import device_name, present_gamepads
from woz_drivers.hands.settings import HandsSettings
from woz_drivers.hands.spacemouse import present_socket
from woz_drivers.hands.stream_deck import find_decks
from woz_drivers.lines.serial_line import present_ports
from woz_tui.drivers.contract import DeviceLostError, Finding


def examine(subject: str, settings: HandsSettings) -> list[Finding]:
    """What there is to say; never raises."""
    if not settings.controls:
        text, remedy = "no control does anything", "see docs/how-to/hands.md"
        return [Finding("warning", subject, text, remedy)]
    found = _found(subject, settings.device)
    if not found:
        text = f"no {settings.device} is plugged in at this computer"
        remedy = "woz hands --to ROBOT reads one of the wizard's computer"
        found = [Finding("info", subject, text, remedy)]
    return [Finding("ok", subject, f"{len(settings.controls)} controls do something"), *found]


def _found(subject: str, device: str) -> list[Finding]:
    """The devices of this kind that are plugged in."""
    if device == STREAM_DECK:
        return _decks(subject)
    if device == IMU:
        remedy = "say which one is the sensor: woz hands --device PORT"
        return [Finding("info", subject, port, remedy) for port in present_ports()]
    if device == SPACEMOUSE and (socket := present_socket()):
        return [Finding("info", subject, f"{socket}: spacenavd reads 6-D mice")]
    if device == GAMEPAD:
        named = {path: device_name(path) for path in present_gamepads()}
        there = {path: name for path, name in named.items() if not other_kind(name)}
    else:
        there = {each.path: each.name for each in present_event_devices() if each.kind == device}
    return [_readable(subject, path, name or device) for path, name in there.items()]


def _readable(subject: str, path: str, name: str) -> Finding:
    if os.access(path, os.R_OK):
        return Finding("info", subject, f"{path}: {name}")
    remedy = "sudo usermod -aG input $USER, then log out and in again"
    return Finding("warning", subject, f"{path}: {name}, but you may not read it", remedy)


def _decks(subject: str) -> list[Finding]:
    try:
        return [Finding("info", subject, str(deck.deck_type())) for deck in find_decks()]
    except DeviceLostError as error:
        return [Finding("info", subject, error.what, error.remedy)]
