"""Move files: one move each, in a folder, written by hand or by a recording.

    name: greet
    about: looks up and nods
    frames:
      - {seconds: 0.3, nod: -8, emotion: happy, intensity: 0.8}
      - {seconds: 0.4, nod: 12}
      - {seconds: 0.5, nod: 0, sound: ../media/gong.wav}

Angles are named by role, which fits every body, or by joint. Every mistake is reported with its
line, all at once; what cannot be a mistake of typing is left to the engine, which is safe anyway.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from woz_tui.config.annotated_decoder import resolve_path
from woz_tui.config.experiment import FilePosition, Problem
from woz_tui.config.file_text import SourceFile, SourceFileError, read_source
from woz_tui.config.problems import ProblemReport, quoted
from woz_tui.config.yaml_cursor import (
    Cursor,
    missing,
    read_flag,
    read_number,
    read_seconds,
    read_text,
    read_word,
)
from woz_tui.config.yaml_nodes import ListNode, MappingNode, described, parse_yaml
from woz_tui.drivers.fields import Range
from woz_tui.motion.body_shape import ROLES, BodyShape, JointShape
from woz_tui.motion.body_verbs import EMOTIONS
from woz_tui.motion.builtin_moves import BUILT_IN
from woz_tui.motion.easing import EASINGS
from woz_tui.motion.keyframes import (
    MIXES,
    PLACE_DECIMALS,
    KeyFrame,
    KeyframeMove,
    LayerSamples,
    MoveLayer,
)

# -- moveframes -----------------------------------------------------------------------------------
# The frames and the samples of a move file's layer.

#: What a frame may say beside names of roles and joints.
FRAME = (
    *("seconds", "beats", "at", "easing", "emotion", "intensity", "eyes", "lid"),
    *("sound", "volume", "roles", "joints"),
)
#: Degrees that a frame may name at most, and seconds or beats it may take.
ANGLES = Range(-360, 360, "deg")
LENGTHS = Range(0, 600)
RATES = Range(0.1, 1000)
UNIT = Range(0, 1)
BOTH = Range(-1, 1)
#: Range of each number of a face.
FEATURE_RANGES: Mapping[str, Range] = {"x": BOTH, "y": BOTH, "lid": UNIT, "intensity": UNIT}

#: What the eyes of a frame are expected to be.
_EYES = "where they look, such as {x: 0.2, y: 0}"
T = TypeVar("T")
_SAMPLE = re.compile(r"[-+]?(\d{1,9}(\.\d{0,60})?|\.\d{1,60})([eE][-+]?\d{1,3})?")


class MoveLayerReader:
    """Reads one layer's angles and times; `named` collects the roles and joints it met."""

    def __init__(self, shape: BodyShape, *, beats: bool, relative: bool) -> None:
        self._joints = shape.joints
        self._beats = beats
        self._relative = relative
        self.named: set[str] = set()

    def read(self, cursor: Cursor) -> tuple[KeyFrame, ...]:
        """All frames that are right."""
        entries = cursor.list("a list of frames, such as [{seconds: 0.3, nod: 12}]")
        if entries is not None and not entries:
            cursor.error("no frame stands here")
        frames: list[KeyFrame] = []
        before = 0.0
        for index, entry in enumerate(entries or ()):
            table = entry.table("a frame, such as {seconds: 0.3, nod: 12}")
            if table is None:
                continue
            place = self._place(entry, table, before, first=index == 0)
            before = before if place is None else place
            frames.append(self._frame(table, before))
        return tuple(frames)

    # -- when -----------------------------------------------------------------------------------

    def _place(
        self, cursor: Cursor, table: dict[str, Cursor], before: float, *, first: bool
    ) -> float | None:
        unit, other = ("beats", "seconds") if self._beats else ("seconds", "beats")
        if (wrong := table.get(other)) is not None:
            said = "true" if self._beats else "false"
            wrong.error(f"this move counts {unit} (beats: {said}); write {unit} here")
            return None
        took, at = table.get(unit), table.get("at")
        if took is not None and at is not None:
            at.error(f"write either {unit}, from the frame before, or at, from the beginning")
            return None
        if at is not None:
            return self._moment(at, before, first=first)
        if took is None:
            missing(table, unit, cursor, "how long it takes from the frame before")
            return None
        length = self._duration(took)
        if length is not None and length <= 0 and not first:
            took.error("must be more than 0; only the first frame may be at the very beginning")
            return None
        return None if length is None else round(before + length, PLACE_DECIMALS)

    def _moment(self, cursor: Cursor, before: float, *, first: bool) -> float | None:
        at = self._duration(cursor)
        if at is None or (first and at >= 0) or at > before:
            return None if at is None else round(at, PLACE_DECIMALS)
        cursor.error(f"{at:g} is not after the frame before, which is at {before:g}")
        return None

    def _duration(self, cursor: Cursor) -> float | None:
        return read_number(cursor, LENGTHS) if self._beats else read_seconds(cursor, LENGTHS)

    # -- what -----------------------------------------------------------------------------------

    def _frame(self, table: dict[str, Cursor], at: float) -> KeyFrame:
        roles, joints = self._angles(table)
        eyes = _known(table.get("eyes"), ("x", "y"), "eyes have", _EYES)
        sound = _given(table, "sound", "", read_text, "a sound file")
        if "volume" in table and "sound" not in table:
            table["volume"].warning("there is no sound in this frame")
        return KeyFrame(
            at,
            roles,
            joints,
            easing=_given(table, "easing", "smooth", read_word, EASINGS),
            emotion=_given(table, "emotion", None, read_word, EMOTIONS),
            intensity=_given(table, "intensity", None, read_number, UNIT),
            x=_given(eyes, "x", None, read_number, BOTH),
            y=_given(eyes, "y", None, read_number, BOTH),
            lid=_given(table, "lid", None, read_number, UNIT),
            sound=sound and resolve_path(table["sound"], sound, must_exist=True),
            volume=_given(table, "volume", 1.0, read_number, UNIT),
        )

    def _angles(self, table: dict[str, Cursor]) -> tuple[dict[str, float], dict[str, float]]:
        """Those of roles and of joints."""
        roles: dict[str, Cursor] = {}
        joints: dict[str, Cursor] = {}
        for name, entry in table.items():
            if self.is_joint(name):
                joints[name] = entry
            elif name in ROLES:
                roles[name] = entry
            elif name not in FRAME:
                entry.unknown((*ROLES, *self._joints, *FRAME), "a frame may name")
        roles |= _known(table.get("roles"), ROLES, "roles are")
        joints |= _known(table.get("joints"), self._joints, "joints are")
        self.named |= {*roles, *joints}
        turned = {name: read_number(entry, ANGLES) for name, entry in roles.items()}
        moved = {name: self.joint(entry, name) for name, entry in joints.items()}
        return _read(turned), _read(moved)

    def is_joint(self, name: str) -> bool:
        """Whether a name alone means a joint: what is both is a role, but among absolute angles."""
        known = name in self._joints and name not in FRAME
        return known and (name not in ROLES or not self._relative)

    def joint(self, cursor: Cursor, name: str) -> float | None:
        """An angle of a joint: inside its range if it is absolute."""
        angle = read_number(cursor, ANGLES)
        if angle is not None:
            self.check(cursor, name, self._joints[name], (angle,))
        return angle

    def check(
        self, cursor: Cursor, name: str, joint: JointShape, angles: tuple[float, ...]
    ) -> None:
        """Report the first angle that the joint cannot have."""
        for angle in angles:
            if not self._relative and not joint.min <= angle <= joint.max:
                cursor.error(
                    f"{angle:g} lies outside the joint's range,"
                    f" {joint.min:g} to {joint.max:g} degrees"
                )
                return
            if self._relative and abs(angle) > joint.max - joint.min:
                cursor.warning(
                    f"{angle:g} degrees are more than {name!r} can turn in all"
                    f" ({joint.max - joint.min:g})"
                )
                return

    # -- samples --------------------------------------------------------------------------------

    def samples(self, cursor: Cursor, table: dict[str, Cursor]) -> LayerSamples | None:
        """The dense part of a layer; None if it has none."""
        if not table.keys() & {"joints", "roles", "face"}:
            if "rate" in table:
                table["rate"].error("there are no samples: joints, roles or face are missing")
            return None
        missing(table, "rate", cursor, "samples each second, or beat")
        rate = _given(table, "rate", 1.0, read_number, RATES)
        roles = _lists(table.get("roles"), dict.fromkeys(ROLES, ANGLES), "roles are")
        face = _lists(table.get("face"), FEATURE_RANGES, "samples of a face are")
        known = dict.fromkeys(self._joints, ANGLES)
        joints = _lists(table.get("joints"), known, "joints are")
        for name, values in joints.items():
            entry = dict(table["joints"].entries())[name]
            self.check(entry, name, self._joints[name], values)
        return LayerSamples(rate, roles, joints, face)


