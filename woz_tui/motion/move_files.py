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
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from woz_tui.config.annotated_decoder import fields_of, read_section
from woz_tui.config.file_position import FilePosition, Problem
from woz_tui.config.file_text import SourceFile, SourceFileError, read_source
from woz_tui.config.problems import ProblemReport, quoted
from woz_tui.config.yaml_cursor import (
    Cursor,
    document,
    missing,
    range_text,
    read_number,
    read_seconds,
    read_text,
    source_of,
)
from woz_tui.config.yaml_nodes import ListNode
from woz_tui.drivers import fields
from woz_tui.drivers.fields import Doc, OneOf, Range, Section
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
from woz_tui.motion.move_limits import shortfalls
from woz_tui.protocol.sentence import Sentence

#: Degrees that a frame may name at most, and seconds or beats it may take.
ANGLES = Range(-360, 360, "deg")
LENGTHS = Range(0, 600)
RATES = Range(0.1, 1000)
UNIT = Range(0, 1)
BOTH = Range(-1, 1)
#: Range of each number of a face.
FEATURE_RANGES: Mapping[str, Range] = {"x": BOTH, "y": BOTH, "lid": UNIT, "intensity": UNIT}
#: Layer of the frames that stand at a file's top level.
MAIN = "main"
#: Seconds (or beats) after which `play` gives up waiting for a move's end.
LONGEST = 120.0

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,31}")
NAME_RULE = Sentence(
    "check.name_rule", "a name has letters, digits, _ and -, and begins with a letter"
)
_ENDINGS = (".yaml", ".yml")
_SAMPLE = re.compile(r"[-+]?(\d{1,9}(\.\d{0,60})?|\.\d{1,60})([eE][-+]?\d{1,3})?")

# -- what files hold ------------------------------------------------------------------------------
# As the annotations say it, reader and JSON Schema alike; the rest depends on the body, or on
# whether the move counts beats.


@dataclass(frozen=True, slots=True)
class RoleAngles(Section):
    pan: Annotated[float | None, ANGLES, Doc("degrees to its left")] = None
    nod: Annotated[float | None, ANGLES, Doc("degrees down")] = None
    lean: Annotated[float | None, ANGLES, Doc("degrees up and back; negative: forward")] = None
    roll: Annotated[float | None, ANGLES, Doc("degrees cocked to its right")] = None

    def given(self) -> dict[str, float]:
        """The roles that are named."""
        angles = {role: getattr(self, role) for role in ROLES}
        return {role: angle for role, angle in angles.items() if angle is not None}


@dataclass(frozen=True, slots=True)
class EyesEntry:
    """Where the eyes look."""

    x: Annotated[float | None, BOTH, Doc("to its left")] = None
    y: Annotated[float | None, BOTH, Doc("up")] = None


@dataclass(frozen=True, slots=True)
class FrameEntry(RoleAngles):
    """What a frame may say beside its time and the names of joints."""

    easing: Annotated[str, OneOf(tuple(EASINGS)), Doc("how it gets there")] = "smooth"
    emotion: Annotated[str | None, OneOf(EMOTIONS), Doc("face that comes on till then")] = None
    intensity: Annotated[float | None, UNIT, Doc("of the emotion")] = None
    eyes: Annotated[EyesEntry, Doc("where they look, such as {x: 0.2, y: 0}")] = EyesEntry()
    lid: Annotated[float | None, UNIT, Doc("how far the eyes are open")] = None
    sound: Annotated[str, fields.Path(must_exist=True), Doc("file, relative to this one")] = ""
    volume: Annotated[float, UNIT, Doc("of the sound")] = 1.0
    roles: Annotated[RoleAngles, Doc("roles by name, where a joint has the name of a role")] = (
        RoleAngles()
    )

    def warnings(self) -> list[tuple[str, str]]:
        """A volume without a sound."""
        silent = self.volume != 1.0 and not self.sound
        silence = Sentence("move.silent", "there is no sound in this frame")
        return [("volume", silence)] if silent else []


