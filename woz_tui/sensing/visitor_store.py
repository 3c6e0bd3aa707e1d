"""The store of visitors: one JSON file, `visitors.json`, beside the logs unless told otherwise.

    visitors = VisitorStore(path)
    visitors.add("Anna", on=today, age_group="adult", label="face-7")   VisitorRefusedError if taken
    visitors.find("anna"), visitors.called("face-7")                    -> Visitor | None
    visitors.met("Anna", on=today)

Several processes may work on one file: every change takes a lock, is made on what the file holds
at that moment and replaces it as a whole, readable for its owner only. What is read is read again
when the file has changed. A file that cannot be read is never written. If a change cannot be
written (disk full, no rights, damaged file, lock held by a process that hangs), the caller gets
`UnsavedError`; the change holds here and is written with the next one, or by `save`.
What does not go together with what others wrote meanwhile is in `given_up` then.

Calls may wait for the disk, and up to two seconds for the lock; they may come from any thread.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import threading
from collections.abc import Iterable, Iterator
from datetime import date
from pathlib import Path

from msgspec.structs import replace

from woz_tui.config.visitor_names import VisitorNameError, key_of, label_of, name_of, word_of
from woz_tui.sensing import visitor_records as changes
from woz_tui.sensing.visitor_records import (
    Change,
    People,
    UnsavedError,
    Visitor,
    VisitorFileError,
    VisitorRefusedError,
    VisitorsError,
)
from woz_tui.system import files

__all__ = [
    "UnsavedError",
    "Visitor",
    "VisitorFileError",
    "VisitorRefusedError",
    "VisitorStore",
    "VisitorsError",
]

#: The file's name where no other is given.
FILE = "visitors.json"
#: Only the owner reads and writes it.
_MODE = 0o600
#: A file longer than this is none of ours, in bytes.
_LONGEST = 50_000_000
#: How long a change waits for another process, in seconds.
_PATIENCE = 2.0

_Stamp = tuple[int, int, int] | None


def store_at(named: str, logs: Path) -> Path:
    """The store's file: the one that an experiment names, or that in the folder `logs`."""
    return Path(named) if named else logs / FILE


class VisitorStore:
    """The visitors in the file at `path`; it need not be there yet.

    Names may be given in any letter case. Methods that change something return the visitor as they
    are then, and raise `VisitorRefusedError` (the change does not fit, nothing happened) or
    `UnsavedError` (it holds in this process only). All may raise `VisitorFileError` as long as the
    file was never read successfully.
    """

    def __init__(self, path: Path, *, patience: float = _PATIENCE) -> None:
        self.path = path
        self._patience = patience
        self._thread = threading.RLock()
        self._people: People = {}
        self._stamp: _Stamp = None
        self._was_read = False
        self._pending: list[Change] = []
        #: Sentences about changes that waited for the disk until others had written something with
        #: which they do not go together. Whoever has shown them may clear it.
        self.given_up: list[str] = []

    # -- looking --------------------------------------------------------------------------------

    def everybody(self) -> list[Visitor]:
        """Everybody, by name."""
        with self._thread:
            self._refresh()
            return changes.sorted_by_name(self._people.values())

    def find(self, name: str) -> Visitor | None:
        """The visitor of this name, in any letter case."""
        with self._thread:
            self._refresh()
            return self._people.get(key_of(name))

    def called(self, label: str) -> Visitor | None:
        """Whom a recogniser means: whose label it is, else whose name."""
        with self._thread:
            self._refresh()
            return changes.owner_of(self._people, label)

    def is_taken(self, name: str) -> bool:
        """Whether a new visitor could not have this name."""
        return self.called(name) is not None

    @property
    def unsaved(self) -> int:
        """How many changes are not in the file."""
        return len(self._pending)

    # -- changing -------------------------------------------------------------------------------

    def add(
        self, name: str, *, on: date | None, age_group: str = "", address: str = "", label: str = ""
    ) -> Visitor:
        """Somebody new, met for the first time on that day; None: not met yet."""
        with _bad_names_refused():
            visitor = Visitor(
                name_of(name),
                word_of(age_group, "an age group"),
                word_of(address, "a form of address"),
                (label_of(label),) if label else (),
            )
        if on is not None:
            day = on.isoformat()
            visitor = replace(visitor, first_met=day, last_met=day, meetings=1)
        return self._change(changes.added(visitor), visitor.name)

    def met(self, name: str, *, on: date) -> Visitor:
        """They came again."""
        return self._change(changes.met(name, on), name)

    def learn(self, name: str, label: str) -> Visitor:
        """A recogniser will call their face `label` from now on."""
        with _bad_names_refused():
            return self._change(changes.labelled(name, label_of(label)), name)

    def profile(
        self,
        name: str,
        *,
        age_group: str | None = None,
        address: str | None = None,
        label: str | None = None,
        anew: bool = False,
    ) -> Visitor:
        """What is known of them, in one change; None leaves a fact as it is, "" takes it away.
        Where another value stands it is refused, unless `anew` says that this one shall replace it.
        A label comes to those that are there.
        """
        given = {"age_group": age_group, "address": address}
        with _bad_names_refused():
            facts = {
                fact: word_of(word, f"the {fact.replace('_', ' ')}")
                for fact, word in given.items()
                if word is not None
            }
            face = label_of(label) if label is not None else None
        change = changes.profiled(name, facts, anew=anew)
        if face is not None:
            change = changes.both(change, changes.labelled(name, face))
        return self._change(change, name)

    def rename(self, old: str, new: str, *, label: str | None = None) -> Visitor:
        """Give them another name, and a label of their face; profile, meetings and labels stay."""
        with _bad_names_refused():
            name = name_of(new)
            change = changes.renamed(old, name)
            if label is not None:
                change = changes.both(change, changes.labelled(name, label_of(label)))
        return self._change(change, name)

    def forget(self, *names: str) -> None:
        """Remove all there is of them, in one change; refused if somebody is not there."""
        self._change(changes.forgotten(*names), "")

    def save(self) -> None:
        """Try once more to write what is not in the file. `UnsavedError` if it fails again."""
        with self._thread:
            if self._pending:
                self._write(None)

    # -- how a change gets into the file --------------------------------------------------------

    def _change(self, change: Change, name: str) -> Visitor:
        with self._thread:
            try:
                self._write(change)
            except UnsavedError:
                self._people = change(self._people)
                self._pending.append(change)
                raise
            return self._people.get(key_of(name)) or Visitor(name)

    def _write(self, change: Change | None) -> None:
        """Make the pending changes and this one on what the file holds, and write it."""
        try:
            with files.locked(self.path, self._patience) as path:
                stored, _ = _read(path)
                self._was_read = True
                people, misfits = _made(self._pending, stored)
                people = change(people) if change is not None else people
                files.sweep(path)
                files.replace(path, changes.file_text(people), mode=_MODE)
                stamp = _stamp(path)
        except (OSError, VisitorFileError) as error:
            if isinstance(error, VisitorFileError) and not self._was_read:
                raise
            raise _unsaved(self.path, error) from None
        self._people, self._stamp, self._pending = people, stamp, []
        self.given_up += misfits

    def _refresh(self) -> None:
        """Read the file if it is not the one that was read last."""
        path = files.real(self.path)
        if self._was_read and _stamp(path) == self._stamp:
            return
        try:
            stored, stamp = _read(path)
        except VisitorFileError:
            if not self._was_read:
                raise
            return
        self._people, _ = _made(self._pending, stored)
        self._stamp, self._was_read = stamp, True