def _given(
    table: Mapping[str, Cursor], name: str, default: T, read: Callable[..., T | None], *allowed: Any
) -> T:
    """What an entry says; the default if it is missing, or wrong, which is reported."""
    cursor = table.get(name)
    value = None if cursor is None else read(cursor, *allowed)
    return default if value is None else value


def _known(
    cursor: Cursor | None, names: Collection[str], listing: str, expected: str = "a mapping"
) -> dict[str, Cursor]:
    """The entries of a mapping that have one of these names; others are reported."""
    table = (cursor.table(expected) if cursor is not None else None) or {}
    for name, entry in table.items():
        if name not in names:
            entry.unknown(names, listing)
    return {name: entry for name, entry in table.items() if name in names}


def _read(angles: Mapping[str, float | None]) -> dict[str, float]:
    return {name: angle for name, angle in angles.items() if angle is not None}


def _lists(
    cursor: Cursor | None, ranges: Mapping[str, Range], listing: str
) -> dict[str, tuple[float, ...]]:
    lists = {
        name: _numbers(entry, ranges[name])
        for name, entry in _known(cursor, ranges, listing).items()
    }
    return {name: values for name, values in lists.items() if values}


def _numbers(cursor: Cursor, allowed: Range) -> tuple[float, ...]:
    """A list of numbers, or a text of numbers with blanks between them."""
    if not isinstance(cursor.node, ListNode):
        return _written(cursor, read_text(cursor, "numbers") or "", allowed)
    if not cursor.node.nodes:
        cursor.error("no number stands here")
    read_source = [read_number(entry, allowed) for entry in cursor.items()]
    return tuple(number for number in read_source if number is not None)


