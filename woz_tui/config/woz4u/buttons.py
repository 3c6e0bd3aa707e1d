"""Buttons: one for each item of the file's lists, with what it does in our own verbs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import PurePosixPath

from woz_tui.config.annotated_decoder import resolve_path
from woz_tui.config.experiment import FilePosition
from woz_tui.config.woz4u import made_nodes, woz4u_values
from woz_tui.config.woz4u.woz4u_keys import ITEMS
from woz_tui.config.woz4u.woz4u_texts import decoded, literal, one_line
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import MappingNode, Node, ScalarNode

#: Characters of a path that somebody may have meant; file systems refuse longer names.
_LONGEST_NAME = 240

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

    def needed(self, name: str, otherwise: str) -> tuple[Cursor, str] | None:
        """A field without which the item does nothing, and its text; None, after saying so."""
        found = self.fields.get(name)
        if found is None or woz4u_values.empty(found):
            where = self.cursor if found is None else found
            where.warning(f"without {name!r} {otherwise}; {woz4u_values.LEFT_OUT}")
            return None
        if not isinstance(found.node, ScalarNode):
            found.wrong("text")
            return None
        return found, woz4u_values.text(found) or ""

    def button(self, fallback: str, *does: made_nodes.Entry) -> ButtonDraft:
        """Its button; `fallback` is the label if it has no title."""
        title, tip = self.fields.get("title"), self.fields.get("tooltip")
        label = _words(title, f"its button is called {fallback!r}")
        if not label and (title is None or woz4u_values.empty(title)):
            self.cursor.warning(f"without 'title' its button is called {fallback!r}")
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
        fields = dict(cursor.entries())
        warn_unknown(fields, ITEMS[section])
        yield ListEntry(cursor, fields)


def warn_unknown(fields: Mapping[str, Cursor], known: tuple[str, ...]) -> None:
    """Warn of fields that nothing reads."""
    for name, entry in fields.items():
        if name not in known:
            near = entry.report.hint(name, known, or_list="read are")
            entry.warning(f"this key is not used{near}")


def speech(table: Mapping[str, Cursor], move: PathRewriter) -> list[ButtonDraft]:
    """`animated_speech`: texts to say, and text files to read out."""
    buttons = []
    example = "{title: Hello, string: 'Hello!', key_comb: [h]}"
    for number, item in enumerate(entries(table, "animated_speech", example), 1):
        found = item.needed("string", "there is nothing to say")
        if found is None:
            continue
        cursor, typed = found
        verb, words, fallback = "say", typed, f"Speech {number}"
        if _names_file(cursor, typed):
            verb, words = "read", move(typed.strip().replace("\\", "/"))
            fallback = PurePosixPath(words).stem or fallback
        else:
            words = decoded(cursor, typed)
        buttons.append(item.button(fallback, made_nodes.entry(verb, literal(words), cursor.place)))
    return buttons


def _names_file(cursor: Cursor, typed: str) -> bool:
    """Whether a text is the name of a text file, by its end."""
    name = typed.strip()
    if not name.endswith(".txt"):
        return False
    if len(name) > _LONGEST_NAME or "\n" in name:
        cursor.warning("ends in .txt, but this is not a file name; it is spoken as text")
        return False
    return True


def gestures(table: Mapping[str, Cursor]) -> list[ButtonDraft]:
    """`gestures`: animations of the robot."""
    buttons = []
    example = "{title: Hello, gesture: animations/Stand/Gestures/Hey_1}"
    for item in entries(table, "gestures", example):
        if found := item.needed("gesture", "there is nothing to play"):
            path = found[1].strip()
            does = made_nodes.entry("play", literal(path), found[0].place)
            buttons.append(item.button(PurePosixPath(path).name or path, does))
    return buttons


def sounds(table: Mapping[str, Cursor], volume: ScalarNode | None) -> list[ButtonDraft]:
    """`audio_files`: sound files on the robot, as loud as its speech."""
    buttons = []
    for item in entries(table, "audio_files", "{title: Bell, location: /home/nao/bell.wav}"):
        found = item.needed("location", "there is nothing to play")
        if found is None:
            continue
        place, path = found[0].place, found[1].strip()
        file: str | MappingNode = literal(path)
        if volume is not None:
            louder = ("volume", volume.place, volume)
            file = made_nodes.table([made_nodes.entry("file", file, place), louder], place)
        does = made_nodes.entry("sound", file, place)
        buttons.append(item.button(PurePosixPath(path).stem or path, does))
    return buttons


@dataclass(frozen=True, slots=True)
class TabletContents:
    """What `tablet_items` come to: buttons, and what is shown when nothing else is."""

    buttons: list[ButtonDraft]
    default: Node | None


def tablet(table: Mapping[str, Cursor], move: PathRewriter) -> TabletContents:
    """`tablet_items`: pictures, videos and pages; files lie in `tablet_root_location`."""
    root = tablet_root(table, move)
    shown = TabletContents([], None)
    for item in entries(table, "tablet_items", "{title: Map, file_name: map.png}"):
        found = item.needed("file_name", "there is nothing to show")
        if found is None:
            continue
        cursor = found[0]
        path = _shown_path(found[1].strip(), root, move)
        if "://" not in path:
            resolve_path(cursor, path, must_exist=True)
        does = made_nodes.entry("screen", literal(path), cursor.place)
        shown.buttons.append(item.button(PurePosixPath(path).stem or path, does))
        mark = item.fields.get("is_default_img")
        if woz4u_values.flag(mark) and mark is not None:
            if shown.default is None:
                shown = TabletContents(shown.buttons, made_nodes.node(path, mark.place))
            else:
                mark.warning("an item above is the default already; that one is shown")
    return shown


def tablet_root(table: Mapping[str, Cursor], move: PathRewriter) -> str:
    """The folder of the tablet's files; empty if none is named."""
    typed = woz4u_values.text(table.get("tablet_root_location")) or ""
    path = typed.strip().replace("\\", "/")
    return move(path) if path else ""


def _shown_path(typed: str, root: str, move: PathRewriter) -> str:
    if typed.lower().startswith(("http://", "https://")):
        return typed
    return str(PurePosixPath(root) / typed) if root else move(typed)
