"""Parses YAML into nodes with their positions, without guessing types.

YAML turns `No` into false, `12:30` into 750 and lets the second of two equal keys win. So nothing
is resolved here: a scalar keeps its text, and whoever wants a number parses one. The tree is built
from the parser's events with a stack of its own, which makes depth and size limits plain.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import yaml

from woz_tui.config.file_position import FilePosition
from woz_tui.config.file_text import SourceFile
from woz_tui.config.problems import ProblemReport, join, quoted, with_remedy
from woz_tui.protocol.sentence import Sentence

#: Lists and mappings inside each other; a real file needs eight.
MAX_DEPTH = 40
_TOO_DEEP = Sentence(
    "check.too_deep", "more than {most} lists and mappings inside each other", most=MAX_DEPTH
)
#: Scalars, lists and mappings, counted as often as aliases repeat them.
MAX_NODES = 30_000

#: Tags that change nothing, since types come from what is wanted.
_HARMLESS = frozenset(
    f"tag:yaml.org,2002:{name}" for name in ("str", "int", "float", "bool", "map", "seq", "null")
)

#: What cuts a text off: a comment without a space behind its sign, which few people mean.
_CUT = re.compile(r"[ \t]+(#\w.*)")
#: Quotes that word processors make of straight ones.
CURLY = frozenset("\u201c\u201d\u201e\u2018\u2019\u201a")
CURLY_QUOTES = Sentence(
    "check.curly_quotes",
    "curly quotes are part of the text; for YAML's quotes write \" or ' (straight ones)",
)


def comment_instead(cut: str) -> str:
    """The sentence about a comment that looks like a part of the text before it."""
    return Sentence(
        "check.comment",
        "{cut} is a comment and no part of the text: put the text in quotes,"
        " or a space behind the #",
        cut=quoted(cut),
    )


_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(slots=True)
class ScalarNode:
    """One piece of text as it was typed; `plain` if it stood without quotes."""

    place: FilePosition
    text: str
    plain: bool
    size: int = 1
    depth: int = 0

    @property
    def is_empty(self) -> bool:
        """`key:` with nothing after it."""
        return self.plain and not self.text

    @property
    def is_null(self) -> bool:
        """Nothing, or one of YAML's words for it."""
        return self.plain and self.text in ("", "~", "null", "Null", "NULL")


@dataclass(slots=True)
class ListNode:
    """A list."""

    place: FilePosition
    nodes: list[Node] = field(default_factory=list)
    size: int = 1
    depth: int = 1


@dataclass(slots=True)
class MappingNode:
    """A mapping, in the file's order; `keys` holds each key's own scalar."""

    place: FilePosition
    entries: dict[str, Node] = field(default_factory=dict)
    keys: dict[str, ScalarNode] = field(default_factory=dict)
    size: int = 1
    depth: int = 1

    def items(self) -> Iterator[tuple[str, ScalarNode, Node]]:
        """Name, key and value of each entry."""
        for name, value in self.entries.items():
            yield name, self.keys[name], value


Node = ScalarNode | ListNode | MappingNode


def described(node: Node) -> str:
    """What a node is, for `expected text, not a list`."""
    match node:
        case ListNode():
            return Sentence("check.a_list", "a list")
        case MappingNode():
            return Sentence("check.a_mapping", "a mapping")
        case _:
            return (
                Sentence("check.found_nothing", "nothing") if node.is_empty else quoted(node.text)
            )


def parse_yaml(
    source: SourceFile, report: ProblemReport, *, last_wins: bool = False
) -> Node | None:
    """The document's root, or None if it is empty or broken; reports what is wrong.

    `last_wins`: of two equal keys the last one counts, as PyYAML has it, with a warning; else the
    second one is an error.
    """
    try:
        return _Composer(source, report, last_wins=last_wins).compose()
    except yaml.YAMLError as error:
        line, column, message = explain_yaml_error(error, source.text)
        report.error(FilePosition(source.name, line, column), "YAML", message)
    except _UnreadableYamlError as error:
        report.error(error.place, "YAML", error.message)
    return None


class _UnreadableYamlError(Exception):
    """Reading on makes no sense."""

    def __init__(self, place: FilePosition, message: str) -> None:
        super().__init__(message)
        self.place = place
        self.message = message


@dataclass(slots=True)
class _UnfinishedNode:
    """A list or mapping whose end has not come yet, and the key that waits for its value."""

    node: ListNode | MappingNode
    path: str
    anchor: str | None
    key: ScalarNode | None = None
    merged: list[MappingNode] = field(default_factory=list)
    dropped: bool = False


