"""Decodes settings of drivers and sections of files through the annotations of dataclasses.

The types say everything: what may be left out (a default), what is allowed (`drivers.fields`), how
things nest. Supported are text, numbers, booleans, `Path`, enums, `Literal`, optional and united
simple types, tuples and lists, `dict[str, ...]`, and dataclasses of all these.
"""

from __future__ import annotations

import dataclasses
import enum
import functools
import os
import pathlib
import re
import types
import typing
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Final, Literal, TypeVar

from woz_tui.config import media_files
from woz_tui.config.file_position import FilePosition, Problem
from woz_tui.config.file_text import SourceFile
from woz_tui.config.problems import ProblemReport, either, join
from woz_tui.config.yaml_cursor import (
    TEXT_WITH_BRACKET,
    Cursor,
    document,
    expectation,
    missing,
    named_source,
    one_of_words,
    read_flag,
    read_number,
    read_seconds,
    read_text,
    read_whole,
    read_word,
)
from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node, ScalarNode, described
from woz_tui.drivers import fields
from woz_tui.protocol.sentence import Sentence, said_by


@dataclasses.dataclass(frozen=True, slots=True)
class Invalid:
    """A value that is wrong, which has been reported; `rest`: what of a list could be read."""

    rest: Any


INVALID: Final = Invalid(dataclasses.MISSING)

N = TypeVar("N")

_SEQUENCES = (tuple, list, frozenset, Sequence)
_MAPPINGS = (dict, Mapping)


@dataclasses.dataclass(frozen=True, slots=True)
class SettingField:
    """One setting as a file may give it; `name` is how the file spells it."""

    name: str
    attribute: str
    annotation: Any
    required: bool
    default: Any
    doc: str


@functools.cache
def fields_of(shape: type) -> tuple[SettingField, ...]:
    """The settings of a dataclass, in order. An attribute `from_` is `from` in the file."""
    hints = typing.get_type_hints(shape, include_extras=True)
    optional = not issubclass(shape, fields.Entry)  # None means that an entry has been left out
    found = []
    for item in dataclasses.fields(shape):
        if not item.init:
            continue
        annotation = hints[item.name] if optional else _without_none(hints[item.name])
        default: Any = item.default
        if item.default_factory is not dataclasses.MISSING:
            default = item.default_factory()
        doc = find_note(split_annotation(annotation)[1], fields.Doc)
        found.append(
            SettingField(
                name=item.name.rstrip("_"),
                attribute=item.name,
                annotation=annotation,
                required=default is dataclasses.MISSING,
                default=default,
                doc=doc.text if doc is not None else "",
            )
        )
    return tuple(found)


def _without_none(annotation: Any) -> Any:
    """`int` for `int | None`, notes kept."""
    bare, notes = split_annotation(annotation)
    if typing.get_origin(bare) in (typing.Union, types.UnionType):
        kinds = tuple(kind for kind in typing.get_args(bare) if kind is not type(None))
        bare = typing.Union[kinds]  # noqa: UP007 - as many as there are
    return Annotated[bare, *notes] if notes else bare


def split_annotation(annotation: Any) -> tuple[Any, tuple[Any, ...]]:
    """The bare type and the notes of `Annotated[type, *notes]`."""
    if typing.get_origin(annotation) is Annotated:
        bare, *notes = typing.get_args(annotation)
        return bare, tuple(notes)
    return annotation, ()


def find_note(notes: Sequence[Any], kind: type[N]) -> N | None:
    """The first note of one kind."""
    return next((item for item in notes if isinstance(item, kind)), None)


def values_with_note(settings: Any, kind: type) -> Iterator[tuple[str, str]]:
    """Texts among the settings that have a note of this kind, by name; empty ones are left out."""
    for name, value, _ in notes_of_values(settings, kind):
        yield name, value


def notes_of_values(settings: Any, kind: type[N]) -> Iterator[tuple[str, str, N]]:
    """The same with their notes."""
    shape: type = type(settings)
    for item in fields_of(shape):
        value = getattr(settings, item.attribute)
        note = find_note(split_annotation(item.annotation)[1], kind)
        if value and note is not None:
            yield item.name, value, note


def names_of(shape: type) -> tuple[str, ...]:
    """The names of the settings of a dataclass, as files spell them."""
    return tuple(item.name for item in fields_of(shape))


