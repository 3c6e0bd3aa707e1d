"""Buttons: one for each item of the file's lists, with what it does in our own verbs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field

from woz_tui.config.file_position import FilePosition
from woz_tui.config.problems import with_remedy
from woz_tui.config.woz4u import made_nodes, woz4u_values
from woz_tui.config.woz4u.woz4u_keys import ITEMS, OLDER_FIELDS
from woz_tui.config.woz4u.woz4u_texts import decoded, one_line
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import MappingNode, ScalarNode
from woz_tui.protocol.sentence import Sentence

#: How a path that is relative to the file's folder is to be written.
PathRewriter = Callable[[str], str]


@dataclass(slots=True)
class ButtonDraft:
    """One action on its way: its verbs with their arguments, and what else it says.

    `key` and `why` are filled in when keys are given out, `name` when names are.
    """

    title: str
    place: FilePosition
    does: list[made_nodes.Entry]
    title_place: FilePosition
    help: str = ""
    help_place: FilePosition | None = None
    comb: Cursor | None = None
    key: str = ""
    why: str = ""
    name: str = ""

    def node(self) -> MappingNode:
        """The action as our own format has it."""
        where = self.comb.place if self.comb is not None else self.place
        texts = (
            ("key", self.key, where),
            ("label", self.title, self.title_place),
            ("name", self.name, self.title_place),
            ("help", self.help, self.help_place or self.place),
        )
        said = [made_nodes.entry(*each) for each in texts if each[1]]
        return made_nodes.table([*said, *self.does], self.place)


@dataclass(frozen=True, slots=True)
class ListEntry:
    """One entry of a list: its fields by name."""

    cursor: Cursor
    fields: Mapping[str, Cursor] = field(default_factory=dict)

    @classmethod
    def read(cls, cursor: Cursor) -> ListEntry:
        """The entry with its fields by their newest names."""
        fields = dict(cursor.entries())
        for older, newer in OLDER_FIELDS.items():
            if older in fields and newer not in fields:
                fields[newer] = fields.pop(older)
        return cls(cursor, fields)

    def needed(self, name: str, otherwise: str) -> tuple[Cursor, str] | None:
        """A field without which the item does nothing, and its text; None, after saying so."""
        found = self.fields.get(name)
        if found is None or woz4u_values.empty(found):
            where = self.cursor if found is None else found
            where.warning(
                with_remedy(
                    Sentence(
                        "woz4u.without",
                        "without {field!r} {otherwise}",
                        field=name,
                        otherwise=otherwise,
                    ),
                    woz4u_values.LEFT_OUT,
                )
            )
            return None
        if not isinstance(found.node, ScalarNode):
            found.wrong(Sentence("check.a_text", "text"))
            return None
        return found, woz4u_values.text(found) or ""

    def button(self, fallback: str, *does: made_nodes.Entry) -> ButtonDraft:
        """Its button; `fallback` is the label if it has no title."""
        title, tip = self.fields.get("title"), self.fields.get("tooltip")
        called = Sentence("woz4u.called", "its button is called {label!r}", label=fallback)
        label = _words(title, called)
        if not label and (title is None or woz4u_values.empty(title)):
            self.cursor.warning(
                Sentence(
                    "woz4u.without",
                    "without {field!r} {otherwise}",
                    field="title",
                    otherwise=called,
                )
            )
        return ButtonDraft(
            title=label or one_line(fallback) or fallback,
            place=self.cursor.place,
            does=[*does],
            title_place=(title or self.cursor).place,
            help=_words(tip, woz4u_values.LEFT_OUT),
            help_place=tip.place if tip is not None else None,
            comb=self.fields.get("key_comb"),
        )


def _words(cursor: Cursor | None, otherwise: str) -> str:
    """What stands on the page, in plain characters; empty if it is not there."""
    typed = woz4u_values.text(cursor, otherwise)
    return one_line(decoded(cursor, typed)) if cursor is not None and typed else ""


def entries(table: Mapping[str, Cursor], section: str, example: str) -> Iterator[ListEntry]:
    """The items of a section; what they should not say is a warning."""
    for cursor in woz4u_values.items(table.get(section), example):
        item = ListEntry.read(cursor)
        warn_unknown(item.fields, ITEMS[section])
        yield item


def warn_unknown(fields: Mapping[str, Cursor], known: tuple[str, ...]) -> None:
    """Warn of fields that nothing reads."""
    for name, entry in fields.items():
        if name not in known:
            near = entry.report.hint(name, known, or_list=Sentence("woz4u.read_are", "read are"))
            entry.warning(Sentence("woz4u.not_used", "this key is not used{near}", near=near))