class _Composer:
    def __init__(self, source: SourceFile, report: ProblemReport, *, last_wins: bool) -> None:
        self._source = source
        self._report = report
        self._last_wins = last_wins
        self._stack: list[_UnfinishedNode] = []
        self._anchors: dict[str, Node | None] = {}
        self._root: Node | None = None
        self._documents = 0
        self._lines = source.text.splitlines()

    def compose(self) -> Node | None:
        loader = _Loader(self._source.text)
        try:
            while loader.check_event():
                self._event(loader.get_event())
        finally:
            loader.dispose()
        return self._root

    def _event(self, event: yaml.Event) -> None:
        match event:
            case yaml.ScalarEvent():
                plain = event.style in (None, "")
                scalar = ScalarNode(self._place(event), event.value, plain)
                if plain:
                    self._warn_of_odd_text(event)
                self._tag(event, scalar.place, scalar)
                self._anchor(event.anchor, scalar)
                self._add(scalar)
            case yaml.MappingStartEvent() | yaml.SequenceStartEvent():
                self._begin(event)
            case yaml.MappingEndEvent() | yaml.SequenceEndEvent():
                self._end()
            case yaml.AliasEvent():
                self._alias(event)
            case yaml.DocumentStartEvent():
                self._documents += 1
                if self._documents > 1:
                    raise _UnreadableYamlError(
                        self._place(event),
                        Sentence(
                            "check.second_document",
                            "a second document begins here; a file can have only one",
                        ),
                    )

    def _warn_of_odd_text(self, event: yaml.ScalarEvent) -> None:
        """Warn of a text without quotes that is not what it looks like. Where it is an error, too,
        the error says it.
        """
        place, key = self._place(event), self._stack[-1].key if self._stack else None
        said = []
        if cut := self._comment_behind(event, key):
            said.append(comment_instead(cut))
        if event.value[:1] in CURLY or event.value[-1:] in CURLY:
            said.append(CURLY_QUOTES)
        for message in said:
            path = self._path_of_next() or "YAML"
            self._report.warning(key.place if key is not None else place, path, message)
            self._report.explain(place if key is None else key.place, message)

    def _comment_behind(self, event: yaml.ScalarEvent, key: ScalarNode | None) -> str:
        """The comment behind a text, as far as it looks like a part of it."""
        end = event.end_mark
        line, column = (end.line, end.column) if end is not None else (len(self._lines), 0)
        if not event.value and key is not None:  # where nothing is, the parser's mark is further on
            line, column = key.place.line - 1, key.place.column - 1 + len(key.text)
        text = self._lines[line] if line < len(self._lines) else ""
        found = _CUT.match(text, column) or (not event.value and _CUT.match(text, column + 1))
        return found[1] if found else ""

    def _place(self, event: yaml.Event) -> FilePosition:
        mark = event.start_mark
        line, column = (mark.line, mark.column) if mark is not None else (0, 0)
        return FilePosition(self._source.name, line + 1, column + 1)

    def _begin(self, event: yaml.MappingStartEvent | yaml.SequenceStartEvent) -> None:
        place = self._place(event)
        if len(self._stack) >= MAX_DEPTH:
            raise _UnreadableYamlError(place, _TOO_DEEP)
        mapping = isinstance(event, yaml.MappingStartEvent)
        node: ListNode | MappingNode = MappingNode(place) if mapping else ListNode(place)
        self._tag(event, place, None)
        if event.anchor is not None:
            self._anchors[event.anchor] = None
        self._stack.append(_UnfinishedNode(node, self._path_of_next(), event.anchor))

    def _end(self) -> None:
        done = self._stack.pop()
        if isinstance(done.node, MappingNode):
            table = done.node
            if not self._last_wins:
                named = (table.entries.get(name) for name in ("title", "label", "name"))
                titles = (node.text for node in named if isinstance(node, ScalarNode) and node.text)
                self._report.set_title(done.path, self._source.name, next(titles, ""))
            # YAML's merge key: what the mapping says itself wins, then the first base that says it.
            for base in done.merged:
                for name, key, value in base.items():
                    table.keys.setdefault(name, key)
                    table.entries.setdefault(name, value)
        self._anchor(done.anchor, done.node)
        self._add(done.node)

    def _alias(self, event: yaml.AliasEvent) -> None:
        place = self._place(event)
        if event.anchor not in self._anchors:
            raise _UnreadableYamlError(
                place,
                Sentence(
                    "check.no_anchor",
                    "nothing is called &{anchor} here; text that begins with * needs quotes",
                    anchor=event.anchor,
                ),
            )
        node = self._anchors[event.anchor]
        if node is None:
            raise _UnreadableYamlError(
                place,
                Sentence(
                    "check.anchor_in_itself", "*{anchor} contains itself", anchor=event.anchor
                ),
            )
        self._add(node)

    def _anchor(self, anchor: str | None, node: Node) -> None:
        if anchor is not None:
            self._anchors[anchor] = node

    def _tag(self, event: yaml.NodeEvent, place: FilePosition, scalar: ScalarNode | None) -> None:
        tag = getattr(event, "tag", None)
        if tag is None or tag in _HARMLESS:
            return
        if tag == "!" and scalar is not None and not scalar.plain:
            return
        self._report.error(place, self._path_of_next() or "YAML", _needs_quotes("!"))

    def _path_of_next(self) -> str:
        if not self._stack:
            return ""
        top = self._stack[-1]
        if isinstance(top.node, ListNode):
            return f"{top.path}[{len(top.node.nodes)}]"
        return join(top.path, top.key.text) if top.key is not None else top.path

    def _add(self, node: Node) -> None:
        if not self._stack:
            self._root = node
            return
        top = self._stack[-1]
        if isinstance(top.node, ListNode):
            top.node.nodes.append(node)
            self._grow(top.node, node)
        elif top.key is None and not top.dropped:
            self._add_key(top, node)
        else:
            self._add_value(top, top.node, node)

    def _grow(self, parent: ListNode | MappingNode, child: Node) -> None:
        """An alias repeats everything below it, so ten lines can stand for a billion nodes."""
        parent.size += child.size
        parent.depth = max(parent.depth, child.depth + 1)
        if parent.size > MAX_NODES:
            raise _UnreadableYamlError(
                child.place,
                Sentence(
                    "check.too_many_entries",
                    "more than {most} entries, aliases counted out",
                    most=MAX_NODES,
                ),
            )
        if parent.depth > MAX_DEPTH:
            raise _UnreadableYamlError(child.place, _TOO_DEEP)

    def _add_key(self, top: _UnfinishedNode, node: Node) -> None:
        if isinstance(node, ScalarNode):
            top.key = node
            return
        self._report.error(
            node.place,
            top.path or "YAML",
            Sentence(
                "check.name_before_colon",
                "expected a name before the colon, not {found}",
                found=described(node),
            ),
        )
        top.dropped = True

    def _add_value(self, top: _UnfinishedNode, table: MappingNode, node: Node) -> None:
        key, top.key = top.key, None
        if key is None:
            top.dropped = False
            return
        self._grow(table, node)
        if key.text == "<<" and key.plain:
            for base in node.nodes if isinstance(node, ListNode) else [node]:
                if isinstance(base, MappingNode):
                    top.merged.append(base)  # what the mapping says itself may still come
                else:
                    self._report.error(
                        base.place,
                        join(top.path, "<<"),
                        Sentence(
                            "check.only_mappings_merge",
                            "only a mapping can be merged in: <<: *name",
                        ),
                    )
            return
        first = table.keys.get(key.text)
        if first is not None:
            twice = Sentence(
                "check.twice_since_line",
                "{name} appears twice (first in line {line})",
                name=quoted(key.text),
                line=first.place.line,
            )
            say = self._report.warning if self._last_wins else self._report.error
            say(key.place, join(top.path, key.text), twice)
        if first is None or self._last_wins:
            table.keys[key.text] = key
            table.entries[key.text] = node


