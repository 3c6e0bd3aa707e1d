"""A YAML node with its path and the problem report, as decoders get it, and readers of values.

The readers here return None after they have reported what is wrong, so that a decoder goes on and
finds the other errors too.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from woz_tui.config.file_position import FilePosition
from woz_tui.config.file_text import SourceFile, SourceFileError, read_source
from woz_tui.config.problems import MAX_KEYS_LISTED, ProblemReport, did_you_mean, join, quoted
from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node, ScalarNode, described, parse_yaml
from woz_tui.drivers.fields import Range
from woz_tui.protocol.sentence import Sentence

_NUMBER = re.compile(r"[-+]?(\d{1,30}(\.\d{0,60})?|\.\d{1,60})([eE][-+]?\d{1,3})?")
_WHOLE = re.compile(r"[-+]?\d{1,18}")
_SECONDS = re.compile(rf"(?P<number>{_NUMBER.pattern})\s*(?P<unit>[a-zA-Z]*)")
_UNITS = {"": 1.0, "ms": 0.001, "s": 1.0, "sec": 1.0, "min": 60.0, "h": 3600.0}
_FLAGS = {
    **dict.fromkeys(("true", "yes", "on"), True),
    **dict.fromkeys(("false", "no", "off"), False),
}
#: Units of ranges that are words, behind a number.
_UNIT_WORDS = {
    "degrees": Sentence("check.degrees", " degrees"),
    "degrees/s": Sentence("check.degrees_s", " degrees/s"),
    "characters": Sentence("check.characters", " characters"),
}
#: What may be behind a list or a mapping where a text should be.
TEXT_WITH_BRACKET = Sentence(
    "check.text_with_bracket", "; if a text begins with a bracket, put the text in quotes"
)


def expectation(expected: str, found: str, near: str = "") -> Sentence:
    """`expected text, not a list`, and what may be behind it."""
    return Sentence(
        "check.expected",
        "expected {expected}, not {found}{near}",
        expected=expected,
        found=found,
        near=near,
    )


@dataclass(frozen=True, slots=True)
class Cursor:
    """One value in a file: its node, its path, where its name stands."""

    node: Node
    path: str
    place: FilePosition
    report: ProblemReport

    def error(self, message: str) -> None:
        """Something is wrong with this value."""
        self.report.error(self.place, self.path, message)

    def warning(self, message: str) -> None:
        """Something is odd about this value."""
        self.report.warning(self.place, self.path, message)

    def wrong(self, expected: str) -> None:
        """Something else is expected here."""
        self.error(expectation(expected, described(self.node)))

    def at(self, name: str, node: Node, place: FilePosition) -> Cursor:
        """The entry `name` of this mapping."""
        return self._child(join(self.path, name), node, place)

    def entries(self) -> Iterator[tuple[str, Cursor]]:
        """Names and values, if this is a mapping."""
        if isinstance(self.node, MappingNode):
            for name, key, node in self.node.items():
                yield name, self.at(name, node, key.place)

    def items(self) -> Iterator[Cursor]:
        """Each entry, if this is a list."""
        if isinstance(self.node, ListNode):
            for index, node in enumerate(self.node.nodes):
                yield self._child(f"{self.path}[{index}]", node, node.place)

    def table(self, expected: str = "a mapping") -> dict[str, Cursor] | None:
        """The mapping's entries by name."""
        if not isinstance(self.node, MappingNode):
            self.wrong(expected)
            return None
        return dict(self.entries())

    def fields(self, known: Collection[str], what: str, expected: str) -> dict[str, Cursor] | None:
        """The mapping's entries by name; those that are not `known` are reported."""
        table = self.table(expected)
        for name, entry in (table or {}).items():
            if name not in known:
                entry.unknown(known, what)
        return table

    def only(self, names: Collection[str]) -> Cursor:
        """The same mapping with these entries alone."""
        node = self.node
        if not isinstance(node, MappingNode):
            return self
        kept = {name: entry for name, entry in node.entries.items() if name in names}
        return Cursor(MappingNode(node.place, kept, node.keys), self.path, self.place, self.report)

    def list(self, expected: str = "a list") -> list[Cursor] | None:
        """The list's entries."""
        if not isinstance(self.node, ListNode):
            self.wrong(expected)
            return None
        return [*self.items()]

    def _child(self, path: str, node: Node, place: FilePosition) -> Cursor:
        self.report.set_place(path, place)
        return Cursor(node, path, place, self.report)

    def unknown(
        self, known: Iterable[str], what: str = "known here", listing: Iterable[str] | None = None
    ) -> None:
        """This entry's name means nothing here. Without a `known` one near to it, those of
        `listing` (by default `known`) are named.
        """
        words = list(known)
        parent, _, name = self.path.rpartition(".")
        empty = isinstance(self.node, ScalarNode) and self.node.is_empty
        if empty and any(map(str.isalpha, name)):  # `{participant}`, `{say: Hi, you}`
            self.report.explain(
                self.place,
                Sentence(
                    "check.if_part_of_text", "if this belongs to a text, put the text in quotes"
                ),
            )
        meant = self.report.nearest(name, words)
        if meant is None:
            named = words if listing is None else listing
            near = self.report.choices(what, named, MAX_KEYS_LISTED)
            self.error(Sentence("check.unknown", "unknown{near}", near=near))
            return
        self.report.misspelt(self.place.file, join(parent, meant))
        self.error(Sentence("check.unknown", "unknown{near}", near=did_you_mean(meant)))


