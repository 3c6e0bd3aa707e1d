"""Problems of a translated file, told by the names that the file itself has.

The decoder reads a tree of our own format and says `panels[0].actions[2].say`; whoever wrote the
file knows `animated_speech[2].string`. Both have the same place, which finds the name.
"""

from __future__ import annotations

from woz_tui.experiment.report import Report
from woz_tui.experiment.shape import Place


class OwnNames(Report):
    """A report that learns names while the original is read, and uses them from `done` on."""

    def __init__(self) -> None:
        super().__init__()
        self._names: dict[Place, str] = {}
        self._reading = True

    def done(self) -> None:
        """The original has been read; what comes now has paths of our own format."""
        self._reading = False

    def put(self, path: str, place: Place) -> None:
        """Remember where `path` stands. An entry of a list has its first key's place: the entry
        comes first and names it. The file's first place is also that of whatever comes from nowhere
        in it, and so names nothing.
        """
        super().put(path, place)
        if self._reading and (place.line, place.column) != (1, 1):
            self._names.setdefault(place, path)

    def error(self, place: Place, path: str, message: str) -> None:
        """One more reason why the file cannot be used."""
        super().error(place, self._named(place, path), message)

    def missing(self, place: Place, path: str, message: str, absent: str) -> None:
        """Like `error`; not shown if what is missing is there misspelt."""
        super().missing(place, self._named(place, path), message, absent)

    def warning(self, place: Place, path: str, message: str) -> None:
        """Something that works but is probably not meant."""
        super().warning(place, self._named(place, path), message)

    def _named(self, place: Place, path: str) -> str:
        return path if self._reading else self._names.get(place, path)