# -- what the parser says --------------------------------------------------------------------------


def _needs_quotes(sign: str) -> Sentence:
    return Sentence("check.needs_quotes", "text that begins with {sign} needs quotes", sign=sign)


#: (part of the parser's sentence, ours). First match wins.
_EXPLANATIONS = (
    (
        "tab character that violates",
        Sentence("check.tab", "a tab character; indent YAML with spaces"),
    ),
    ("alphabetic or numeric", _needs_quotes("* or &")),
    (
        "mapping values are not allowed",
        Sentence("check.colon_in_text", "text with a colon in it: put the text in quotes"),
    ),
    (
        "could not find expected ':'",
        Sentence(
            "check.colon_missing", "a colon is missing after a name, or a quote is not closed"
        ),
    ),
    (
        "block sequence entries",
        Sentence("check.dash", "a dash cannot be here; is the line above complete?"),
    ),
    (
        "expected '-' indicator",
        Sentence("check.dash_missing", "a '-' is missing here; check the indentation"),
    ),
    ("expected ',' or ']'", Sentence("check.list_not_closed", "a ',' or the closing ] is missing")),
    (
        "expected ',' or '}'",
        Sentence("check.mapping_not_closed", "a ',' or the closing }} is missing"),
    ),
    (
        "unexpected end of stream",
        Sentence("check.quotes_not_closed", "these quotes are never closed"),
    ),
    (
        "escape character",
        Sentence("check.escape", "unknown escape after \\ in double quotes; use single quotes"),
    ),
    (
        "hexdecimal",
        Sentence("check.escape", "unknown escape after \\ in double quotes; use single quotes"),
    ),
    (
        "expected node content",
        Sentence("check.value_or_quotes", "a value is missing here, or text that needs quotes"),
    ),
    (
        "<document start>",
        Sentence("check.outside", "this is outside of the file's mapping; check the indentation"),
    ),
    (
        "expected key",
        Sentence("check.does_not_fit", "this does not fit: check the indentation and the quotes"),
    ),
    ("tag", _needs_quotes("!")),
    ("URI", _needs_quotes("!")),
    ("directive", _needs_quotes("%")),
    ("comment or line break", _needs_quotes("> or |")),
)