def read_settings(cursor: Cursor, shape: type, others: Sequence[str] = ()) -> Any:
    """An instance of the dataclass `shape`, or `INVALID`. Entries that it does not have are errors,
    except for `others`, which somebody else reads.
    """
    values = _values(cursor, shape, others)
    if values is None or any(isinstance(value, Invalid) for value in values.values()):
        return INVALID
    return _made(cursor, shape, values)


def read_partly(cursor: Cursor, shape: type[N], **known: Any) -> N | None:
    """An instance of `shape` also where some of it is wrong, which has been reported: a default
    stands for that, or nothing. None if there is no mapping. What is `known` is not read.
    """
    made = _entry(cursor, shape, known)
    found: N | None = made.rest if isinstance(made, Invalid) else made
    return None if found is dataclasses.MISSING else found


def _entry(cursor: Cursor, shape: type, known: Mapping[str, Any]) -> Any:
    """An entry, or `Invalid` with what could be read of it."""
    values = _values(cursor, shape, (), known)
    if values is None:
        return INVALID
    made = {
        item.attribute: "" if split_annotation(item.annotation)[0] is str else ()
        for item in fields_of(shape)
        if item.required
    }
    for name, value in values.items():
        read = value.rest if isinstance(value, Invalid) else value
        if read is not dataclasses.MISSING:
            made[name] = read
    entry = shape(**{**made, **known})
    return Invalid(entry) if any(isinstance(v, Invalid) for v in values.values()) else entry


def _values(
    cursor: Cursor, shape: type, others: Sequence[str], known: Collection[str] = ()
) -> dict[str, Any] | None:
    """Settings by attribute; wrong ones, and wrong entries by their names, are `INVALID`."""
    entry_of: Any = shape if issubclass(shape, fields.Entry) else None
    expected: str = Sentence("check.settings", "a mapping of settings")
    if entry_of is not None:
        expected = entry_of.what
        if entry_of.example:
            expected = Sentence(
                "check.such_as",
                "{what}, such as {example}",
                what=expected,
                example=entry_of.example,
            )
    table = cursor.table(expected)
    if table is None:
        return None
    items = [item for item in fields_of(shape) if item.attribute not in known]
    values: dict[str, Any] = {}
    for item in items:
        entry = table.get(item.name)
        apart = find_note(split_annotation(item.annotation)[1], fields.ReadApart)
        if item.name in others or apart is not None:
            if entry is None and item.required:
                missing({}, item.name, cursor, item.doc)
        elif entry is not None:
            values[item.attribute] = read_value(entry, item.annotation)
        elif item.required:
            missing({}, item.name, cursor, item.doc)
            values[item.attribute] = INVALID
    allowed = [*dict.fromkeys([*(item.name for item in items), *others])]
    for name, entry in table.items():
        if name not in allowed:
            entry.unknown(
                allowed,
                Sentence("check.entry_has", "{what} has", what=entry_of.what)
                if entry_of
                else Sentence("check.settings_are", "settings here are"),
            )
            values[name] = INVALID
    if entry_of and entry_of.either and not {*entry_of.either} & table.keys():
        doc = next(item.doc for item in items if item.name == entry_of.either[0])
        missing({}, entry_of.either[0], cursor, doc.partition(" (")[0])
    return values


def read_section(cursor: Cursor | None, shape: type[N], others: Sequence[str] = ()) -> N | None:
    """A section that is nothing but settings; None if it is not there or wrong."""
    made: Any = INVALID if cursor is None else read_settings(cursor, shape, others)
    return None if made is INVALID else made


def read_entries(cursor: Cursor | None, expected: str, shape: type[N]) -> list[tuple[Cursor, N]]:
    """The entries of a list, each as far as it can be read, with where it stands."""
    entries = cursor.list(expected) if cursor is not None else None
    found = [(entry, read_partly(entry, shape)) for entry in entries or ()]
    return [(entry, made) for entry, made in found if made is not None]


def _made(cursor: Cursor, shape: type, values: dict[str, Any]) -> Any:
    """The instance, its own cross rules asked. A stranger's rules may raise anything."""
    try:
        made = shape(**values)
        section = made if isinstance(made, fields.Section) else fields.Section()
        problems = list(section.problems())
        hints = list(section.warnings())
        included: IncludedFiles | None = None if problems else section.included()
    except Exception as error:  # noqa: BLE001 - a plug-in's code; its failure is the file's error
        cursor.error(said_by(error) or type(error).__name__)
        return INVALID
    for say, said in ((cursor.report.error, problems), (cursor.report.warning, hints)):
        for path, message in said:
            full = _path_below(cursor.path, path)
            say(cursor.report.place(full, cursor.place.file), full, message)
    if included is not None and not _add_included(cursor.report, included):
        return INVALID
    return INVALID if problems else made


