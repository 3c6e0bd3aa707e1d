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
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from woz_tui.core.fields import Range
from woz_tui.experiment.nodes import Table, described, tree
from woz_tui.experiment.report import Report, quoted
from woz_tui.experiment.shape import Place, Problem
from woz_tui.experiment.source import Source, SourceError, read
from woz_tui.experiment.spot import Spot, missing, read_flag, read_number, read_text, read_word
from woz_tui.motion.builtin import BUILT_IN
from woz_tui.motion.keyframes import MIXES, KeyframeMove, Layer
from woz_tui.motion.moveframes import FrameReader, read_samples
from woz_tui.motion.shapes import BodyShape

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
    sources: tuple[Source, ...] = ()


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
    report = Report()
    try:
        files = sorted(
            path
            for path in folder.iterdir()
            if path.suffix in _ENDINGS and not path.name.startswith(".")
        )
    except OSError as error:
        reason = error.strerror or str(error)
        return MoveFolder({}, (Problem(Place(str(folder), 1, 1), "moves", reason),))
    moves: dict[str, KeyframeMove] = {}
    sources: list[Source] = []
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
    report = Report()
    _, root = _root(path, report)
    move = None if root is None else decode(root, path, shape)
    if move is None or report.errors:
        raise MoveFileError(report.errors)
    return move


def _root(path: Path, report: Report) -> tuple[Source | None, Spot | None]:
    name = str(path)
    report.file(name)
    try:
        source = read(path, name)
    except SourceError as error:
        report.error(Place(name, error.line, error.column), "file", error.message)
        return None, None
    broken = len(report.errors)
    node = tree(source, report)
    start = Place(name, 1, 1)
    if isinstance(node, Table):
        return source, Spot(node, "", start, report)
    if len(report.errors) == broken:
        said = "nothing" if node is None else described(node)
        report.error(start, "file", f"expected a move, such as name: greet, not {said}")
    return source, None


def decode(root: Spot, path: Path, shape: BodyShape) -> KeyframeMove | None:
    """The move, or None after reporting what is wrong. Its name is by default the file's."""
    broken = len(root.report.errors)
    move = _Decoder(root, shape).move(path)
    return move if len(root.report.errors) == broken else None


class _Decoder:
    def __init__(self, root: Spot, shape: BodyShape) -> None:
        self._root = root
        self._shape = shape
        self._broken = len(root.report.errors)
        self._table = dict(root.entries())
        self._beats = self._flag("beats", False)
        self._relative = self._flag("relative", True)

    def _flag(self, name: str, default: bool) -> bool:
        spot = self._table.get(name)
        flag = None if spot is None else read_flag(spot)
        return default if flag is None else flag

    def move(self, path: Path) -> KeyframeMove:
        for name, entry in self._table.items():
            if name not in TOP_LEVEL:
                entry.unknown(TOP_LEVEL, "a move has")
        move = KeyframeMove(
            name=self._name(path),
            summary=self._about(),
            layers=tuple(self._layers()),
            beats=self._beats,
            stays=self._flag("stays", False),
        )
        if len(self._root.report.errors) == self._broken:
            self._length(move)
        return move

    def _name(self, path: Path) -> str:
        spot = self._table.get("name")
        name = path.stem if spot is None else read_text(spot, "the move's name")
        spot = spot or self._root
        if name is not None and not NAME.fullmatch(name):
            spot.error(f"{quoted(name)} cannot be a move's name; {NAME_RULE}")
        elif name in BUILT_IN:
            spot.warning(f"takes the place of the built-in move {name!r}")
        return name or ""

    def _about(self) -> str:
        spot = self._table.get("about")
        return "" if spot is None else read_text(spot) or ""

    def _layers(self) -> list[Layer]:
        layers = []
        frames, many = self._table.get("frames"), self._table.get("layers")
        if frames is not None:
            reader = FrameReader(self._shape, beats=self._beats, relative=self._relative)
            layers.append(Layer(MAIN, reader.read(frames), relative=self._relative))
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

    def _layer(self, spot: Spot) -> Layer | None:
        table = spot.table("a layer, such as {name: head, frames: [...]}")
        if table is None:
            return None
        for key, entry in table.items():
            if key not in LAYER:
                entry.unknown(LAYER, "a layer has")
        named = missing(table, "name", spot)
        name = None if named is None else read_text(named)
        relative = table.get("relative")
        flag = None if relative is None else read_flag(relative)
        counts = self._relative if flag is None else flag
        reader = FrameReader(self._shape, beats=self._beats, relative=counts)
        frames = reader.read(table["frames"]) if "frames" in table else ()
        samples = read_samples(spot, table, reader)
        if "frames" not in table and samples is None:
            spot.error("has neither frames nor samples (rate and joints, roles or face)")
        for twice in reader.named & (samples.named if samples is not None else set()):
            spot.error(f"{twice} is in this layer's frames and in its samples; use two layers")
        muted, share, mix = table.get("muted"), table.get("share"), table.get("mix")
        read_share = None if share is None else read_number(share, Range(0, 1))
        return Layer(
            name or "",
            frames,
            None if samples is None else samples.values,
            relative=counts,
            mix=(mix and read_word(mix, MIXES)) or MIXES[0],
            share=1.0 if read_share is None else read_share,
            muted=bool(muted is not None and read_flag(muted)),
        )

    def _length(self, move: KeyframeMove) -> None:
        spot = self._table.get("frames") or self._table.get("layers")
        if spot is None:
            return
        if move.length <= 0:
            spot.error("takes no time; a frame after the beginning is missing")
        elif move.length > LONGEST and not move.beats:
            spot.warning(f"takes {move.length:g} s; play waits for {LONGEST:g} s at most")