def _written(cursor: Cursor, text: str, allowed: Range) -> tuple[float, ...]:
    values = []
    for index, word in enumerate(text.split()):
        number = float(word) if _SAMPLE.fullmatch(word) else None
        if number is None or not allowed.contains(number):
            wrong = "is no number" if number is None else f"is out of range; allowed is {allowed}"
            cursor.error(f"sample {index + 1}: {quoted(word)} {wrong}")
            return ()
        values.append(number)
    return tuple(values)


# --------------------------------------------------------------------------------------------------

#: Layer of the frames that stand at a file's top level.
MAIN = "main"
#: What a move file and a layer of it may say.
TOP_LEVEL = ("name", "about", "relative", "beats", "stays", "frames", "layers")
LAYER = ("name", "muted", "share", "mix", "relative", "frames", "rate", "joints", "roles", "face")

#: Seconds (or beats) after which `play` gives up waiting for a move's end.
LONGEST = 120.0

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,31}")
NAME_RULE = "a name has letters, digits, _ and -, and begins with a letter"
_ENDINGS = (".yaml", ".yml")


class MoveFileError(Exception):
    """Files cannot be used; `problems` holds every reason, in the order of files and lines."""

    def __init__(self, problems: list[Problem]) -> None:
        super().__init__("\n".join(map(str, problems)))
        self.problems = problems


