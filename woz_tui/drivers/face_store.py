"""The faces that may be recognised: one file, readable for its owner only, outside of experiments.

A face is in it because its owner said yes, and until `woz visitors forget`. What is kept is a
template (numbers that a network makes of a picture), a name, the day of the consent and the log
that has it. Only programs that recognise faces, and `woz visitors`, open it.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Annotated

import msgspec

from woz_tui.drivers.contract import DriverError
from woz_tui.system import files
from woz_tui.system.user_folders import state_folder

FORMAT, VERSION = "woz-tui faces", 1
#: Of one person so many templates are kept, the newest ones.
_TEMPLATES = 5
#: How long a change waits for another process, in seconds.
_PATIENCE_S = 2.0
_MODE = 0o600


class KeptFace(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One person. `consented`: the day (2026-03-01); `log`: the session whose log has the consent.
    `templates`: numbers of 4 bytes each (little-endian), in base64.
    """

    name: str
    consented: str
    log: str
    templates: list[bytes]


class _File(msgspec.Struct, forbid_unknown_fields=True):
    format: str
    version: Annotated[int, msgspec.Meta(ge=1)]
    faces: list[KeptFace]


def default_path() -> Path:
    """`woz-tui/faces.json` in the user's state directory (XDG_STATE_HOME, or ~/.local/state)."""
    return state_folder() / "woz-tui" / "faces.json"


def key_of(name: str) -> str:
    """Equal for names that differ in letter case or blanks alone."""
    return " ".join(unicodedata.normalize("NFKC", name).casefold().split())


class FaceStore:
    """The faces in the file at `path`, which need not be there. All raise `DriverError`: the file
    cannot be read or written, or it is none of ours.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._read_as: tuple[int, int, int] | None = None
        self._faces: list[KeptFace] = []

    def faces(self) -> list[KeptFace]:
        """Everybody in it, as the file is now."""
        self._refresh()
        return self._faces

    def learn(self, name: str, template: bytes, consented: str, log: str) -> None:
        """Keep a template of this person, beside those that are there."""

        def learnt(faces: list[KeptFace]) -> list[KeptFace]:
            before = [one for one in faces if key_of(one.name) == key_of(name)]
            others = [one for one in faces if key_of(one.name) != key_of(name)]
            old = [kept for one in before for kept in one.templates]
            templates = [*old, template][-_TEMPLATES:]
            # The name stays as it was written first.
            return [
                *others,
                KeptFace(before[0].name if before else name, consented, log, templates),
            ]

        self._change(learnt)

    def forget(self, names: Iterable[str]) -> list[str]:
        """Remove all there is of these people; the names of those who were there."""
        keys = {key_of(name) for name in names}
        gone: list[str] = []

        def left(faces: list[KeptFace]) -> list[KeptFace]:
            gone[:] = [one.name for one in faces if key_of(one.name) in keys]
            return [one for one in faces if key_of(one.name) not in keys]

        if any(key_of(one.name) in keys for one in self.faces()):
            self._change(left)
        return gone

    # -- the file ----------------------------------------------------------------------------------

    def _change(self, change: Callable[[list[KeptFace]], list[KeptFace]]) -> None:
        try:
            with files.locked(self.path, _PATIENCE_S) as path:
                faces = change(self._read())
                file = _File(FORMAT, VERSION, sorted(faces, key=lambda one: key_of(one.name)))
                files.sweep(path)
                text = msgspec.json.format(msgspec.json.encode(file)).decode() + "\n"
                files.replace(path, text, mode=_MODE)
        except OSError as error:
            reason = error.strerror or error
            raise DriverError(
                f"{self.path} cannot be written: {reason}", "see to the disk"
            ) from None
        self._refresh()

    def _refresh(self) -> None:
        """Read it if it is another file than the one that was read last."""
        try:
            about = self.path.stat()
            stamp = (about.st_ino, about.st_mtime_ns, about.st_size)
        except OSError:
            stamp = None
        if stamp is None or stamp != self._read_as:
            self._faces = self._read()
            self._read_as = stamp

    def _read(self) -> list[KeptFace]:
        try:
            data = self.path.read_bytes()
        except FileNotFoundError:
            return []
        except OSError as error:
            raise DriverError(f"{self.path} cannot be read: {error.strerror}") from None
        try:
            file = msgspec.json.decode(data, type=_File)
            if (file.format, file.version) != (FORMAT, VERSION):
                raise ValueError(f"it is {file.format!r}, version {file.version}")
        except ValueError as error:
            raise DriverError(
                f"{self.path} is no file of faces: {error}", "move it away; it was left as it is"
            ) from None
        return file.faces
