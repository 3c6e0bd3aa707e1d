"""`woz doctor --bundle FILE`: what a report needs, without names, addresses and words."""

from __future__ import annotations

import getpass
import platform
import re
import zipfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from woz_tui.cli.safe_streams import json_text
from woz_tui.drivers import plugins
from woz_tui.system.addresses import without_passwords
from woz_tui.system.provenance import software

_README = """\
Made by `woz doctor --bundle`, to be sent with a report. Look into it first.

doctor.json    what `woz doctor` found
software.json  versions of woz-tui, Python and libraries

Left out are all logs, the experiment's text but what a finding quotes, and in both files: the
names of the user and of the computer, the home folder, passwords and addresses of a network.
A log without words and dates: woz export LOG --to jsonl --redact-text --out FOLDER
"""
#: Those of this computer itself and of none tell nothing.
_ADDRESS = re.compile(r"\b(?!127\.|0\.0\.0\.0)(?:\d{1,3}\.){3}\d{1,3}\b")
_ADDRESS_6 = re.compile(
    r"(?<![\w:])(?:(?:[0-9a-f]{0,4}:){3,7}|[0-9a-f]{1,4}::)[0-9a-f]{1,4}(?![\w:])", re.IGNORECASE
)
_MAIL = re.compile(r"[\w.+-]+@[\w-]+\.[\w.-]+")


@dataclass(frozen=True, slots=True)
class Hiding:
    """Takes out what tells who and where it was: folder, user and computer are called by words."""

    home: str
    user: str
    computer: str

    @classmethod
    def of_here(cls) -> Hiding:
        """Of who runs this."""
        try:
            user = getpass.getuser()
        except (KeyError, OSError):  # a number without a name
            user = ""
        return cls(str(Path.home()), user, platform.node())

    def __call__(self, text: str) -> str:
        """`text` without them."""
        text = without_passwords(text)
        if self.home not in ("", "/"):
            text = text.replace(self.home, "~")
        for name, word in ((self.computer, "COMPUTER"), (self.user, "USER")):
            if name and name not in ("root", "localhost"):
                text = re.sub(rf"(?<!\w){re.escape(name)}(?!\w)", word, text)
        text = _MAIL.sub("MAIL", text)
        return _ADDRESS_6.sub("ADDRESS", _ADDRESS.sub("ADDRESS", text))


def write_bundle(path: Path, findings: Iterable[dict[str, str]], hide: Hiding) -> None:
    """Write the file, which must not be there. Raises `OSError`."""
    clean = [{name: hide(value) for name, value in each.items()} for each in findings]
    with path.open("xb") as file, zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as bundle:
        bundle.writestr("README.txt", _README)
        bundle.writestr("doctor.json", json_text(clean, indent=2))
        told = {name: hide(value) for name, value in software(plugins.GROUP).items()}
        bundle.writestr("software.json", json_text(told, indent=2))