@dataclass(frozen=True, slots=True)
class MoveFolder:
    """What a folder holds: the moves that are right, what is wrong or odd, the files read."""

    moves: Mapping[str, KeyframeMove]
    problems: tuple[Problem, ...]
    sources: tuple[SourceFile, ...] = ()


def read_moves(folder: Path, shape: BodyShape) -> Mapping[str, KeyframeMove]:
    """The moves of all files (*.yaml, *.yml) in `folder`, by name.

    Raises `MoveFileError` with every error of every file; nothing else, whatever they hold.
    """
    found = read_folder(folder, shape)
    errors = [problem for problem in found.problems if not problem.warning]
    if errors:
        raise MoveFileError(errors)
    return found.moves


def read_folder(folder: Path, shape: BodyShape) -> MoveFolder:
    """As `read_moves`, with the errors and warnings instead of an exception."""
    report = ProblemReport()
    try:
        files = sorted(
            path
            for path in folder.iterdir()
            if path.suffix in _ENDINGS and not path.name.startswith(".")
        )
    except OSError as error:
        reason = error.strerror or str(error)
        return MoveFolder({}, (Problem(FilePosition(str(folder), 1, 1), "moves", reason),))
    moves: dict[str, KeyframeMove] = {}
    sources: list[SourceFile] = []
    where: dict[str, str] = {}
    for path in files:
        broken = len(report.errors)
        source, root = _root(path, report)
        sources += [] if source is None else [source]
        move = None if root is None else decode(root, path, shape)
        # What is wrong as YAML (a key that stands twice) was reported before it was decoded.
        if move is None or len(report.errors) > broken:
            continue
        if move.name in moves:
            place = report.place("name", str(path))
            report.error(place, "name", f"{quoted(move.name)} is the move of {where[move.name]}")
        moves.setdefault(move.name, move)
        where.setdefault(move.name, path.name)
    return MoveFolder(moves, (*report.errors, *report.warnings), tuple(sources))


def read_move(path: Path, shape: BodyShape) -> KeyframeMove:
    """The move of one file. Raises `MoveFileError`."""
    report = ProblemReport()
    _, root = _root(path, report)
    move = None if root is None else decode(root, path, shape)
    if move is None or report.errors:
        raise MoveFileError(report.errors)
    return move


def _root(path: Path, report: ProblemReport) -> tuple[SourceFile | None, Cursor | None]:
    name = str(path)
    report.file(name)
    try:
        source = read_source(path, name)
    except SourceFileError as error:
        report.error(FilePosition(name, error.line, error.column), "file", error.message)
        return None, None
    broken = len(report.errors)
    node = parse_yaml(source, report)
    start = FilePosition(name, 1, 1)
    if isinstance(node, MappingNode):
        return source, Cursor(node, "", start, report)
    if len(report.errors) == broken:
        said = "nothing" if node is None else described(node)
        report.error(start, "file", f"expected a move, such as name: greet, not {said}")
    return source, None


def decode(root: Cursor, path: Path, shape: BodyShape) -> KeyframeMove | None:
    """The move, or None after reporting what is wrong. Its name is by default the file's."""
    broken = len(root.report.errors)
    move = _MoveDecoder(root, shape).move(path)
    return move if len(root.report.errors) == broken else None