class IncludedFiles(typing.Protocol):
    """Files that settings name and read themselves (`included()`): what is wrong in them, with
    their lines, and the files, which belong to the experiment from then on.
    """

    @property
    def problems(self) -> Sequence[Problem]:
        """Errors and warnings."""

    @property
    def sources(self) -> Sequence[SourceFile]:
        """Every file that was read."""


def _add_included(report: ProblemReport, included: IncludedFiles) -> bool:
    """Whether all of the files are right."""
    for source in included.sources:
        report.file(source.name)
        report.included.append(source)
    for problem in included.problems:
        report.file(problem.place.file)
        say = report.warning if problem.warning else report.error
        say(problem.place, problem.path, problem.message)
    return all(problem.warning for problem in included.problems)


def _path_below(path: str, inner: str) -> str:
    if not inner:
        return path
    return path + inner if inner.startswith("[") else join(path, inner)


def read_value(cursor: Cursor, annotation: Any, notes: tuple[Any, ...] = ()) -> Any:
    """A value of the annotated type, or `INVALID`. `notes` are inherited from what holds it."""
    bare, own = split_annotation(annotation)
    notes = (*own, *notes)
    origin = typing.get_origin(bare)
    if origin in (typing.Union, types.UnionType):
        return _united(cursor, typing.get_args(bare), notes)
    if origin is Literal:
        return _or_invalid(read_word(cursor, [str(word) for word in typing.get_args(bare)]))
    if origin in _SEQUENCES or bare in _SEQUENCES:
        return _sequence(cursor, bare, notes)
    if origin in _MAPPINGS or bare in _MAPPINGS:
        return _mapping(cursor, bare, notes)
    if dataclasses.is_dataclass(bare) and isinstance(bare, type):
        entry = issubclass(bare, fields.Entry)
        return _entry(cursor, bare, {}) if entry else read_settings(cursor, bare)
    if isinstance(bare, type) and issubclass(bare, enum.Enum):
        members = {str(member.value): member for member in bare}
        word = read_word(cursor, members)
        return INVALID if word is None else members[word]
    if bare in (bool, int, float):
        return _or_invalid(_flag_or_number(cursor, bare, notes))
    if bare is str or (isinstance(bare, type) and issubclass(bare, pathlib.Path)):
        text = _text(cursor, notes, file=bare is not str)
        return INVALID if text is None else bare(text)
    if bare is Any or bare is object:
        return plain_data(cursor.node)
    cursor.error(
        Sentence(
            "check.type_not_possible",
            "the driver needs a {type!r} here, which a file cannot contain",
            type=bare,
        )
    )
    return INVALID


def _flag_or_number(
    cursor: Cursor, bare: type, notes: tuple[Any, ...]
) -> bool | int | float | None:
    if bare is bool:
        return read_flag(cursor)
    if bare is int:
        return read_whole(cursor, find_note(notes, fields.Range))
    seconds = find_note(notes, fields.Seconds)
    if seconds is not None:
        return read_seconds(cursor, fields.Range(seconds.low, seconds.high, "s"))
    return read_number(cursor, find_note(notes, fields.Range))


def _or_invalid(value: object) -> Any:
    return INVALID if value is None else value


def _text(cursor: Cursor, notes: tuple[Any, ...], *, file: bool) -> str | None:
    one_of = find_note(notes, fields.OneOf)
    if one_of is not None:
        return read_word(cursor, one_of.choices)
    pattern = find_note(notes, fields.Pattern)
    several = find_note(notes, fields.OneOrMore)
    expected = (
        Sentence("check.or_list", "{of}, or a list of them", of=several.of)
        if several is not None
        else Sentence("check.a_text", "text")
    )
    text = read_text(cursor, pattern.meaning if pattern is not None else expected)
    if text is None:
        return None
    if not text.strip() and (several or find_note(notes, fields.NotBlank)):
        cursor.error(Sentence("check.empty", "is empty"))
        return None
    if pattern is not None and not re.fullmatch(pattern.regex, text):
        cursor.error(expectation(pattern.meaning, repr(text)))
        return None
    path = find_note(notes, fields.Path) or (fields.Path() if file else None)
    return text if path is None else resolve_path(cursor, text, must_exist=path.must_exist)