def read_text(cursor: Cursor, expected: str = "text") -> str | None:
    """Text exactly as typed: `No`, `12:30` and `007` stay what they are."""
    if not isinstance(cursor.node, ScalarNode) or cursor.node.is_empty:
        bracket = not isinstance(cursor.node, ScalarNode)
        quotes = (
            TEXT_WITH_BRACKET if bracket and cursor.node.place.line == cursor.place.line else ""
        )
        cursor.error(expectation(expected, described(cursor.node), quotes))
        return None
    if "\0" in cursor.node.text:
        cursor.error(Sentence("check.nul", "text cannot contain a NUL character"))
        return None
    return cursor.node.text


def read_filled(cursor: Cursor | None) -> str | None:
    """Text that is more than blanks, if it is there; blanks are reported, and come back."""
    text = read_text(cursor) if cursor is not None else None
    if cursor is not None and text is not None and not text.strip():
        cursor.error(Sentence("check.empty", "is empty"))
    return text


def texts_of(cursor: Cursor | None) -> Iterator[tuple[Cursor, str]]:
    """A text, or those of a list, with where they stand; whatever else stands there is left out."""
    if cursor is not None:
        for entry in (*cursor.items(),) or (cursor,):
            text = entry.node.text if isinstance(entry.node, ScalarNode) else ""
            if text.strip():
                yield entry, text


def check_different(
    named: Iterable[tuple[Cursor, str]], what: str, keys: Sequence[str] = ("name",)
) -> None:
    """Report names that stand twice, at the first of the `keys` that an entry has."""
    first: dict[str, int] = {}
    for entry, name in named:
        if name and name in first:
            table = dict(entry.entries())
            next((table[key] for key in keys if key in table), entry).error(
                Sentence(
                    "check.name_taken",
                    "{name} is already the {key} of {what} (line {line}); give one of"
                    " them another {key}: ...",
                    name=quoted(name),
                    key=keys[0],
                    what=what,
                    line=first[name],
                )
            )
        first.setdefault(name, entry.place.line)


def one_of_words(words: Iterable[str]) -> Sentence:
    """`one of a, b, c`."""
    return Sentence("check.one_of", "one of {words}", words=", ".join(words))


def read_word(cursor: Cursor, choices: Iterable[str]) -> str | None:
    """One of `choices`."""
    words = tuple(choices)
    listed = one_of_words(words)
    text = read_text(
        cursor,
        listed if len(listed) < 120 else Sentence("check.known_words", "one of the known words"),
    )
    if text is None or text in words:
        return text
    near = cursor.report.hint(text, words, or_list=Sentence("check.it_can_be", "it can be"))
    cursor.error(
        Sentence("check.not_known", "{text} is not known{near}", text=quoted(text), near=near)
    )
    return None


def read_flag(cursor: Cursor) -> bool | None:
    """True or false, yes or no, on or off."""
    node = cursor.node
    if isinstance(node, ScalarNode) and (flag := _FLAGS.get(node.text.lower())) is not None:
        return flag
    cursor.wrong(Sentence("check.true_or_false", "true or false"))
    return None


def read_number(cursor: Cursor, allowed: Range | None = None) -> float | None:
    """A finite number inside `allowed`."""
    text = cursor.node.text if isinstance(cursor.node, ScalarNode) else ""
    expected = number_in(allowed or Range())
    if not _NUMBER.fullmatch(text):
        if _NUMBER.fullmatch(text.replace(",", ".", 1)):
            cursor.error(
                Sentence(
                    "check.decimal_point",
                    "write {number!r}: the decimal sign is a point",
                    number=text.replace(",", ".", 1),
                )
            )
        elif (number := _NUMBER.match(text)) and number.group():
            cursor.error(
                Sentence(
                    "check.number_alone",
                    "expected {expected} alone, not {text}",
                    expected=expected,
                    text=quoted(text),
                )
            )
        else:
            cursor.wrong(expected)
        return None
    return _inside(cursor, float(text), text, allowed)


def read_whole(cursor: Cursor, allowed: Range | None = None) -> int | None:
    """A whole number inside `allowed`."""
    text = cursor.node.text if isinstance(cursor.node, ScalarNode) else ""
    if not _WHOLE.fullmatch(text):
        cursor.wrong(
            Sentence("check.a_whole_number", "a whole number")
            if allowed is None
            else Sentence(
                "check.whole_number_in", "a whole number ({allowed})", allowed=range_text(allowed)
            )
        )
        return None
    return None if _inside(cursor, int(text), text, allowed) is None else int(text)


