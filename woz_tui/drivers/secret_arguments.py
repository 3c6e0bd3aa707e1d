"""Removes passwords from commands before anything is recorded or sent.

A driver marks an argument with `Argument.hide`. The bus then takes what it hides out of every
command of that verb before the command is published, so neither the log nor a console nor the
driver itself ever has it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from woz_tui.protocol.messages import Json
from woz_tui.system import addresses
from woz_tui.system.addresses import HIDDEN

if TYPE_CHECKING:  # whoever quotes an address needs no driver
    from woz_tui.drivers.contract import Verb

__all__ = ["HIDDEN", "hidden", "without_passwords"]

Hide = Callable[[str], str]

#: `tcps://user:password@host`, also without the scheme; a password may hold an @ of its own. With
#: bounds, so that a text of any length is looked through quickly.
_PASSWORD = re.compile(
    r"""(?P<user>(?:[A-Za-z][\w+.-]{0,20}:/{1,3})?[^\s:/@'"]{0,100}:)(?!//)\S{0,200}@"""
)


def hidden(verb: Verb | None, args: Mapping[str, Json]) -> dict[str, Json]:
    """`args` without what the verb's arguments hide, wherever it stands: what is written under a
    wrong name is recorded, too.
    """
    hides = [one.hide for one in verb.arguments if one.hide is not None] if verb else []
    if not hides:
        return dict(args)
    return {_text(name, hides): _value(value, hides) for name, value in args.items()}


def _value(value: Json, hides: list[Hide]) -> Json:
    match value:
        case str():
            return _text(value, hides)
        case list():
            return [_value(one, hides) for one in value]
        case dict():
            return {_text(name, hides): _value(one, hides) for name, one in value.items()}
    return value


def _text(text: str, hides: list[Hide]) -> str:
    for hide in hides:
        try:
            text = str(hide(text))
        except Exception:  # noqa: BLE001 - a stranger's code; what it cannot judge is not shown
            return HIDDEN
    return text


def without_passwords(text: str) -> str:
    """`text` without the passwords of addresses in it, for sentences that quote what was typed."""
    shown = addresses.without_passwords(text)
    if "@" not in shown:
        return shown
    return _PASSWORD.sub(lambda found: f"{found['user']}{HIDDEN}@", shown)
