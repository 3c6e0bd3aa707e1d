"""The table of a robot's topics: what each message holds, and which verbs it stands for.

    bridge: ramsocialrobot
    takes:
      ram/animation/desired/face:
        fields: {eyePosX: int, emotionState: int}
        plays:
          - verb: look
            args: {x: {field: eyePosX, from: [1, 127], to: [-1, 1]}}

Another robot of the same family is another file. Messages of three sorts need more than a row, and
their fields have fixed names: `looks` (saliency), `acknowledges` and `sequences`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Literal

from woz_tui.bridge.ros_data import EMPTY, RosDataError, RosType, RosValue, typed
from woz_tui.config.annotated_decoder import read_section
from woz_tui.config.bundled_files import bundled_file, is_path
from woz_tui.config.file_position import ExperimentError
from woz_tui.config.file_text import SourceFile
from woz_tui.config.problems import ProblemReport, join, nearest_word
from woz_tui.config.yaml_cursor import Cursor, document, named_source, read_text, source_of
from woz_tui.drivers.fields import Doc, NotBlank, Pattern, Section
from woz_tui.protocol.envelope import Json

#: The folder of such files beside the experiments.
FOLDER = "topics"
#: Fields of the messages that the program itself looks at.
_SALIENCY: Mapping[str, RosType] = {
    **{"inputId": "str", "locationsX": ["float"], "locationsY": ["float"], "weights": ["int"]}
}
#: What `looks` and `eyes` may take from the chosen place.
_PLACE: Mapping[str, RosType] = {"x": "float", "y": "float"}
_SEQUENCE: Mapping[str, RosType] = {
    **{"id": "str", "sequence": "int", "request": "float"},
    **{"requestType": "int", "requestCount": "int"},
}
_ANSWERS: Mapping[str, Mapping[str, RosType]] = {
    "general": {"id": "str", "type": "int", "message": "int", "reason": "int"},
    "prediction": {"id": "str", "duration": "float", "stroke": "float"},
    "gaze": {"x": "float", "y": "float"},
}


@dataclass(frozen=True, slots=True)
class VerbWithArgs:
    """What is called."""

    verb: str
    args: Mapping[str, Json]


@dataclass(frozen=True, slots=True)
class SalientPlace:
    """A place in the camera's picture, from -1 (left, top) to 1 (right, bottom); it is looked at if
    its weight is the highest. Planners use weights up to 10000.
    """

    x: float = 0.0
    y: float = 0.0
    weight: float = 0.0


#: Looked at when nothing is salient.
MIDDLE = SalientPlace()


@dataclass(frozen=True, slots=True)
class FieldSource(Section):
    """An argument that comes out of a message."""

    field_: Annotated[str, NotBlank(), Doc("which field; of a list with its number: position.0")]
    from_: Annotated[tuple[float, float] | None, Doc("two values of the field")] = None
    to: Annotated[tuple[float, float] | None, Doc("what they are as an argument")] = None
    values: Annotated[
        dict[str, Any], Doc("argument by value of the field; no other one counts")
    ] = field(default_factory=dict)

    def problems(self) -> list[tuple[str, str]]:
        """Both ends of a scale, and a scale that is one."""
        if (self.from_ is None) != (self.to is None):
            return [("", "a scale needs both from and to")]
        if self.from_ is not None and self.from_[0] == self.from_[1]:
            return [("from", "the two values are the same")]
        return []

    def of(self, message: Mapping[str, RosValue]) -> Json:
        """The argument; None: this value does not count. Raises `RosDataError`."""
        value: Any = message
        for step in self.field_.split("."):
            try:
                value = value[int(step)] if isinstance(value, tuple) else value[step]
            except (KeyError, IndexError, TypeError, ValueError):
                raise RosDataError(f"the message has no {self.field_}") from None
        if self.values:
            found: Json = self.values.get(
                str(value).lower() if isinstance(value, bool) else str(value)
            )
            return found
        if not isinstance(value, bool | int | float | str):
            raise RosDataError(f"{self.field_} is no single value")
        if self.from_ is None or self.to is None:
            return value
        if isinstance(value, bool | str):
            raise RosDataError(f"{self.field_} is no number")
        low, high = self.from_
        share = min(1.0, max(0.0, (value - low) / (high - low)))
        return round(self.to[0] + share * (self.to[1] - self.to[0]), 6)


@dataclass(frozen=True, slots=True)
class TopicVerb(Section):
    """A verb with its arguments; one of an object is written `joints.pan`."""

    verb: Annotated[str, NotBlank(), Doc("the verb")]
    args: Annotated[
        dict[str, FieldSource | bool | float | str],
        Doc("its arguments: a value, or where in the message it comes from"),
    ] = field(default_factory=dict)
    before: Annotated[
        dict[str, Any],
        Doc("arguments that hold before the first message; a message that says the same is none"),
    ] = field(default_factory=dict)
    repeats: Annotated[
        bool, Doc("whether it is played again and again while messages say the same")
    ] = False

    def of(self, message: Mapping[str, RosValue]) -> VerbWithArgs | None:
        """The verb for this message; None if a value of it does not count. Raises
        `RosDataError`.
        """
        args: dict[str, Any] = {}
        for name, source in self.args.items():
            value = source.of(message) if isinstance(source, FieldSource) else source
            if value is None:
                return None
            *outer, last = name.split(".")
            inside = args
            for each in outer:
                inside = inside.setdefault(each, {})
            inside[last] = value
        return VerbWithArgs(self.verb, args)


@dataclass(frozen=True, slots=True)
class TakenTopic(Section):
    """A topic on which a planner speaks."""

    fields: Annotated[
        dict[str, Any], Doc("type of each field: float, int, bool, str, time, [float]")
    ]
    plays: Annotated[
        tuple[TopicVerb, ...], Doc("verbs of a state: each is called when its arguments change")
    ] = ()
    acknowledges: Annotated[bool, Doc("whether each message is answered with an ack")] = False
    looks: Annotated[
        TopicVerb | None, Doc("for saliency: the verb that looks at the chosen place, x and y")
    ] = None
    eyes: Annotated[
        TopicVerb | None, Doc("for saliency: the verb that looks there with the eyes alone")
    ] = None
    sequences: Annotated[
        dict[str, TopicVerb], Doc("for requests of sequences: the verb of each number")
    ] = field(default_factory=dict)
    stop: Annotated[int | None, Doc("the number that ends the sequence under way")] = None

    def problems(self) -> list[tuple[str, str]]:
        """Types that are none, and fields that are missing."""
        found = _wrong_types(self.fields)
        needed: Mapping[str, RosType] = {
            **(_SALIENCY if self.looks else {}),
            **(_SEQUENCE if self.sequences else {}),
            **({"id": "str"} if self.acknowledges else {}),
        }
        found += [
            (join("fields", name), f"is missing: {name}: {_spelt(kind)}")
            for name, kind in needed.items()
            if self.fields.get(name) != kind
        ]
        calls: list[tuple[str, TopicVerb | None, Mapping[str, Any]]] = [
            *((f"plays[{at}]", call, self.fields) for at, call in enumerate(self.plays)),
            *((f"sequences.{name}", call, self.fields) for name, call in self.sequences.items()),
            ("looks", self.looks, _PLACE),
            ("eyes", self.eyes, _PLACE),
        ]
        found += [
            (f"{where}.args.{name}", text)
            for where, call, fields in calls
            if call is not None
            for name, text in _unknown_fields(call, fields)
        ]
        return found


@dataclass(frozen=True, slots=True)
class AnsweredTopic(Section):
    """A topic on which the planner is answered."""

    tells: Annotated[
        Literal["general", "prediction", "gaze", "state"],
        Doc("feedback, what is foreseen, where it looks, or how the robot is"),
    ]
    fields: Annotated[dict[str, Any], Doc("for state: type of each field, as above")] = field(
        default_factory=dict
    )
    shows: Annotated[
        dict[str, FieldSource | bool | float | str],
        Doc("for state: each field, or entry of a list (position.0), out of readings and values"),
    ] = field(default_factory=dict)

    def problems(self) -> list[tuple[str, str]]:
        """Types that are none, and fields that are not there."""
        wanted = self.tells == "state"
        if bool(self.shows) != wanted or bool(self.fields) != wanted:
            return [("", "fields and shows belong to state, which needs both")]
        return [
            *_wrong_types(self.fields),
            *(
                (join("shows", name), "is none of the fields, or no number of a list's entry")
                for name in self.shows
                if not _is_place(name, self.fields)
            ),
            *(
                (join("shows", name), "has gaps in its numbers, which begin at 0")
                for name in self.fields
                if (numbers := _numbers(name, self.shows)) != [*range(len(numbers))]
            ),
        ]

    @property
    def types(self) -> Mapping[str, RosType]:
        """The type of each field."""
        return self.fields or _ANSWERS[self.tells]

    def message(self, state: Mapping[str, Any]) -> dict[str, RosValue] | None:
        """How the robot is; None: not all of it is known. Raises `RosDataError`: a value is of
        another type than its field.
        """
        found: dict[str, Any] = {}
        lists: dict[str, dict[int, Any]] = {}
        for name, source in self.shows.items():
            try:
                value = source.of(state) if isinstance(source, FieldSource) else source
            except RosDataError:
                return None
            if value is None:
                return None
            outer, _, place = name.partition(".")
            if place:
                lists.setdefault(outer, {})[int(place)] = value
            else:
                whole = self.fields[name] == "int"
                found[name] = round(value) if isinstance(value, float) and whole else value
        for name, entries in lists.items():
            found[name] = tuple(entries[place] for place in sorted(entries))
        return typed(found, self.fields)


@dataclass(frozen=True, slots=True)
class TopicTable(Section):
    """All topics of a robot; their names are those of ROS, without the first slash."""

    bridge: Annotated[
        str,
        Pattern("[A-Za-z0-9]*", "letters and digits"),
        Doc("in front of every topic, with an underscore; empty: nothing"),
    ] = ""
    takes: Annotated[dict[str, TakenTopic], Doc("topics on which a planner speaks")] = field(
        default_factory=dict
    )
    answers: Annotated[dict[str, AnsweredTopic], Doc("topics on which it is answered")] = field(
        default_factory=dict
    )

    def calls(self, topic: str, message: Mapping[str, RosValue]) -> list[VerbWithArgs]:
        """The verbs that a single message stands for, whatever came before, played now. Raises
        `RosDataError`.
        """
        entry = self.takes.get(topic.strip("/"))
        if entry is None:
            near = nearest_word(topic[:80], self.takes)
            raise RosDataError(
                f"nothing is known of the topic {topic[:80]!r}"
                + (f"; did you mean {near!r}?" if near else "")
            )
        read = typed(message, entry.fields)
        calls = [call.of(read) for call in entry.plays]
        if entry.looks is not None:
            heaviest = max(salient_places(read), key=lambda one: one.weight, default=MIDDLE)
            calls.append(entry.looks.of({"x": heaviest.x, "y": heaviest.y}))
        if entry.sequences:
            calls.append(sequence_verb(entry, read))
        return [call for call in calls if call is not None]

    def look(self, x: float, y: float, *, eyes: bool = False) -> VerbWithArgs | None:
        """The verb that looks at a place of the camera's picture, each from -1 (left, top) to 1;
        `eyes`: with these alone, where the table has a verb for that.
        """
        entry = next((entry for entry in self.takes.values() if entry.looks), None)
        looks = None if entry is None else (entry.eyes if eyes else None) or entry.looks
        return None if looks is None else looks.of({"x": x, "y": y})


def salient_places(message: Mapping[str, Any]) -> list[SalientPlace]:
    """The places of a message of saliency. Raises `RosDataError` if they do not belong together."""
    xs, ys, weights = (message[name] for name in ("locationsX", "locationsY", "weights"))
    if not len(xs) == len(ys) == len(weights):
        raise RosDataError("locationsX, locationsY and weights have different lengths")
    return [SalientPlace(*place) for place in zip(xs, ys, weights, strict=True)]


def sequence_verb(entry: TakenTopic, message: Mapping[str, RosValue]) -> VerbWithArgs | None:
    """The verb of the sequence that is asked for; None: of the one that ends another. Raises
    `RosDataError` for a number that means nothing.
    """
    number = message["sequence"]
    if number == entry.stop:
        return None
    found = entry.sequences.get(str(number))
    call = None if found is None else found.of(message)
    if call is None:
        raise RosDataError(f"there is no sequence {number}; there are {', '.join(entry.sequences)}")
    return call


def load_table(name: str) -> TopicTable:
    """The table of a file, or of one that comes with woz-tui, by its name. Raises
    `ExperimentError` with all that is wrong.
    """
    report = ProblemReport()
    source = source_of(_path(name), report)
    table = None if source is None else _read(source, report)
    if report.errors or table is None:
        raise ExperimentError(report.errors)
    return table


def named_table(cursor: Cursor) -> TopicTable | None:
    """The table that a robot file names, or None after saying what is wrong."""
    text = read_text(cursor, "a file with a table of topics, or the name of one (eyepi)")
    if text is None:
        return None
    base = Path(cursor.place.file).absolute().parent
    source = named_source(cursor, str(_path(text)), base, lambda: "")
    if source is None:
        return None
    cursor.report.included.append(source)
    return _read(source, cursor.report)


def _path(name: str) -> Path:
    """The file that is meant; a name without a file stands for itself."""
    return (None if is_path(name) else bundled_file(f"{FOLDER}/{name}.yaml")) or Path(name)


def _read(source: SourceFile, report: ProblemReport) -> TopicTable | None:
    root = document(source, report, "a table of topics, such as takes: ...")
    return read_section(root, TopicTable)


def _wrong_types(types: Mapping[str, Any]) -> list[tuple[str, str]]:
    return [
        (join("fields", name), f"{kind!r} is no type: {', '.join(EMPTY)}, or a list of one")
        for name, kind in types.items()
        if not _is_type(kind)
    ]


def _is_place(name: str, types: Mapping[str, Any]) -> bool:
    """Whether it is a single field, or the entry of a list: position.0."""
    outer, _, place = name.partition(".")
    kind = types.get(outer)
    return place.isascii() and place.isdigit() if isinstance(kind, list) else kind in EMPTY


def _numbers(name: str, shown: Iterable[str]) -> list[int]:
    """The numbers of a list's entries among `shown`, in order."""
    parts = (each.partition(".") for each in shown)
    return sorted(int(place) for outer, _, place in parts if outer == name and place.isdecimal())


def _is_type(kind: object) -> bool:
    match kind:
        case str():
            return kind in EMPTY
        case [inner]:
            return _is_type(inner)
        case dict():
            return bool(kind) and all(map(_is_type, kind.values()))
    return False


def _spelt(kind: RosType) -> str:
    return kind if isinstance(kind, str) else f"[{kind[0]}]" if isinstance(kind, list) else "{...}"


def _unknown_fields(call: TopicVerb, fields: Mapping[str, Any]) -> Iterator[tuple[str, str]]:
    for name, source in call.args.items():
        if not isinstance(source, FieldSource):
            continue
        outer, dot, _ = source.field_.partition(".")
        if outer not in fields or (dot and isinstance(fields[outer], str)):
            yield name, f"the message has no field {source.field_!r}"