def read_seconds(cursor: Cursor, allowed: Range) -> float | None:
    """A duration in seconds: `2`, `2 s`, `250 ms`, `10 min`, `1 h`."""
    text = cursor.node.text.strip() if isinstance(cursor.node, ScalarNode) else ""
    match = _SECONDS.fullmatch(text)
    factor = _UNITS.get(match["unit"]) if match else None
    if match is None or factor is None:
        cursor.wrong(
            Sentence(
                "check.duration", "a duration (a number of seconds, or 250 ms, 2 s, 10 min, 1 h)"
            )
        )
        return None
    return _inside(cursor, float(match["number"]) * factor, text, allowed)


def range_text(allowed: Range) -> str:
    """`0 to 5 m`."""
    low, high = allowed.low, allowed.high
    unit = _UNIT_WORDS.get(allowed.unit, f" {allowed.unit}" if allowed.unit else "")
    if low is not None and high is not None:
        return Sentence("check.range", "{low:g} to {high:g}{unit}", low=low, high=high, unit=unit)
    if low is not None:
        return Sentence("check.or_more", "{low:g}{unit} or more", low=low, unit=unit)
    if high is not None:
        return Sentence("check.or_less", "{high:g}{unit} or less", high=high, unit=unit)
    return Sentence("check.any_number", "any number{unit}", unit=unit)


def number_in(allowed: Range) -> Sentence:
    """`a number (0 to 5 m)`."""
    if allowed == Range():
        return Sentence("check.a_number", "a number")
    return Sentence("check.number_in", "a number ({allowed})", allowed=range_text(allowed))


def out_of_range(text: str, allowed: Range) -> Sentence:
    """`7 is out of range; allowed is 0 to 5 m`."""
    return Sentence(
        "check.out_of_range",
        "{text} is out of range; allowed is {allowed}",
        text=text,
        allowed=range_text(allowed),
    )


def _inside(cursor: Cursor, number: float, text: str, allowed: Range | None) -> float | None:
    if abs(number) == float("inf"):
        cursor.error(Sentence("check.too_large", "{text} is too large", text=text))
        return None
    if allowed is not None and not allowed.contains(number):
        cursor.error(out_of_range(text, allowed))
        return None
    return number


def missing(table: Mapping[str, Cursor], name: str, parent: Cursor, why: str = "") -> Cursor | None:
    """The entry `name`, or None after saying that it is missing."""
    cursor = table.get(name)
    if cursor is None:
        because = Sentence("check.in_brackets", " ({text})", text=why) if why else ""
        path = join(parent.path, name)
        parent.report.missing(
            parent.place,
            path,
            Sentence("check.missing", "is missing{because}", because=because),
            path,
        )
    return cursor


def document(source: SourceFile, report: ProblemReport, expected: str) -> Cursor | None:
    """The root of a file that holds a mapping; None after saying what it holds instead."""
    report.file(source.name)
    start = FilePosition(source.name, 1, 1)
    broken = len(report.errors)
    node = parse_yaml(source, report)
    if isinstance(node, MappingNode):
        return Cursor(node, "", start, report)
    if len(report.errors) == broken:
        found = Sentence("check.found_nothing", "nothing") if node is None else described(node)
        report.error(start, "file", expectation(expected, found))
    return None


def source_of(path: Path, report: ProblemReport, data: bytes | None = None) -> SourceFile | None:
    """A file that was named on a command line, or None after saying why it cannot be read; `data`
    stands for what it holds.
    """
    report.file(str(path))
    try:
        return read_source(path, str(path), data)
    except SourceFileError as error:
        report.error(FilePosition(str(path), error.line, error.column), "file", error.message)
    return None


def named_source(
    cursor: Cursor, text: str, base: Path, meant: Callable[[], str]
) -> SourceFile | None:
    """The file that `text` names at `cursor`, seen from `base`, or None after saying what is wrong;
    `meant` is asked for a hint where it is not there.
    """
    try:
        path = base / Path(text).expanduser()
        return read_source(path, str(path))
    except SourceFileError as error:
        if (error.line, error.column) == (1, 1):
            cursor.error(
                Sentence(
                    "check.named_file",
                    "{file}: {why}{near}",
                    file=quoted(text),
                    why=error.message,
                    near=meant(),
                )
            )
        else:
            place = FilePosition(str(path), error.line, error.column)
            cursor.report.error(place, "file", error.message)
    except (RuntimeError, ValueError) as error:  # expanduser without a home, a NUL
        cursor.error(
            Sentence(
                "check.named_file", "{file}: {why}{near}", file=quoted(text), why=error, near=""
            )
        )
    return None