class _MoveDecoder:
    def __init__(self, root: Cursor, shape: BodyShape) -> None:
        self._root = root
        self._shape = shape
        self._broken = len(root.report.errors)
        self._table = dict(root.entries())
        self._beats = _given(self._table, "beats", False, read_flag)
        self._relative = _given(self._table, "relative", True, read_flag)

    def move(self, path: Path) -> KeyframeMove:
        for name, entry in self._table.items():
            if name not in TOP_LEVEL:
                entry.unknown(TOP_LEVEL, "a move has")
        move = KeyframeMove(
            name=self._name(path),
            summary=_given(self._table, "about", "", read_text),
            layers=tuple(self._layers()),
            beats=self._beats,
            stays=_given(self._table, "stays", False, read_flag),
        )
        if len(self._root.report.errors) == self._broken:
            self._length(move)
        return move

    def _name(self, path: Path) -> str:
        cursor = self._table.get("name")
        name = path.stem if cursor is None else read_text(cursor, "the move's name")
        cursor = cursor or self._root
        if name is not None and not NAME.fullmatch(name):
            cursor.error(f"{quoted(name)} cannot be a move's name; {NAME_RULE}")
        elif name in BUILT_IN:
            cursor.warning(f"takes the place of the built-in move {name!r}")
        return name or ""

    def _layers(self) -> list[MoveLayer]:
        layers = []
        frames, many = self._table.get("frames"), self._table.get("layers")
        if frames is not None:
            reader = MoveLayerReader(self._shape, beats=self._beats, relative=self._relative)
            layers.append(MoveLayer(MAIN, reader.read(frames), relative=self._relative))
        elif many is None:
            missing({}, "frames", self._root, "frames: [{seconds: 0.3, nod: 12}, ...]")
        for entry in (many.list("a list of layers") if many is not None else None) or ():
            layer = self._layer(entry)
            if layer is None:
                continue
            if layer.name in [known.name for known in layers]:
                entry.error(f"there is a layer {quoted(layer.name)} already")
            layers.append(layer)
        return layers

    def _layer(self, cursor: Cursor) -> MoveLayer | None:
        table = cursor.table("a layer, such as {name: head, frames: [...]}")
        if table is None:
            return None
        for key, entry in table.items():
            if key not in LAYER:
                entry.unknown(LAYER, "a layer has")
        missing(table, "name", cursor)
        relative = _given(table, "relative", self._relative, read_flag)
        reader = MoveLayerReader(self._shape, beats=self._beats, relative=relative)
        frames = reader.read(table["frames"]) if "frames" in table else ()
        samples = reader.samples(cursor, table)
        if "frames" not in table and samples is None:
            cursor.error("has neither frames nor samples (rate and joints, roles or face)")
        for twice in reader.named & ({*samples.roles, *samples.joints} if samples else set()):
            cursor.error(f"{twice} is in this layer's frames and in its samples; use two layers")
        return MoveLayer(
            _given(table, "name", "", read_text),
            frames,
            samples,
            relative=relative,
            mix=_given(table, "mix", MIXES[0], read_word, MIXES),
            share=_given(table, "share", 1.0, read_number, UNIT),
            muted=_given(table, "muted", False, read_flag),
        )

    def _length(self, move: KeyframeMove) -> None:
        cursor = self._table.get("frames") or self._table.get("layers")
        if cursor is None:
            return
        if move.length <= 0:
            cursor.error("takes no time; a frame after the beginning is missing")
        elif move.length > LONGEST and not move.beats:
            cursor.warning(f"takes {move.length:g} s; play waits for {LONGEST:g} s at most")


# -- JSON Schema ----------------------------------------------------------------------------------
# A little more generous than the reader: which joints there are only a robot file says.

Schema = dict[str, Any]

_TEXT: Schema = {"type": ["string", "number", "boolean"]}
_WHAT_ROLES_DO: Mapping[str, str] = {
    "pan": "degrees to its left",
    "nod": "degrees down",
    "lean": "degrees up and back; negative: forward",
    "roll": "degrees cocked to its right",
}