@dataclass(frozen=True, slots=True)
class LayerEntry:
    """What a layer may say beside its frames and samples."""

    name: Annotated[str, Doc("unique in the file")]
    muted: Annotated[bool, Doc("leave it out; it still counts for the length")] = False
    share: Annotated[float, UNIT, Doc("how much of it counts")] = 1.0
    mix: Annotated[str, OneOf(MIXES), Doc("added to the layers below, or in their place")] = "add"
    relative: Annotated[bool | None, Doc("as the move's, for this layer")] = None
    rate: Annotated[float | None, RATES, Doc("samples each second, or beat")] = None


@dataclass(frozen=True, slots=True)
class MoveEntry:
    """What a move file may say beside its name, frames and layers."""

    about: Annotated[str, Doc("what it looks like, in a few words")] = ""
    relative: Annotated[bool, Doc("joints are added to the pose held before")] = True
    beats: Annotated[bool, Doc("count beats of the tempo instead of seconds")] = False
    stays: Annotated[bool, Doc("hold the last pose instead of the one before")] = False


# -- frames and samples of one layer ---------------------------------------------------------------


class MoveLayerReader:
    """Reads one layer's angles and times; `named` collects the roles and joints it met."""

    def __init__(self, shape: BodyShape, *, beats: bool, relative: bool) -> None:
        self._joints = shape.joints
        self._beats = beats
        self._relative = relative
        own = {"seconds", "beats", "at", "joints", *(item.name for item in fields_of(FrameEntry))}
        #: Joints that a frame may name beside all else: what is both is a role, but among absolute
        #: angles.
        self._inline = [
            name
            for name in self._joints
            if name not in own or (name in ROLES and not self._relative)
        ]
        self.named: set[str] = set()

    def read(self, cursor: Cursor) -> tuple[KeyFrame, ...]:
        """All frames that are right."""
        entries = cursor.list(
            Sentence("move.frames_listed", "a list of frames, such as [{{seconds: 0.3, nod: 12}}]")
        )
        if entries is not None and not entries:
            cursor.error(Sentence("move.no_frame", "no frame stands here"))
        frames: list[KeyFrame] = []
        before = 0.0
        for index, entry in enumerate(entries or ()):
            table = entry.table(
                Sentence("move.a_frame", "a frame, such as {{seconds: 0.3, nod: 12}}")
            )
            if table is None:
                continue
            place = self._place(entry, table, before, first=index == 0)
            before = before if place is None else place
            frame = self._frame(entry, table, before)
            frames += [] if frame is None else [frame]
        return tuple(frames)

    # -- when -----------------------------------------------------------------------------------

    def _place(
        self, cursor: Cursor, table: dict[str, Cursor], before: float, *, first: bool
    ) -> float | None:
        unit, other = ("beats", "seconds") if self._beats else ("seconds", "beats")
        if (wrong := table.get(other)) is not None:
            text = "true" if self._beats else "false"
            wrong.error(
                Sentence(
                    "move.counts_units",
                    "this move counts {unit} (beats: {text}); write {unit} here",
                    unit=unit,
                    text=text,
                )
            )
            return None
        took, at = table.get(unit), table.get("at")
        if took is not None and at is not None:
            at.error(
                Sentence(
                    "move.place_twice",
                    "write either {unit}, from the frame before, or at, from the beginning",
                    unit=unit,
                )
            )
            return None
        if at is not None:
            moment = self._duration(at)
            if moment is not None and moment <= before and not (first and moment >= 0):
                at.error(
                    Sentence(
                        "move.not_after",
                        "{moment:g} is not after the frame before, which is at {before:g}",
                        moment=moment,
                        before=before,
                    )
                )
                return None
            return None if moment is None else round(moment, PLACE_DECIMALS)
        if took is None:
            missing(
                table,
                unit,
                cursor,
                Sentence("move.how_long", "how long it takes from the frame before"),
            )
            return None
        length = self._duration(took)
        if length is not None and length <= 0 and not first:
            took.error(
                Sentence(
                    "move.more_than_zero",
                    "must be more than 0; only the first frame may be at the very beginning",
                )
            )
            return None
        return None if length is None else round(before + length, PLACE_DECIMALS)

    def _duration(self, cursor: Cursor) -> float | None:
        return read_number(cursor, LENGTHS) if self._beats else read_seconds(cursor, LENGTHS)

    # -- what -----------------------------------------------------------------------------------

    def _frame(self, cursor: Cursor, table: dict[str, Cursor], at: float) -> KeyFrame | None:
        others = ("seconds", "beats", "at", "joints", *self._inline)
        entry = read_section(cursor, FrameEntry, others)
        joints = {name: table[name] for name in self._inline if name in table}
        joints |= _entries_named(
            table.get("joints"), self._joints, Sentence("move.joints_are", "joints are")
        )
        angles = {name: self._angle(spot, name) for name, spot in joints.items()}
        if entry is None:
            return None
        roles = {**entry.given(), **entry.roles.given()}
        self.named |= {*roles, *joints}
        return KeyFrame(
            at,
            roles,
            {name: angle for name, angle in angles.items() if angle is not None},
            entry.easing,
            entry.emotion,
            entry.intensity,
            entry.eyes.x,
            entry.eyes.y,
            entry.lid,
            entry.sound,
            entry.volume,
        )

    def _angle(self, cursor: Cursor, name: str) -> float | None:
        """An angle of a joint: inside its range if it is absolute."""
        angle = read_number(cursor, ANGLES)
        if angle is not None:
            self._check(cursor, name, self._joints[name], (angle,))
        return angle

    def _check(
        self, cursor: Cursor, name: str, joint: JointShape, angles: tuple[float, ...]
    ) -> None:
        """Report the first angle that the joint cannot have."""
        for angle in angles:
            if not self._relative and not joint.min <= angle <= joint.max:
                cursor.error(
                    Sentence(
                        "move.outside_joint",
                        "{angle:g} lies outside the joint's range, {low:g} to {high:g} degrees",
                        angle=angle,
                        low=joint.min,
                        high=joint.max,
                    )
                )
                return
            if self._relative and abs(angle) > joint.max - joint.min:
                cursor.warning(
                    Sentence(
                        "move.more_than_joint",
                        "{angle:g} degrees are more than {name!r} can turn in all ({range:g})",
                        angle=angle,
                        name=name,
                        range=joint.max - joint.min,
                    )
                )
                return

    # -- samples --------------------------------------------------------------------------------

    def samples(self, cursor: Cursor, table: dict[str, Cursor], rate: float) -> LayerSamples | None:
        """The dense part of a layer; None if it has none."""
        if not table.keys() & {"joints", "roles", "face"}:
            if "rate" in table:
                table["rate"].error(
                    Sentence(
                        "move.no_samples", "there are no samples: joints, roles or face are missing"
                    )
                )
            return None
        missing(
            table, "rate", cursor, Sentence("move.samples_rate", "samples each second, or beat")
        )
        roles = _lists(
            table.get("roles"),
            dict.fromkeys(ROLES, ANGLES),
            Sentence("move.roles_are", "roles are"),
        )
        face = _lists(table.get("face"), FEATURE_RANGES, "samples of a face are")
        known = dict.fromkeys(self._joints, ANGLES)
        joints = _lists(table.get("joints"), known, Sentence("move.joints_are", "joints are"))
        for name, values in joints.items():
            entry = dict(table["joints"].entries())[name]
            self._check(entry, name, self._joints[name], values)
        return LayerSamples(rate, roles, joints, face)


