"""Where something stands in a file, and what is wrong with it there."""

from __future__ import annotations

from dataclasses import dataclass


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
    """One error or warning in a file; `where` says its `path` in words, where there are any."""

    place: FilePosition
    path: str
    message: str
    warning: bool = False
    where: str = ""

    def __str__(self) -> str:
        warning = "warning: " if self.warning else ""
        return f"{self.place}: {warning}{self.where or self.path}: {self.message}"


class ExperimentError(Exception):
    """The file cannot be used; `problems` holds every reason, sorted by place."""

    def __init__(self, problems: list[Problem]) -> None:
        super().__init__("\n".join(map(str, problems)))
        self.problems = problems
