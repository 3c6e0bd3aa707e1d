"""Files of features that `woz new` lists and copies."""

from __future__ import annotations

import shutil
import textwrap
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from woz_tui.analysis.text_format import counted, listed
from woz_tui.config.problems import hint


@dataclass(frozen=True, slots=True)
class CopiedFile:
    """A file that comes with woz-tui. `about`: a line for the list; `then`: lines on what to do
    with it, once it is copied to a place that stands for `{file}` in them.
    """

    path: Path
    about: str
    then: Sequence[str] = ()

    @property
    def name(self) -> str:
        """As it is asked for."""
        return self.path.stem


class FeatureFiles(ABC):
    """Files of a feature. `flag` is the option of `woz new` that takes the name of one of them, and
    lists them without a name; `what` is one of them in a word, `help` the option's help.
    """

    flag: ClassVar[str]
    what: ClassVar[str]
    help: ClassVar[str]

    @abstractmethod
    def files(self) -> Sequence[CopiedFile]:
        """All of them, in the order of the list."""

    @property
    def dest(self) -> str:
        """The option's name among the arguments that were read."""
        return self.flag.removeprefix("--").replace("-", "_")

    def run(self, name: str, to: Path | None) -> tuple[int, str]:
        """List the files, or copy one of them; the exit code, and what to say."""
        files = self.files()
        if not name:
            width = max(len(each.name) for each in files)
            rows = [_wrapped(f"  {each.name:<{width}}  {each.about}", width + 4) for each in files]
            head = f"{counted(len(files), self.what)}; copy one: woz new {self.flag} NAME [FILE]"
            return 0, "\n".join([head, *rows])
        found = next((each for each in files if each.name == name), None)
        if found is None:
            names = [each.name for each in files]
            near = hint(name, names) or f"; there are {listed(names)}"
            return 1, f"there is no {self.what} {name!r}{near}"
        path = Path(found.path.name if to is None else to)
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with path.open("x", encoding="utf-8") as file:
                file.write(found.path.read_text(encoding="utf-8"))
        except FileExistsError:
            return 1, f"{path} is there already; choose another name"
        then = (line.replace("{file}", path.name) for line in found.then)
        return 0, "\n".join([f"{path}: written.", *(_wrapped(f"  {line}", 4) for line in then)])


def _wrapped(line: str, indent: int) -> str:
    """A line in as many as the terminal needs; no word is cut, so that a link stays one."""
    return textwrap.fill(
        line,
        shutil.get_terminal_size().columns,
        subsequent_indent=" " * indent,
        break_long_words=False,
        break_on_hyphens=False,
    )
