"""What can be said of a `screen` that is only written."""

from __future__ import annotations

from collections.abc import Iterator

from woz_drivers.naoqi_robot.served_files import is_address
from woz_drivers.naoqi_robot.text_remarks import WrittenValue
from woz_drivers.pepper.settings import PepperSettings
from woz_drivers.pepper.tablet_page import REMEDY, kind, places


def shown(argument: WrittenValue) -> Iterator[tuple[str, str]]:
    """Whether the tablet can show it: `off` is the default."""
    text = argument.text
    if text.strip() in ("", "off"):
        return
    kind(text)
    if is_address(text):
        return
    assert isinstance(argument.settings, PepperSettings)
    paths = places(text, argument.settings.tablet.root, argument.folder)
    if not any(path.is_file() for path in paths):
        # Without this machine's folders, which `perform` names: warnings are shown around.
        yield f"there is no file {text!r}", REMEDY