def _made(pending: Iterable[Change], people: People) -> tuple[People, list[str]]:
    """The changes made one after the other; sentences about those that do not fit."""
    misfits = []
    for change in pending:
        try:
            people = change(people)
        except VisitorRefusedError as error:
            misfits.append(f"a change that could not be saved before was given up: {error.reason}")
    return people, misfits


@contextlib.contextmanager
def _bad_names_refused() -> Iterator[None]:
    try:
        yield
    except VisitorNameError as error:
        raise VisitorRefusedError(error.reason, error.remedy) from None


# -- the disk -----------------------------------------------------------------------------------


def _read(path: Path) -> tuple[People, _Stamp]:
    """What the file holds, and which file that was. No file: nobody."""
    try:
        about = path.stat()
        if not stat.S_ISREG(about.st_mode) or about.st_size > _LONGEST:
            raise VisitorFileError(f"{path}: not a file of visitors", "name another file")
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        return {}, None
    except UnicodeDecodeError as error:
        reason = f"{path}: byte {error.start} is not UTF-8"
        raise VisitorFileError(reason, changes.MEND) from None
    except OSError as error:
        reason = f"cannot be read: {error.strerror}: {path}"
        raise VisitorFileError(reason, "see to its rights, or name another file") from None
    return changes.visitors_in(text, str(path)), _stamp_of(about)


def _stamp(path: Path) -> _Stamp:
    try:
        return _stamp_of(path.stat())
    except OSError:
        return None


def _stamp_of(about: os.stat_result) -> _Stamp:
    return about.st_ino, about.st_mtime_ns, about.st_size


def _unsaved(path: Path, error: OSError | VisitorFileError) -> UnsavedError:
    if isinstance(error, VisitorFileError):
        return UnsavedError(error.reason, error.remedy)
    remedies = {
        errno.ENOSPC: "free some space on the disk",
        errno.EDQUOT: "free some of your space on the disk",
        errno.EROFS: "name a file on a disk that can be written",
        errno.ETIMEDOUT: "end the process that hangs, or wait for it",
    }
    remedy = remedies.get(error.errno or 0, "see to the folder's rights, or name another file")
    return UnsavedError(f"cannot be written: {error.strerror or error}: {path}", remedy)