def resolve_path(cursor: Cursor, text: str, *, must_exist: bool) -> str:
    """An absolute path; relative ones start at the file they stand in. Missing files warn."""
    try:
        base = pathlib.Path(cursor.place.file).absolute().parent
        path = base / pathlib.Path(text).expanduser()
        if must_exist and not path.exists():
            cursor.warning(
                Sentence(
                    "check.no_file",
                    "there is no file {text!r}{near}",
                    text=text,
                    near=media_files.meant(base, text),
                )
            )
        elif must_exist and (wrong := media_files.doubt(path)):
            cursor.warning(
                Sentence(
                    "check.named_file", "{file}: {why}{near}", file=repr(text), why=wrong, near=""
                )
            )
    except PermissionError as error:
        cursor.warning(
            Sentence(
                "check.path_unreadable",
                "{text!r} cannot be read: {reason}",
                text=text,
                reason=error.strerror,
            )
        )
    except (OSError, RuntimeError, ValueError) as error:
        cursor.error(
            Sentence("check.no_path", "{text!r} is not a path: {error}", text=text, error=error)
        )
        return text
    return str(_straight(path))


def _straight(path: pathlib.Path) -> pathlib.Path:
    """Without `..` on the way, which makes places of errors hard to read; unless a link leads
    somewhere else.
    """
    straight = pathlib.Path(os.path.normpath(path))
    try:
        return straight if straight.samefile(path) else path
    except (OSError, ValueError):
        return path


def _sequence(cursor: Cursor, bare: Any, notes: tuple[Any, ...]) -> Any:
    alone = isinstance(cursor.node, ScalarNode | MappingNode)
    several = find_note(notes, fields.OneOrMore)
    entries = [cursor] if several is not None and alone else cursor.list()
    if entries is None:
        return INVALID
    some = find_note(notes, fields.NotEmpty)
    if some is not None and not entries:
        cursor.error(some.message)
        return INVALID
    inner = typing.get_args(bare) or (Any,)
    fixed = typing.get_origin(bare) is tuple and inner[-1] is not Ellipsis
    if fixed and len(entries) != len(inner):
        cursor.error(
            Sentence(
                "check.entries",
                "expected {wanted} entries, not {number}",
                wanted=len(inner),
                number=len(entries),
            )
        )
        return INVALID
    kinds = inner if fixed else (inner[0],) * len(entries)
    values = [read_value(entry, kind, notes) for entry, kind in zip(entries, kinds, strict=True)]
    good = [value for value in values if not isinstance(value, Invalid)]
    twice: list[Cursor] = []
    if find_note(notes, fields.Unique) is not None:
        twice = [
            entry
            for at, entry in enumerate(entries)
            if values[at] is not INVALID and values[at] in values[:at]
        ]
    for entry in twice:
        entry.error(Sentence("check.twice", "{found} appears twice", found=described(entry.node)))
    origin = typing.get_origin(bare) or bare
    made = origin(good) if origin in (list, frozenset) else tuple(good)
    return Invalid(made) if twice or len(good) < len(values) else made


def _mapping(cursor: Cursor, bare: Any, notes: tuple[Any, ...]) -> Any:
    table = cursor.table()
    if table is None:
        return INVALID
    _, inner = typing.get_args(bare) or (str, Any)
    values = {name: read_value(entry, inner, notes) for name, entry in table.items()}
    return INVALID if any(isinstance(v, Invalid) for v in values.values()) else values


def _united(cursor: Cursor, members: tuple[Any, ...], notes: tuple[Any, ...]) -> Any:
    """The first type that fits, the narrowest first; text fits nearly always, so it is last."""
    if type(None) in members and isinstance(cursor.node, ScalarNode) and cursor.node.is_null:
        return None
    included = find_note(notes, fields.Included)
    if included is not None and isinstance(cursor.node, ScalarNode):
        if cursor.node.text in included.words:
            return cursor.node.text
        root = read_included(cursor, included.words)
        return INVALID if root is None else _united(root, members, ())
    fitting = [kind for kind in members if _fits(cursor.node, kind)]
    fitting.sort(key=_breadth)
    if len(fitting) == 1:
        return read_value(cursor, fitting[0], notes)
    for kind in fitting:
        attempt = ProblemReport()
        value = read_value(Cursor(cursor.node, cursor.path, cursor.place, attempt), kind, notes)
        if not isinstance(value, Invalid):
            return read_value(cursor, kind, notes)
    kinds = either([_type_in_words(kind) for kind in members if kind is not type(None)])
    bracket = TEXT_WITH_BRACKET if str in members and isinstance(cursor.node, ListNode) else ""
    cursor.error(expectation(kinds, described(cursor.node), bracket))
    return INVALID