def move_schema() -> Schema:
    """The schema of move files."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "woz-tui move",
        **_object(
            {
                "name": {
                    "type": "string",
                    "pattern": "^[A-Za-z][A-Za-z0-9_-]{0,31}$",
                    "description": "what play calls it by (default: the file's name)",
                },
                "about": {**_TEXT, "description": "what it looks like, in a few words"},
                "relative": _flag("joints are added to the pose held before (default)"),
                "beats": _flag("count beats of the tempo instead of seconds"),
                "stays": _flag("hold the last pose instead of the one before"),
                "frames": {"$ref": "#/$defs/frames"},
                "layers": {
                    "type": "array",
                    "items": {"$ref": "#/$defs/layer"},
                    "description": "parts that play in sync, each laid on those before",
                },
            }
        ),
        "anyOf": [{"required": ["frames"]}, {"required": ["layers"]}],
        "$defs": {
            "frames": {
                "type": "array",
                "items": {"$ref": "#/$defs/frame"},
                "minItems": 1,
                "description": "moments at which something is reached",
            },
            "frame": _frame(),
            "layer": _layer(),
            "samples": {
                "description": "numbers with blanks between them, or a list of numbers",
                "oneOf": [
                    {"type": ["string", "number"]},
                    {"type": "array", "items": {"type": "number"}, "minItems": 1},
                ],
            },
        },
    }


def _frame() -> Schema:
    """Whatever else a frame names is a joint."""
    time = {"oneOf": [_number(LENGTHS), {"type": "string", "pattern": r"^\s*[0-9.]+\s*(ms|s)?$"}]}
    return {
        "type": "object",
        "properties": {
            "seconds": {**time, "description": "from the frame before"},
            "beats": _number(LENGTHS, "from the frame before, with beats: true"),
            "at": {**time, "description": "from the beginning of the move"},
            "easing": {"enum": list(EASINGS), "description": "how it gets there (default: smooth)"},
            "emotion": {"enum": list(EMOTIONS), "description": "face that comes on till then"},
            "intensity": _number(UNIT, "of the emotion"),
            "eyes": {
                **_object({"x": _number(FEATURE_RANGES["x"]), "y": _number(FEATURE_RANGES["y"])}),
                "description": "where they look: x to its left, y up, -1 to 1",
            },
            "lid": _number(UNIT, "how far the eyes are open"),
            "sound": {"type": "string", "description": "file, relative to this one"},
            "volume": _number(UNIT, "of the sound"),
            "roles": {
                **_object({role: _role(role) for role in ROLES}),
                "description": "roles by name, where a joint has the name of a role",
            },
            "joints": {
                "type": "object",
                "additionalProperties": _number(ANGLES),
                "description": "joints by name, where a role has the name of a joint",
            },
            **{role: _role(role) for role in ROLES},
        },
        "additionalProperties": _number(ANGLES),
        "oneOf": [{"required": [name]} for name in ("seconds", "beats", "at")],
    }


def _layer() -> Schema:
    samples = {"$ref": "#/$defs/samples"}
    schema = _object(
        {
            "name": {**_TEXT, "description": "unique in the file"},
            "muted": _flag("leave it out; it still counts for the length"),
            "share": _number(UNIT, "how much of it counts (default: 1)"),
            "mix": {"enum": list(MIXES), "description": "added to the layers below (default)"},
            "relative": _flag("as the move's, for this layer"),
            "frames": {"$ref": "#/$defs/frames"},
            "rate": _number(RATES, "samples each second, or beat"),
            "joints": {
                "type": "object",
                "additionalProperties": samples,
                "description": "samples in degrees by joint",
            },
            "roles": _object(dict.fromkeys(ROLES, samples)),
            "face": _object(dict.fromkeys(FEATURE_RANGES, samples)),
        },
    )
    groups = ("frames", "joints", "roles", "face")
    return {
        **schema,
        "required": ["name"],
        "anyOf": [{"required": [name]} for name in groups],
        "dependentRequired": {name: ["rate"] for name in groups[1:]},
    }


def _role(role: str) -> Schema:
    return _number(ANGLES, _WHAT_ROLES_DO[role])


def _flag(description: str) -> Schema:
    return {"enum": [True, False, "yes", "no", "on", "off"], "description": description}


def _number(allowed: Range, description: str = "") -> Schema:
    schema: Schema = {"type": "number", "minimum": allowed.low, "maximum": allowed.high}
    return {**schema, "description": description} if description else schema


def _object(properties: Schema) -> Schema:
    return {"type": "object", "properties": properties, "additionalProperties": False}