def _entries_named(
    cursor: Cursor | None, names: Collection[str], listing: str
) -> dict[str, Cursor]:
    """The entries of a mapping that have one of these names; others are reported."""
    table = (
        cursor.table(Sentence("check.a_mapping", "a mapping")) if cursor is not None else None
    ) or {}
    for name, entry in table.items():
        if name not in names:
            entry.unknown(names, listing)
    return {name: entry for name, entry in table.items() if name in names}


def _lists(
    cursor: Cursor | None, ranges: Mapping[str, Range], listing: str
) -> dict[str, tuple[float, ...]]:
    lists = {
        name: _numbers(entry, ranges[name])
        for name, entry in _entries_named(cursor, ranges, listing).items()
    }
    return {name: values for name, values in lists.items() if values}


def _numbers(cursor: Cursor, allowed: Range) -> tuple[float, ...]:
    """A list of numbers, or a text of numbers with blanks between them."""
    if isinstance(cursor.node, ListNode):
        if not cursor.node.nodes:
            cursor.error(Sentence("move.no_numbers", "no number stands here"))
        numbers = [read_number(entry, allowed) for entry in cursor.items()]
        return tuple(number for number in numbers if number is not None)
    values = []
    for index, word in enumerate(
        (read_text(cursor, Sentence("move.numbers", "numbers")) or "").split()
    ):
        number = float(word) if _SAMPLE.fullmatch(word) else None
        if number is None or not allowed.contains(number):
            where, said = index + 1, quoted(word)
            cursor.error(
                Sentence(
                    "move.sample_no_number",
                    "sample {number}: {text} is no number",
                    number=where,
                    text=said,
                )
                if number is None
                else Sentence(
                    "move.sample_out_of_range",
                    "sample {number}: {text} is out of range; allowed is {allowed}",
                    number=where,
                    text=said,
                    allowed=range_text(allowed),
                )
            )
            return ()
        values.append(number)
    return tuple(values)