def _fits(node: Node, annotation: Any) -> bool:
    bare, _ = split_annotation(annotation)
    origin = typing.get_origin(bare) or bare
    if origin is type(None):
        return False
    if isinstance(node, ListNode):
        return origin in _SEQUENCES
    if isinstance(node, MappingNode):
        return origin in _MAPPINGS or dataclasses.is_dataclass(origin)
    return origin not in _SEQUENCES + _MAPPINGS and not dataclasses.is_dataclass(origin)


def _breadth(annotation: Any) -> int:
    bare, notes = split_annotation(annotation)
    if bare is str or (isinstance(bare, type) and issubclass(bare, pathlib.Path)):
        return 5 if find_note(notes, fields.OneOf) is None else 3
    return {bool: 0, int: 1, float: 2}.get(bare, 3)


def _type_in_words(annotation: Any) -> str:
    bare, notes = split_annotation(annotation)
    if (one_of := find_note(notes, fields.OneOf)) is not None:
        return one_of_words(one_of.choices)
    if typing.get_origin(bare) is Literal:
        return one_of_words(map(str, typing.get_args(bare)))
    origin = typing.get_origin(bare) or bare
    if origin in _SEQUENCES:
        return Sentence("check.a_list", "a list")
    if origin in _MAPPINGS or dataclasses.is_dataclass(origin):
        return Sentence("check.a_mapping", "a mapping")
    names = {
        bool: Sentence("check.true_or_false", "true or false"),
        int: Sentence("check.a_whole_number", "a whole number"),
        float: Sentence("check.a_number", "a number"),
        str: Sentence("check.a_text", "text"),
    }
    return names.get(bare, getattr(bare, "__name__", str(bare)).lower())


def plain_data(node: Node) -> Any:
    """Plain data without a type to go by: numbers, true, false and null as JSON knows them."""
    match node:
        case ListNode():
            return [plain_data(item) for item in node.nodes]
        case MappingNode():
            return {name: plain_data(value) for name, _, value in node.items()}
        case ScalarNode(plain=True, text=text):
            return _plain_value(text)
        case _:
            return node.text


def _plain_value(text: str) -> Any:
    if text in ("", "~", "null"):
        return None
    if text in ("true", "false"):
        return text == "true"
    if re.fullmatch(r"[-+]?\d{1,15}", text):
        return int(text)
    if re.fullmatch(r"[-+]?(\d+\.\d*|\.\d+|\d+)([eE][-+]?\d{1,2})?", text):
        return float(text)
    return text


def read_included(cursor: Cursor, words: Sequence[str] = ()) -> Cursor | None:
    """The root of the file whose path stands at `cursor`, or None after saying what is wrong.

    `words` could have stood there too; a misspelt one is no file.
    """
    text = read_text(cursor, either([Sentence("check.a_file", "a file"), *words]))
    if text is None:
        return None
    report = cursor.report
    source = named_source(
        cursor,
        text,
        pathlib.Path(cursor.place.file).absolute().parent,
        lambda: report.hint(
            text, words, or_list=Sentence("check.without_file", "without a file there are")
        ),
    )
    if source is None:
        return None
    report.included.append(source)
    return document(source, report, Sentence("check.a_mapping", "a mapping"))


def settings_from_texts(shape: type, values: Mapping[str, str], base: Path) -> Any:
    """An instance of `shape` with the settings `values` as text; relative paths start at `base`.

    Raises `ExperimentError` with every problem, also with those of files that are named.
    """
    report = ProblemReport()
    place = FilePosition(str(base / "command line"), 1, 1)
    report.file(place.file)
    keys = {name: ScalarNode(place, name, plain=True) for name in values}
    entries = {name: ScalarNode(place, text, plain=True) for name, text in values.items()}
    made = read_settings(Cursor(MappingNode(place, dict(entries), keys), "", place, report), shape)
    report.raise_errors()
    return made
