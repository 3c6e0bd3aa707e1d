"""Pictures and sounds that come with woz-tui: commands and logs have names, drivers get files.

A name is `woz:waiting.gif`. Where woz-tui is installed is nobody's business who reads a log, and a
wizard cannot read a screen that shows a long path.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path

from woz_tui.drivers.contract import Verb
from woz_tui.protocol.messages import Json

FOLDER = Path(__file__).parent / "media"
_SCHEME = "woz:"
_IN_PATHS = "woz_tui/drivers/media/"
#: The folder as it may be written: whole, or from the experiment's folder, which may stand before
#: it; folders may have blanks. Last, as another computer may tell it.
_ENDS = "|".join(
    re.escape("/".join(folder.parts[at:]))
    for folder in dict.fromkeys((FOLDER, FOLDER.resolve()))
    for at in range(1, len(folder.parts) - 2)
)
_FILE = re.compile(
    rf"(?:(?:(?<![^\s'\"])/[^'\"\n]*?/)?(?:\.\./)+|/)(?:{_ENDS})/([\w-]+\.\w+)"
    rf"|[^\s'\"]*{_IN_PATHS}([\w-]+\.\w+)"
)


def name_of(file: str) -> str:
    """What messages call one of these files."""
    return _SCHEME + file


def located(verb: Verb, args: Mapping[str, Json], folder: Path) -> Mapping[str, Json]:
    """`args` as a driver gets them: files by their way from `folder`, like all others."""
    names = [argument.name for argument in verb.arguments if argument.kind == "file"]
    found = {name: value for name in names if _is_name(value := args.get(name))}
    ways = {name: _way(folder, str(value)) for name, value in found.items()}
    return {**args, **ways} if ways else args


def named_text(text: str) -> str:
    """A text of a driver, with the names of these files instead of their ways."""
    return _FILE.sub(_name, text) if _IN_PATHS in text else text


def named(value: Json) -> Json:
    """The same of all texts in a value."""
    match value:
        case str():
            return named_text(value)
        case list():
            return [named(one) for one in value]
        case dict():
            return {name: named(one) for name, one in value.items()}
    return value


def _name(match: re.Match[str]) -> str:
    return name_of(match[1] or match[2])


def _is_name(value: Json) -> bool:
    return isinstance(value, str) and value.startswith(_SCHEME)


def _way(folder: Path, name: str) -> str:
    file = FOLDER.resolve() / Path(name.removeprefix(_SCHEME)).name
    return os.path.relpath(file, folder.resolve())