# -- files ----------------------------------------------------------------------------------------


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
            report.error(
                place,
                "name",
                Sentence(
                    "move.taken",
                    "{name} is the move of {file}",
                    name=quoted(move.name),
                    file=where[move.name],
                ),
            )
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


def read_move_text(text: str, shape: BodyShape) -> KeyframeMove:
    """The move of a file's text, whose sounds are named by their whole paths. Raises
    `MoveFileError`.
    """
    report = ProblemReport()
    path = Path("/move.yaml")
    move = None
    try:
        source = read_source(path, "move", text.encode("utf-8", "replace"))
    except SourceFileError as error:
        place = FilePosition("move", error.line, error.column)
        raise MoveFileError([Problem(place, "move", error.message)]) from error
    root = document(source, report, Sentence("move.a_move", "a move, such as name: greet"))
    if root is not None:
        move = decode(root, path, shape)
    if move is None or report.errors:
        raise MoveFileError(report.errors)
    return move


def _root(path: Path, report: ProblemReport) -> tuple[SourceFile | None, Cursor | None]:
    source = source_of(path, report)
    if source is None:
        return None, None
    return source, document(source, report, Sentence("move.a_move", "a move, such as name: greet"))


def decode(root: Cursor, path: Path, shape: BodyShape) -> KeyframeMove | None:
    """The move, or None after reporting what is wrong. Its name is by default the file's."""
    broken = len(root.report.errors)
    table = dict(root.entries())
    entry = read_section(root, MoveEntry, ("name", "frames", "layers")) or MoveEntry()
    move = KeyframeMove(
        name=_move_name(table.get("name"), root, path),
        summary=entry.about,
        layers=tuple(_layers(root, table, entry, shape)),
        beats=entry.beats,
        stays=entry.stays,
    )
    timed = table.get("frames") or table.get("layers")
    if len(root.report.errors) > broken or timed is None:
        return None
    if move.length <= 0:
        timed.error(
            Sentence("move.takes_no_time", "takes no time; a frame after the beginning is missing")
        )
        return None
    if move.length > LONGEST and not move.beats:
        timed.warning(
            Sentence(
                "move.takes_long",
                "takes {length:g} s; play waits for {longest:g} s at most",
                length=move.length,
                longest=LONGEST,
            )
        )
    else:
        _warn_of_shortfalls(table, move, shape)
    return move


