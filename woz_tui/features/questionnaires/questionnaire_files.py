"""Questionnaires in files of their own, which an experiment names with `file:`.

Such a file has the keys of a questionnaire but `when`; what the experiment says itself holds.
"""

from __future__ import annotations

from collections.abc import Iterator

from woz_tui.config.feature_section import FileSurroundings
from woz_tui.config.file_text import SourceFile
from woz_tui.config.media_files import meant
from woz_tui.config.problems import quoted
from woz_tui.config.yaml_cursor import Cursor, document, named_source, read_filled
from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node, ScalarNode
from woz_tui.features.questionnaires.to_fill import TO_FILL
from woz_tui.protocol.sentence import Sentence

#: Keys that say something of one experiment alone.
_OF_EXPERIMENTS = ("file", "when")


class QuestionnaireFiles:
    """The files that one experiment names; each is read once, however often it is named."""

    def __init__(self, around: FileSurroundings) -> None:
        self._around = around
        self._sources: dict[str, SourceFile] = {}

    def filled(self, cursor: Cursor | None) -> Cursor | None:
        """The list of questionnaires, each with the keys of the file that it names."""
        if cursor is None or not isinstance(cursor.node, ListNode):
            return cursor
        nodes = [self._with_file(entry).node for entry in cursor.items()]
        both = ListNode(cursor.node.place, nodes)
        filled = Cursor(both, cursor.path, cursor.place, cursor.report)
        for entry in filled.items():
            _check_filled(entry)
        return filled

    def _with_file(self, entry: Cursor) -> Cursor:
        node, named = entry.node, dict(entry.entries()).get("file")
        text = read_filled(named)
        if not isinstance(node, MappingNode) or named is None or not text or not text.strip():
            return entry
        root = self._root(named, text)
        if root is None or not isinstance(root.node, MappingNode):
            return entry
        for key, value in root.entries():
            if key in _OF_EXPERIMENTS:
                value.error(
                    Sentence(
                        "questionnaires.belongs_in_experiment",
                        "belongs in the experiment, beside the name of this file",
                    )
                )
        base = root.only([key for key, _ in root.entries() if key not in _OF_EXPERIMENTS]).node
        assert isinstance(base, MappingNode)
        entries = {**base.entries, **node.entries}
        for keys in (("items",), ("title", "name")):
            if not {*keys} & entries.keys():
                named.error(
                    Sentence(
                        "questionnaires.file_without_items",
                        "{file} has no items",
                        file=quoted(text),
                    )
                    if keys == ("items",)
                    else Sentence(
                        "questionnaires.file_without_title",
                        "{file} has no title and no name",
                        file=quoted(text),
                    )
                )
        both = MappingNode(node.place, entries, {**base.keys, **node.keys})
        return Cursor(both, entry.path, entry.place, entry.report)

    def _root(self, named: Cursor, text: str) -> Cursor | None:
        folder = self._around.folder
        source = self._sources.get(text)
        if source is None:
            source = named_source(named, text, folder, lambda: meant(folder, text))
            if source is None:
                return None
            self._sources[text] = source
            self._around.opened(source)
        return document(
            source,
            named.report,
            Sentence("questionnaires.file_holds", "a questionnaire: its title, items and so on"),
        )


def _check_filled(entry: Cursor) -> None:
    """Whether somebody has written the wording of a template."""
    unwritten = [node for node in _scalars(entry.node) if node.text.strip() == TO_FILL]
    if not unwritten:
        return
    source = dict(entry.entries()).get("instrument")
    link = dict(source.entries()).get("link") if source is not None else None
    where = getattr(link.node, "text", "") if link is not None else ""
    count = len(unwritten)
    source_text = Sentence("check.in_brackets", " ({text})", text=where) if where else ""
    entry.report.error(
        unwritten[0].place,
        entry.path,
        Sentence(
            "questionnaires.to_fill",
            "{mark} stands here: write the wording of its authors instead{source}",
            mark=TO_FILL,
            source=source_text,
        )
        if count == 1
        else Sentence(
            "questionnaires.to_fill_more",
            "{mark} stands here and {number} times more: write the wording of its authors"
            " instead{source}",
            mark=TO_FILL,
            number=count - 1,
            source=source_text,
        ),
    )


def _scalars(node: Node) -> Iterator[ScalarNode]:
    match node:
        case ScalarNode():
            yield node
        case ListNode():
            for each in node.nodes:
                yield from _scalars(each)
        case MappingNode():
            for each in node.entries.values():
                yield from _scalars(each)
