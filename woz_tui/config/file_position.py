"""Where something stands in a file, and what is wrong with it there."""

from __future__ import annotations

from dataclasses import dataclass

from woz_tui.protocol.sentence import Sentence


@dataclass(frozen=True, slots=True)
class FilePosition:
    """Where something stands: file, line and column, both counted from 1."""

    file: str
    line: int
    column: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


#: Where what was not read from a file stands.
NOWHERE = FilePosition("", 0, 0)


@dataclass(frozen=True, slots=True)
class Problem:
    """One error or warning in a file; `where` says its `path` in words, where there are any.

    `message` is a `Sentence` where it is the program's own, and a plain text where a driver or the
    parser of a file's language says it.
    """

    place: FilePosition
    path: str
    message: str
    warning: bool = False
    where: str = ""

    @property
    def sentence(self) -> Sentence:
        """The problem with its place, as people read it."""
        values = {
            "place": str(self.place),
            "where": self.where or self.path,
            "message": self.message,
        }
        if self.warning:
            return Sentence("check.warning", "{place}: warning: {where}: {message}", **values)
        return Sentence("check.error", "{place}: {where}: {message}", **values)

    def in_line(self, what: str) -> Sentence:
        """The problem in a sentence about the experiment file, which everybody knows."""
        return Sentence(
            "check.in_line",
            "line {line}, {what}: {message}",
            line=self.place.line,
            what=what,
            message=self.message,
        )

    def __str__(self) -> str:
        return str(self.sentence)


class ExperimentError(Exception):
    """The file cannot be used; `problems` holds every reason, sorted by place."""

    def __init__(self, problems: list[Problem]) -> None:
        super().__init__("\n".join(map(str, problems)))
        self.problems = problems