def _warn_of_shortfalls(table: Mapping[str, Cursor], move: KeyframeMove, shape: BodyShape) -> None:
    """At each frame that the body's joints do not reach in time."""
    frames = {MAIN: table.get("frames")}
    if (layers := table.get("layers")) is not None:
        entries = [dict(each.entries()) for each in layers.items()]
        frames |= {
            layer.name: entry.get("frames")
            for layer, entry in zip(move.layers[-len(entries) :], entries, strict=True)
        }
    for each in shortfalls(move, shape):
        listed = frames.get(each.layer)
        if listed is not None:
            [*listed.items()][each.frame - 1].warning(each.sentence)


def _move_name(cursor: Cursor | None, root: Cursor, path: Path) -> str:
    name = (
        path.stem
        if cursor is None
        else read_text(cursor, Sentence("move.name_expected", "the move's name"))
    )
    cursor = cursor or root
    if name is not None and not NAME.fullmatch(name):
        cursor.error(
            Sentence(
                "move.not_a_name",
                "{name} cannot be a move's name; {rule}",
                name=quoted(name),
                rule=NAME_RULE,
            )
        )
    elif name in BUILT_IN:
        cursor.warning(
            Sentence(
                "move.replaces_built_in", "takes the place of the built-in move {name!r}", name=name
            )
        )
    return name or ""


def _layers(
    root: Cursor, table: Mapping[str, Cursor], move: MoveEntry, shape: BodyShape
) -> list[MoveLayer]:
    layers = []
    frames, many = table.get("frames"), table.get("layers")
    if frames is not None:
        reader = MoveLayerReader(shape, beats=move.beats, relative=move.relative)
        layers.append(MoveLayer(MAIN, reader.read(frames), relative=move.relative))
    elif many is None:
        missing(
            {},
            "frames",
            root,
            Sentence("move.frames_example", "frames: [{{seconds: 0.3, nod: 12}}, ...]"),
        )
    for entry in (
        many.list(Sentence("move.layers", "a list of layers")) if many is not None else None
    ) or ():
        layer = _layer(entry, move, shape)
        if layer is None:
            continue
        if layer.name in [known.name for known in layers]:
            entry.error(
                Sentence(
                    "move.layer_taken", "there is a layer {name} already", name=quoted(layer.name)
                )
            )
        layers.append(layer)
    return layers


def _layer(cursor: Cursor, move: MoveEntry, shape: BodyShape) -> MoveLayer | None:
    table = cursor.table(Sentence("move.a_layer", "a layer, such as {{name: head, frames: [...]}}"))
    if table is None:
        return None
    entry = read_section(cursor, LayerEntry, ("frames", "joints", "roles", "face"))
    relative = move.relative if entry is None or entry.relative is None else entry.relative
    reader = MoveLayerReader(shape, beats=move.beats, relative=relative)
    frames = reader.read(table["frames"]) if "frames" in table else ()
    samples = reader.samples(cursor, table, entry.rate if entry and entry.rate else 1.0)
    if "frames" not in table and samples is None:
        cursor.error(
            Sentence(
                "move.layer_empty",
                "has neither frames nor samples (rate and joints, roles or face)",
            )
        )
    for twice in reader.named & ({*samples.roles, *samples.joints} if samples else set()):
        cursor.error(
            Sentence(
                "move.twice_in_layer",
                "{twice} is in this layer's frames and in its samples; use two layers",
                twice=twice,
            )
        )
    if entry is None:
        return None
    return MoveLayer(entry.name, frames, samples, relative, entry.mix, entry.share, entry.muted)