def explain_yaml_error(error: yaml.YAMLError, text: str) -> tuple[int, int, str]:
    """Line and column (from 1) of the error in `text`, and a sentence."""
    if not isinstance(error, yaml.MarkedYAMLError):
        return 1, 1, " ".join(str(error).split())
    said = f"{error.problem or 'cannot be read'} {error.context or ''}".strip()
    mark = error.problem_mark or error.context_mark
    begun = error.context_mark
    if "end of stream" in said and begun is not None:
        mark = begun
    if mark is None:
        return 1, 1, said
    message = next((ours for theirs, ours in _EXPLANATIONS if theirs in said), said)
    lines = text.splitlines()
    closing = lines[mark.line : mark.line + 1]
    found = closing[0][mark.column : mark.column + 1] if closing else ""
    if found and found in "}]" and "',' or '" not in said:
        message = Sentence(
            "check.bracket_too_many",
            "one {found} too many, or the bracket that opens it is missing",
            found=found,
        )
        begun = None  # of what surrounds it, which is in order
    if "start any token" in said:
        message = _explain_character(text, mark.line, mark.column)
    if closing and (wanted := _explain_unquoted(closing[0], mark.column, said)):
        return mark.line + 1, mark.column + 1, wanted
    if begun is not None and "',' or '" in said:
        start = _BRACKET.match(lines[begun.line])
        if start is not None and ":" not in start["value"]:
            quotes = Sentence(
                "check.if_it_is_text",
                "if {key!r} is a text, put the text in quotes",
                key=start["key"],
            )
            message = with_remedy(message, quotes)
    if begun is not None and "',' or '" in said and (cut := _CUT.search(lines[begun.line])):
        message = with_remedy(message, comment_instead(cut[1]))
    if begun is not None and begun.line < mark.line:
        message = Sentence(
            "check.begun", "{message} (begun in line {line})", message=message, line=begun.line + 1
        )
    return mark.line + 1, mark.column + 1, message


#: A line whose value begins with a bracket, and the word before a colon.
_BRACKET = re.compile(r"\s*(?:- +)*(?P<key>[^\s:#{}\[\]\"'][^:#{}\[\]\"']*): +(?P<value>[\[{].*)")
#: A line whose value goes on behind its quotes.
_QUOTED = re.compile(r"\s*(?:- +)*[^\s:#{}\[\]\"']+: +(?:\"[^\"]*\"|'[^']*') *[^\s#]")
_WORD = re.compile(r"[^\s{}\[\],:]+$")


def _explain_unquoted(line: str, column: int, said: str) -> str:
    """The sentence about a text without quotes, if the parser stumbled over one in this line."""
    bracket = _BRACKET.match(line)
    closes = line[column : column + 1] in ("}", "]")
    if bracket and column > bracket.start("value") and "',' or '" not in said and not closes:
        first = bracket["value"][0]
        return Sentence(
            "check.text_begins_with",
            "no text can begin with {first}: put the text in quotes",
            first=first,
        )
    if _QUOTED.match(line) is not None:
        return Sentence(
            "check.behind_quotes",
            "the text goes on behind its quotes: put the text in quotes as a whole",
        )
    word = _WORD.search(line[:column].rstrip())
    if "',' or '}'" in said and line[column : column + 1] == ":" and word is not None:
        return Sentence(
            "check.comma_missing",
            "a comma is missing before {word!r}, or put the text in quotes",
            word=word[0],
        )
    return ""


def _explain_character(text: str, line: int, column: int) -> str:
    """What cannot begin a token: nearly always a tab, or a character that wants quotes."""
    lines = text.splitlines()
    found = lines[line][column : column + 1] if line < len(lines) else ""
    if found == "\t":
        return Sentence("check.tab", "a tab character; indent YAML with spaces")
    return _needs_quotes(found or Sentence("check.this_character", "this character"))
