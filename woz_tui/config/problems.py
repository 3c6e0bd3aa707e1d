"""Collects everything that is wrong with a file, and where each thing of it stands."""

from __future__ import annotations

import contextlib
import difflib
import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from woz_tui.config.file_position import ExperimentError, FilePosition, Problem
from woz_tui.drivers.secret_arguments import without_passwords
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:
    from woz_tui.config.file_text import SourceFile

#: A file with more errors than this is another kind of file; the rest is counted, not listed.
MAX_PROBLEMS = 200
#: A longer list of choices helps nobody in a terminal; one of keys is all there is to read of them.
MAX_LISTED, MAX_KEYS_LISTED = 14, 30
#: Characters of a panel's or an action's name in a place.
MAX_TITLE = 40
_ACTION = re.compile(r"(panels\[\d+\])(\.actions\[\d+\])?(?=\.|$)")
#: Words among which a near one is looked for.
MAX_COMPARED = 500


class ProblemReport:
    """Problems and places of one experiment and the files it names."""

    def __init__(self) -> None:
        self._problems: dict[Problem, None] = {}
        self._files: dict[str, int] = {}
        self._places: dict[tuple[str, str], FilePosition] = {}
        #: Problems that say what is missing, by file and path of it; and what was there, misspelt.
        self._missing: dict[Problem, tuple[str, str]] = {}
        self._misspelt: set[tuple[str, str]] = set()
        self._messages: set[tuple[FilePosition, str]] = set()
        #: What may be behind an error at a place; what panels and actions are called.
        self._explanations: dict[FilePosition, str] = {}
        self._titles: dict[tuple[str, str], str] = {}
        #: Files that settings stand in, in the order in which they were read.
        self.included: list[SourceFile] = []
        self._lenient = False

    @contextlib.contextmanager
    def lenient(self, active: bool = True) -> Iterator[None]:
        """Inside, what would be an error is a warning."""
        self._lenient = active
        try:
            yield
        finally:
            self._lenient = False

    def file(self, name: str) -> None:
        """Files are reported in the order in which they were read."""
        self._files.setdefault(name, len(self._files))

    def set_place(self, path: str, place: FilePosition) -> None:
        """Remember where `path` stands in its file."""
        self._places[place.file, path] = place

    def explain(self, place: FilePosition, why: str) -> None:
        """Whatever is wrong here may be so because of this."""
        self._explanations.setdefault(place, why)

    def set_title(self, path: str, file: str, title: str) -> None:
        """Remember what the entry of a list is called, for whoever reads of a problem in it."""
        if title and path.endswith("]"):
            self._titles[file, path] = title

    def has_place(self, path: str, file: str) -> bool:
        """Whether `path` itself stands in this file."""
        return (file, path) in self._places

    def place(self, path: str, file: str | None = None) -> FilePosition:
        """Where `path` stands, or the nearest thing that holds it.

        `file` is a name as reported; without it the first file read is meant.
        """
        name = next(iter(self._files), "") if file is None else file
        while (name, path) not in self._places:
            cut = max(path.rfind("."), path.rfind("["))
            if cut < 0:
                return FilePosition(name, 1, 1)
            path = path[:cut]
        return self._places[name, path]

    def error(self, place: FilePosition, path: str, message: str) -> None:
        """One more reason why the file cannot be used."""
        self._add(place, path, message)

    def error_at(self, path: str, message: str, file: str | None = None) -> None:
        """`error` where `path` stands."""
        self.error(self.place(path, file), path, message)

    def warning_at(self, path: str, message: str) -> None:
        """`warning` where `path` stands."""
        self.warning(self.place(path), path, message)

    def missing(self, place: FilePosition, path: str, message: str, absent: str) -> None:
        """Like `error`; not shown if `absent`, the path of what is missing, is there misspelt."""
        self._missing[self._add(place, path, message)] = (place.file, absent)

    def misspelt(self, file: str, path: str) -> None:
        """`path` is there after all under a name near to its own, which is reported as such."""
        self._misspelt.add((file, path))

    def warning(self, place: FilePosition, path: str, message: str) -> None:
        """Something that works but is probably not meant."""
        self._add(place, path, message, warning=True)

    def has_problem(self, place: FilePosition, message: str) -> bool:
        """Whether just this has been said of what stands there, by whatever name."""
        return (place, _printable(message)) in self._messages

    @property
    def errors(self) -> list[Problem]:
        """Every error so far, sorted by place."""
        return [
            self._in_words(problem)
            for problem in self._sorted(warning=False)
            if self._missing.get(problem) not in self._misspelt
        ]

    @property
    def warnings(self) -> list[Problem]:
        """Every warning so far, sorted by place."""
        return [*map(self._in_words, self._sorted(warning=True))]

    def hint(self, wrong: str, known: Iterable[str], *, or_list: str = "") -> str:
        """`; did you mean 'x'?` for the nearest known word.

        Without a near one `; <or_list>: a, b, c`, if `or_list` is given.
        """
        words = list(known)
        near = self.nearest(wrong, words)
        if near is not None:
            return did_you_mean(near)
        return self.choices(or_list, words) if or_list else ""

    def choices(self, what: str, words: Iterable[str], most: int = MAX_LISTED) -> str:
        """`; <what>: a, b, c`, as long as anybody will read it."""
        shown = "" if self.has_too_many else listed(words, most)
        if not shown:
            return ""
        return Sentence("check.choices", "; {what}: {words}", what=what, words=shown)

    def nearest(self, wrong: str, known: Iterable[str]) -> str | None:
        """The known word that was probably meant, as long as anybody will read it: looking for
        near words takes its time.
        """
        return None if self.has_too_many else nearest_word(wrong, known)

    @property
    def has_too_many(self) -> bool:
        """Whether there is more than anybody will read: what takes its time is left out then."""
        return len(self._problems) > MAX_PROBLEMS

    def raise_errors(self) -> None:
        """Raise `ExperimentError` if there was any error."""
        errors = self.errors
        if len(errors) > MAX_PROBLEMS:
            last = errors[MAX_PROBLEMS]
            rest = Sentence(
                "check.more_errors",
                "and {count} more errors",
                one="and 1 more error",
                count=len(errors) - MAX_PROBLEMS,
            )
            errors = [*errors[:MAX_PROBLEMS], Problem(last.place, last.path, rest)]
        if errors:
            raise ExperimentError(errors)

    def _add(
        self, place: FilePosition, path: str, message: str, *, warning: bool = False
    ) -> Problem:
        name = _printable(self._named(place, path)) or "file"
        if not warning and (why := self._explanations.get(place)) and why not in message:
            message = with_remedy(message, why)
        problem = Problem(place, name, _printable(message), warning or self._lenient)
        self._problems.setdefault(problem)
        self._messages.add((place, problem.message))
        return problem

    def _named(self, place: FilePosition, path: str) -> str:
        """What stands there by the name that the file itself has for it."""
        return path

    def _sorted(self, *, warning: bool) -> list[Problem]:
        def rank(problem: Problem) -> tuple[int, int, int, str]:
            place = problem.place
            return (self._files.get(place.file, 0), place.line, place.column, problem.path)

        return sorted((p for p in self._problems if p.warning is warning), key=rank)

    def _in_words(self, problem: Problem) -> Problem:
        """The same with its place by the names of panel and action: `Any time > Wait please`."""
        found = _ACTION.match(problem.path)
        if found is None:
            return problem
        panel, action = (found[1], found[1] + (found[2] or ""))
        titles = [self._titles.get((problem.place.file, path), "") for path in (panel, action)]
        if not titles[0] or (found[2] and not titles[1]):
            return problem
        names = titles[: 2 if found[2] else 1]
        rest = problem.path[len(action) :].lstrip(".")
        words = [_printable(shortened(name, MAX_TITLE)) for name in names] + [rest] * bool(rest)
        return replace(problem, where=" > ".join(words))


