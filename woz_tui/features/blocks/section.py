"""Blocks that actions of an experiment name, and the key `bml` of robot files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from woz_tui.bridge.xml_elements import LONGEST
from woz_tui.config.feature_section import FeatureSection, FileContents, FileSurroundings, NoKeys
from woz_tui.config.file_text import SourceFileError, read_source
from woz_tui.config.reload_changes import changed_entries
from woz_tui.config.session_verbs import own_verb
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.drivers.contract import UNKNOWN, Argument, Finding, Written
from woz_tui.drivers.fields import Range
from woz_tui.features.blocks.kinds import BML
from woz_tui.protocol.sentence import Sentence

if TYPE_CHECKING:  # loaded where a file says something of blocks
    from woz_tui.features.blocks.behaviour_calls import BehaviourCalls, BmlTable

#: Plays a block.
BML_VERB = own_verb(
    BML,
    "play a block of the Behaviour Markup Language",
    (
        Argument("file", "file", "a file with a block, relative to the experiment's folder"),
        Argument("block", "text", "the block itself", range=Range(0, LONGEST, "characters")),
    ),
    lane=BML,
    limit_s=3600.0,
    together=True,
)


@dataclass(frozen=True, slots=True)
class FileBlocks:
    """What files say of blocks.

    `tables`: what behaviours stand for, by robot (empty: the only one). `texts`: blocks that
    actions play, file as they write it -> what it holds.
    """

    tables: Mapping[str, BmlTable] = field(default_factory=dict)
    texts: Mapping[str, str] = field(default_factory=dict)


class BlockSection(FeatureSection[FileBlocks]):
    """A file without keys of its own: robot files have some, and actions name blocks."""

    verbs = (BML_VERB,)

    def begin(self, around: FileSurroundings) -> BlockReader:
        return BlockReader(around)

    def changes(self, old: FileBlocks, new: FileBlocks) -> Iterable[str]:
        yield from changed_entries(Sentence("reload.a_block", "block of BML"), old.texts, new.texts)
        robots = {**old.tables, **new.tables}
        before, after = (
            {name or "the robot": each.tables.get(name) for name in robots} for each in (old, new)
        )
        yield from changed_entries(Sentence("reload.a_table", "BML table of"), before, after)

    def robot_schema(self) -> Mapping[str, dict[str, Any]]:
        from woz_tui.config.json_schema import TEXT, mapping  # noqa: PLC0415 - only for editors
        from woz_tui.features.blocks import robot_tables as t  # noqa: PLC0415

        angles = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
        does = {"anyOf": [TEXT, {"type": "object", "minProperties": 1}]}
        tables = {
            name: {
                "type": "object",
                "description": words,
                "additionalProperties": angles if name == t.TARGETS else does,
            }
            for name, words in t.KEYS.items()
        }
        schema = mapping(tables | {t.TOPICS: {**TEXT, "description": t.TOPICS_WORDS}})
        words = "what behaviours of BML stand for; what is not said is as usual"
        return {BML: {**schema, "description": words}}


class BlockReader(BlockSection):
    """Reads one file: what it says of a robot, and the blocks that actions name."""

    def __init__(self, around: FileSurroundings) -> None:
        super().__init__(NoKeys, FileBlocks())
        self._around = around
        self.tables: Mapping[str, BmlTable] = {}
        if any(BML in each.keys or each.moves for each in around.robots.entries):
            from woz_tui.features.blocks.robot_tables import read_tables  # noqa: PLC0415

            self.tables = read_tables(around.robots, around.folder)
        #: What the files hold, by their paths as actions write them.
        self.texts: dict[str, str] = {}

    def read(self, table: Mapping[str, Cursor], file: Any, contents: FileContents) -> FileBlocks:
        return FileBlocks(self.tables, self.texts)

    def remarks(self, written: Written) -> Iterable[Finding]:
        file, text = written.args.get("file"), written.args.get("block")
        if (file is None) == (text is None):
            needs = Sentence(
                "blocks.file_or_block", "needs either a file with a block, or a block itself"
            )
            yield Finding("error", "", needs)
            return
        named = ""
        if isinstance(file, str) and UNKNOWN not in file:
            named = file
            try:
                text = self._text_of(file, written.folder)
            except SourceFileError as error:
                line = Sentence("blocks.in_line", " (line {line})", line=error.line)
                yield Finding(
                    "error", "file", _of_file(file, error.message, line if error.line > 1 else "")
                )
        if isinstance(text, str) and UNKNOWN not in text:
            for level, why in self._problems(text):
                told = _of_file(named, why) if named else why
                yield Finding(level, "file" if named else "block", told)

    def _text_of(self, file: str, folder: Path) -> str | None:
        """None: there is no such file, which is said elsewhere."""
        if file not in self.texts:
            path = folder / Path(file).expanduser()
            if not path.exists():
                return None
            source = read_source(path, str(path))
            self._around.opened(source)
            self.texts[file] = source.text
        return self.texts[file]

    def _problems(self, text: str) -> Iterable[tuple[str, str]]:
        from woz_tui.features.blocks.block_plan import plan  # noqa: PLC0415
        from woz_tui.features.blocks.bml_block import BmlError, read_block  # noqa: PLC0415

        try:
            block = read_block(text)
            if self._around.robots.incomplete:
                return []
            made = plan(block, self.calls(block.character))
        except BmlError as error:
            return [("error", str(error))]
        return [("warning", f"{each.text} ({each.kind})") for each in made.schedule.warnings]

    def calls(self, character: str) -> BehaviourCalls:
        """What behaviours stand for on the robot that a block names. Raises `BmlError`."""
        from woz_tui.features.blocks.robot_tables import robot_calls  # noqa: PLC0415

        drivers, catalogue = self._around.robots.drivers, self._around.catalogue
        return robot_calls(drivers, self.tables, catalogue, self._around.folder, character)


def _of_file(file: str, why: str, place: str = "") -> Sentence:
    return Sentence("check.named_file", "{file}: {why}{near}", file=file, why=why, near=place)


BLOCKS = BlockSection(NoKeys, FileBlocks())
