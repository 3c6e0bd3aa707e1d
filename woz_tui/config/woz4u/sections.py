"""Lists of a WoZ4U file: what each of their entries plays, whatever the list is called.

Studies that needed several lists of sentences gave them names of their own, and the program's first
versions had other names for fields. So an entry is known by what it has: a `string` is said, a
`gesture` is played, and so on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath

from woz_tui.config.annotated_decoder import resolve_path
from woz_tui.config.problems import shortened
from woz_tui.config.woz4u import made_nodes, woz4u_values
from woz_tui.config.woz4u.buttons import ButtonDraft, ListEntry, PathRewriter, warn_unknown
from woz_tui.config.woz4u.woz4u_keys import ITEMS, OLDER_FIELDS
from woz_tui.config.woz4u.woz4u_texts import decoded, literal, one_line
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node, ScalarNode
from woz_tui.protocol.sentence import Sentence

#: Characters of a path that somebody may have meant; file systems refuse longer names.
_LONGEST_NAME = 240
#: Characters of a sentence that stands alone which are its button's title.
_LONGEST_TITLE = 40
#: The field of an entry that says what is played, by the list of WoZ4U that has such entries.
PLAYED = {
    "animated_speech": "string",
    "gestures": "gesture",
    "tablet_items": "file_name",
    "audio_files": "location",
}
_FIELDS = {field: ITEMS[section] for section, field in PLAYED.items()}
_EVERY_BUTTON = ("title", "tooltip", "key_comb")
_EXAMPLES = {
    "animated_speech": "{title: Hello, string: 'Hello!', key_comb: [h]}",
    "gestures": "{title: Hello, gesture: animations/Stand/Gestures/Hey_1}",
    "tablet_items": "{title: Map, file_name: map.png}",
    "audio_files": "{title: Bell, location: /home/nao/bell.wav}",
}
#: What early versions called the path in these lists, and what it is called now.
_EARLIER = {"gestures": ("string", "gesture"), "audio_files": ("url", "location")}
_WITHOUT = {
    "string": Sentence("woz4u.nothing_to_say", "there is nothing to say"),
    "gesture": Sentence("woz4u.nothing_to_play", "there is nothing to play"),
    "file_name": Sentence("woz4u.nothing_to_show", "there is nothing to show"),
    "location": Sentence("woz4u.nothing_to_play", "there is nothing to play"),
}


def is_sentence(node: Node) -> bool:
    """Whether a text is more than a word or a number: somebody is to hear it."""
    return isinstance(node, ScalarNode) and " " in node.text.strip()


def has_sentences(node: Node) -> bool:
    """Whether this is a list of entries with a title and what is said, as only WoZ4U has it."""
    spoken = {"string", *(older for older, newer in OLDER_FIELDS.items() if newer == "string")}
    titled = {"title", *(older for older, newer in OLDER_FIELDS.items() if newer == "title")}
    return isinstance(node, ListNode) and any(
        isinstance(entry, MappingNode)
        and not spoken.isdisjoint(entry.entries)
        and not titled.isdisjoint(entry.entries)
        for entry in node.nodes
    )


def sections_like(node: Node) -> list[str]:
    """The lists of WoZ4U's that have such entries."""
    entries = [entry for entry in getattr(node, "nodes", ()) if isinstance(entry, MappingNode)]
    return [name for name, field in PLAYED.items() if any(field in one.entries for one in entries)]


def lost(section: Cursor, count: int) -> None:
    """Report entries that a conversion would lose."""
    section.error(
        Sentence(
            "woz4u.would_be_lost",
            "{count} entries of this would be lost: give each a title, and a string (to say),"
            " gesture, file_name or location",
            one="1 entry of this would be lost: give each a title, and a string (to say),"
            " gesture, file_name or location",
            count=count,
        )
    )


def count_sentences(node: Node) -> int:
    """How many sentences there are in a section that is no list of entries."""
    match node:
        case ListNode():
            return sum(map(count_sentences, node.nodes))
        case MappingNode():
            return sum(count_sentences(value) for _, _, value in node.items())
    return int(is_sentence(node))


def tablet_root(table: Mapping[str, Cursor], move: PathRewriter) -> str:
    """The folder of the tablet's files; empty if none is named."""
    typed = woz4u_values.text(table.get("tablet_root_location")) or ""
    path = typed.strip().replace("\\", "/")
    return move(path) if path else ""