def _printable(text: str) -> str:
    """Names in a file may hold anything; a line of a report may not. It is read by others, too."""
    if isinstance(text, Sentence):
        return text.cleaned(_printable)
    text = without_passwords(text)
    if text.isprintable():
        return text
    return "".join(
        sign if sign.isprintable() else sign.encode("unicode_escape").decode() for sign in text
    )


def join(path: str, name: str) -> str:
    """The path of the entry `name` below `path`."""
    return f"{path}.{name}" if path else name


def hint(wrong: str, known: Iterable[str]) -> str:
    """`; did you mean 'x'?` for the nearest known word, or nothing."""
    near = nearest_word(wrong, known)
    return "" if near is None else did_you_mean(near)


def with_remedy(text: str, remedy: str) -> str:
    """`what is wrong; what helps`, or why it may be so."""
    if not remedy:
        return text
    return Sentence("check.with_remedy", "{text}; {remedy}", text=text, remedy=remedy)


def either(words: Iterable[str]) -> str:
    """`a or b or c`."""
    first, *others = words
    for other in others:
        first = Sentence("check.either", "{first} or {other}", first=first, other=other)
    return first


def together(words: Iterable[str]) -> str:
    """`a and b and c`."""
    first, *others = words
    for other in others:
        first = Sentence("check.together", "{first} and {other}", first=first, other=other)
    return first


def did_you_mean(near: str) -> Sentence:
    """`; did you mean 'x'?`, behind what is wrong."""
    return Sentence("check.did_you_mean", "; did you mean {near!r}?", near=near)


#: Words that people write for ours, by ours.
_MEANT: dict[str, list[str]] = msgspec.json.decode(
    Path(__file__).with_name("common_words.json").read_bytes()
)


def nearest_word(wrong: str, known: Iterable[str]) -> str | None:
    """The known word that was probably meant, if one means the same or is near enough."""
    words = list(dict.fromkeys(known))
    said = wrong.casefold().replace("-", "_")
    for ours, theirs in _MEANT.items():
        if said in theirs and ours in words and said not in words:
            return ours
    folded = {word.casefold(): word for word in reversed(words[:MAX_COMPARED])}
    near = difflib.get_close_matches(wrong.casefold()[:80], folded, n=1, cutoff=0.6)
    return folded[near[0]] if near else None


def listed(words: Iterable[str], most: int = MAX_LISTED) -> str:
    """`a, b, c`; if there are more than `most`, the first of them and dots."""
    shown = list(dict.fromkeys(words))
    if len(shown) <= most:
        return ", ".join(shown)
    return ", ".join(shown[:MAX_LISTED]) + ", ..."


def quoted(text: str, limit: int = 40) -> str:
    """`text` in quotes and on one line, shortened. A password goes while it is still whole."""
    return repr(shortened(without_passwords(text), limit))


def shortened(text: str, limit: int) -> str:
    """`text`, with dots for what is longer than `limit`."""
    return text if len(text) <= limit else text[: limit - 3].rstrip() + "..."
