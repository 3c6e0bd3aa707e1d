"""`woz doctor` for gamepads and Stream Decks: looks, opens nothing."""

from __future__ import annotations

import os

from woz_drivers.hands.device_models import GAMEPAD
from woz_drivers.hands.gamepad import device_name, present_gamepads
from woz_drivers.hands.settings import HandsSettings
from woz_drivers.hands.stream_deck import find_decks
from woz_tui.drivers.contract import DeviceLostError, Finding


def examine(subject: str, settings: HandsSettings) -> list[Finding]:
    """What there is to say; never raises."""
    if not settings.controls:
        text, remedy = "no control does anything", "see docs/how-to/hands.md"
        return [Finding("warning", subject, text, remedy)]
    found = _gamepads(subject) if settings.device == GAMEPAD else _decks(subject)
    if not found:
        text = f"no {settings.device} is plugged in at this computer"
        remedy = "woz hands --to ROBOT reads one of the wizard's computer"
        found = [Finding("info", subject, text, remedy)]
    return [Finding("ok", subject, f"{len(settings.controls)} controls do something"), *found]


def _gamepads(subject: str) -> list[Finding]:
    found = []
    for path in present_gamepads():
        name = f"{path}: {device_name(path) or 'a gamepad'}"
        if os.access(path, os.R_OK):
            found.append(Finding("info", subject, name))
        else:
            remedy = "sudo usermod -aG input $USER, then log out and in again"
            found.append(Finding("warning", subject, f"{name}, but you may not read it", remedy))
    return found


def _decks(subject: str) -> list[Finding]:
    try:
        return [Finding("info", subject, str(deck.deck_type())) for deck in find_decks()]
    except DeviceLostError as error:
        return [Finding("info", subject, error.what, error.remedy)]