class SectionReader:
    """Reads lists of entries into buttons.

    `root`: the folder of the tablet's files. `volume`: how loud sounds are. `move`: how a path that
    is relative to the file's folder is to be written.
    """

    def __init__(self, root: str, volume: ScalarNode | None, move: PathRewriter) -> None:
        self._root = root
        self._volume = volume
        self._move = move
        self._readers = {
            "string": self._speech,
            "gesture": self._gesture,
            "location": self._sound,
            "file_name": self._shown,
        }
        #: What the tablet shows when nothing else is shown.
        self.default_picture: Node | None = None

    def standard_list(self, table: Mapping[str, Cursor], section: str) -> list[ButtonDraft]:
        """The buttons of one of WoZ4U's own lists."""
        cursor = table.get(section)
        items = [*map(ListEntry.read, woz4u_values.items(cursor, _EXAMPLES[section]))]
        if section in _EARLIER:
            items = [_renamed(item, *_EARLIER[section]) for item in items]
        return self._buttons(cursor, items, PLAYED[section]) if cursor is not None else []

    def study_list(self, section: Cursor) -> list[ButtonDraft]:
        """The buttons of a list that the study named; sentences may stand there alone."""
        items, unread = [], 0
        for item in section.items():
            if isinstance(item.node, MappingNode):
                items.append(ListEntry.read(item))
            elif isinstance(item.node, ScalarNode) and is_sentence(item.node):
                said = shortened(one_line(item.node.text), _LONGEST_TITLE)
                title = ScalarNode(item.place, said, plain=False)
                named = item.at("title", title, item.place)
                items.append(ListEntry(item, {"title": named, "string": item}))
            elif not woz4u_values.empty(item):
                unread += 1
        return self._buttons(section, items, "", unread)

    def _buttons(
        self, section: Cursor, items: Sequence[ListEntry], usual: str, unread: int = 0
    ) -> list[ButtonDraft]:
        """`usual`: the field that entries of this list have; empty: they can have any."""
        buttons = []
        for number, item in enumerate(items, 1):
            fields = [name for name in self._readers if name in item.fields]
            if not fields and (not usual or _has_text(item)):
                unread += 1
                continue
            fields = fields or [usual]
            warn_unknown(item.fields, (*dict.fromkeys(n for f in fields for n in _FIELDS[f]),))
            if button := self._button(item, fields, number):
                buttons.append(button)
        if unread:
            lost(section, unread)
        return buttons

    def _button(self, item: ListEntry, fields: Sequence[str], number: int) -> ButtonDraft | None:
        does, names = [], []
        for name in fields:
            if found := item.needed(name, _WITHOUT[name]):
                entry, called = self._readers[name](item, *found)
                does.append(entry)
                names.append(called)
        return item.button(names[0] or f"Speech {number}", *does) if does else None

    def _speech(self, item: ListEntry, cursor: Cursor, typed: str) -> tuple[made_nodes.Entry, str]:
        """A text to say, or a text file to read out."""
        if _names_file(cursor, typed):
            path = self._move(typed.strip().replace("\\", "/"))
            return made_nodes.entry("read", literal(path), cursor.place), PurePosixPath(path).stem
        return made_nodes.entry("say", literal(decoded(cursor, typed)), cursor.place), ""

    def _gesture(self, item: ListEntry, cursor: Cursor, typed: str) -> tuple[made_nodes.Entry, str]:
        """An animation of the robot."""
        path = typed.strip()
        entry = made_nodes.entry("play", literal(path), cursor.place)
        return entry, PurePosixPath(path).name or path

    def _sound(self, item: ListEntry, cursor: Cursor, typed: str) -> tuple[made_nodes.Entry, str]:
        """A sound file on the robot, as loud as its speech."""
        place, path = cursor.place, typed.strip()
        file: str | MappingNode = literal(path)
        if self._volume is not None:
            louder = ("volume", self._volume.place, self._volume)
            file = made_nodes.table([made_nodes.entry("file", file, place), louder], place)
        return made_nodes.entry("sound", file, place), PurePosixPath(path).stem or path

    def _shown(self, item: ListEntry, cursor: Cursor, typed: str) -> tuple[made_nodes.Entry, str]:
        """A picture, a video or a page on the tablet; files lie in its folder."""
        path = typed.strip()
        if not path.lower().startswith(("http://", "https://")):
            path = str(PurePosixPath(self._root) / path) if self._root else self._move(path)
        if "://" not in path:
            resolve_path(cursor, path, must_exist=True)
        mark = item.fields.get("is_default_img")
        if woz4u_values.flag(mark) and mark is not None:
            if self.default_picture is None:
                self.default_picture = made_nodes.node(path, mark.place)
            else:
                mark.warning(
                    Sentence(
                        "woz4u.second_default",
                        "an item above is the default already; that one is shown",
                    )
                )
        entry = made_nodes.entry("screen", literal(path), cursor.place)
        return entry, PurePosixPath(path).stem or path


def _renamed(item: ListEntry, older: str, newer: str) -> ListEntry:
    """The entry with a field by its newer name; a sentence is no path, whatever it is called."""
    said = item.fields.get(older)
    if said is None or newer in item.fields or is_sentence(said.node):
        return item
    fields = {newer if name == older else name: at for name, at in item.fields.items()}
    return ListEntry(item.cursor, fields)


def _has_text(item: ListEntry) -> bool:
    """Whether an entry has something beside what belongs to every button."""
    return any(
        name not in _EVERY_BUTTON and not woz4u_values.empty(field)
        for name, field in item.fields.items()
    )


def _names_file(cursor: Cursor, typed: str) -> bool:
    """Whether a text is the name of a text file, by its end."""
    name = typed.strip()
    if not name.endswith(".txt"):
        return False
    if len(name) > _LONGEST_NAME or "\n" in name:
        cursor.warning(
            Sentence(
                "woz4u.no_text_file",
                "ends in .txt, but this is not a file name; it is spoken as text",
            )
        )
        return False
    return True
