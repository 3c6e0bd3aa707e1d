"""A WoZ4U file as a tree of nodes of our own format, each with the place of what it comes from."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from woz_tui.config.file_position import FilePosition
from woz_tui.config.keys.keyboard_layouts import LAYOUTS
from woz_tui.config.problems import ProblemReport, did_you_mean
from woz_tui.config.woz4u import (
    eye_colours,
    made_nodes,
    pepper_robot,
    woz4u_panels,
    woz4u_values,
)
from woz_tui.config.woz4u.buttons import ButtonDraft, PathRewriter
from woz_tui.config.woz4u.key_assignment import KeyRequest, grant, layout_of
from woz_tui.config.woz4u.sections import (
    SectionReader,
    count_sentences,
    lost,
    sections_like,
    tablet_root,
)
from woz_tui.config.woz4u.woz4u_keys import EARLIER, OLDER, TOP_LEVEL
from woz_tui.config.woz4u.woz4u_panels import PanelDraft
from woz_tui.config.woz4u.woz4u_texts import one_line
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node
from woz_tui.protocol.sentence import Sentence


class OriginalNamesReport(ProblemReport):
    """A report that learns names while the original is read, and uses them from `done` on: whoever
    wrote `animated_speech[2].string` is not told of `panels[0].actions[2].say`.
    """

    def __init__(self) -> None:
        super().__init__()
        self._names: dict[FilePosition, str] = {}
        self._reading = True

    def done(self) -> None:
        """The original has been read; what comes now has paths of our own format."""
        self._reading = False

    def set_place(self, path: str, place: FilePosition) -> None:
        """Remember where `path` stands. An entry of a list has its first key's place: the entry
        comes first and names it. The file's first place is also that of whatever comes from nowhere
        in it, and so names nothing.
        """
        super().set_place(path, place)
        if self._reading and (place.line, place.column) != (1, 1):
            self._names.setdefault(place, path)

    def _named(self, place: FilePosition, path: str) -> str:
        return path if self._reading else self._names.get(place, path)


#: What the translation writes itself, and so is not taken over from the file.
_MADE = ("robot", "robots", "steps", "panels")
#: What a reader of the text is told about its sections.
_SECTIONS = {
    "robot": "Addresses to choose from, and what is set on connect. Other settings stay unchanged.",
    "steps": "Step of one arrow key: degrees; drive in metres. Alt: the base, shift: the hip.",
    "panels": "covers: verbs that cannot be sent by hand while the panel is locked.",
}


@dataclass(frozen=True, slots=True)
class Translation:
    """The tree, and remarks for readers of its text by the identity of the node they belong to."""

    table: MappingNode
    remarks: Mapping[int, str] = field(default_factory=dict)


def translate(root: Cursor, own: Collection[str], move: PathRewriter) -> Translation:
    """Translate the file whose top level `root` is; what is wrong or odd goes to its report.

    `own`: what our own format says at its top level. What the file has of it is taken over as it
    stands. `move`: how a path that is relative to the file's folder is to be written.
    """
    table = _by_newest_names(dict(root.entries()))
    named = {
        name: cursor
        for name, cursor in table.items()
        if name not in (*own, *TOP_LEVEL, *EARLIER, *_MADE)
        and isinstance(cursor.node, ListNode)
        and cursor.node.nodes
    }
    _report_unread(table, named, {*own, *TOP_LEVEL, *EARLIER, *woz4u_panels.locks_of(table, named)})
    kept = {name: table[name] for name in own if name in table}
    found, robot = _read_sections(root, table, named, move)
    woz4u_panels.name_apart(found)
    _give_keys(found, layout_of(kept.get("keyboard"), tuple(LAYOUTS)))
    start = root.place
    name = one_line(Path(start.file).name) or "config"  # a name may hold bytes that are no text
    title = made_nodes.node(f"WoZ4U: {name}", start)
    sections: dict[str, tuple[FilePosition, Node]] = {"title": (start, title)}
    sections |= {name: (cursor.place, cursor.node) for name, cursor in kept.items()}
    sections["robot"] = (start, robot)
    sections["steps"] = (start, pepper_robot.steps(table, start))
    nodes = [(panel, panel.node()) for panel in found if panel.needed]
    sections["panels"] = (start, ListNode(start, [node for _, node in nodes]))
    made_table = made_nodes.table([(name, *entry) for name, entry in sections.items()], start)
    return Translation(made_table, _remarks(made_table, nodes))


def _by_newest_names(table: dict[str, Cursor]) -> dict[str, Cursor]:
    """The top level; an older name counts where the newer one is not there."""
    found = {}
    for name, cursor in table.items():
        newer = OLDER.get(name, name)
        if newer != name and newer not in table:
            cursor.warning(
                Sentence(
                    "woz4u.new_name",
                    "this key is now called {newer!r}; it is read as that",
                    newer=newer,
                )
            )
            found[newer] = cursor
        else:
            found[name] = cursor
    return found


def _report_unread(
    table: Mapping[str, Cursor], named: Collection[str], known: Collection[str]
) -> None:
    """Report what is not read. `named`: lists with names of the study's own."""
    for name, cursor in table.items():
        if name in _MADE:
            cursor.warning(
                Sentence(
                    "woz4u.own_key",
                    "a WoZ4U file has no such key; convert the file to change it (woz convert)",
                )
            )
        elif name in named:
            if near := cursor.report.nearest(name, sections_like(cursor.node)):
                cursor.warning(
                    Sentence(
                        "woz4u.new_panel",
                        "becomes a panel of this name{near}",
                        near=did_you_mean(near),
                    )
                )
        elif name not in known:
            if isinstance(cursor.node, MappingNode) and (count := count_sentences(cursor.node)):
                lost(cursor, count)
                continue
            if name.startswith("lock_") and woz4u_values.locked(cursor):
                cursor.error(
                    Sentence(
                        "woz4u.locks_nothing",
                        "this locks nothing: no section of the file belongs to it",
                    )
                )
                continue
            near = cursor.report.nearest(name, TOP_LEVEL)
            meant = did_you_mean(near) if near else ""
            cursor.warning(Sentence("woz4u.not_used", "this key is not used{near}", near=meant))


def _read_sections(
    root: Cursor, table: Mapping[str, Cursor], named: Mapping[str, Cursor], move: PathRewriter
) -> tuple[list[PanelDraft], MappingNode]:
    """Every section as a panel, and the robot. `named`: lists with names of the study's own."""
    figures = pepper_robot.voice(table)
    folder = tablet_root(table, move)
    sections = SectionReader(folder, figures.get("volume"), move)
    colours = eye_colours.colours(table)
    found = [
        _panel(root, table, "Speech", "lock_anim_speech_section", "animated_speech"),
        _panel(root, table, "Gestures", "lock_gesture_section", "gestures"),
        _panel(root, table, "Tablet", "lock_tablet_section", "tablet_items"),
        _panel(root, table, "Sounds", "lock_audio_section", "audio_files"),
        _panel(root, table, "Eyes", "lock_color_section", "colors"),
        _panel(root, table, "Eye animations", "lock_eye_anim_section", "rasta_anim"),
        _panel(root, table, "Movement", "lock_movement_control_section", ""),
        _panel(root, table, "Autonomy", "lock_autonomous_life_section", "autonomous_life_config"),
        _panel(root, table, "Voice", "lock_volume_section", "volume"),
    ]
    woz4u_panels.locks(table, found)
    places = {panel.title: panel.place for panel in found}
    buttons: dict[str, list[ButtonDraft]] = {
        "Speech": sections.standard_list(table, "animated_speech"),
        "Gestures": sections.standard_list(table, "gestures"),
        "Tablet": sections.standard_list(table, "tablet_items"),
        "Sounds": sections.standard_list(table, "audio_files"),
        "Eyes": colours.buttons,
        "Eye animations": eye_colours.animations(table, colours),
        "Movement": woz4u_panels.movement(places["Movement"]),
        "Autonomy": woz4u_panels.autonomy(places["Autonomy"]),
        "Voice": woz4u_panels.speaking(figures),
    }
    for panel in found:
        panel.buttons = buttons[panel.title]
    if buttons["Tablet"]:
        buttons["Tablet"].append(woz4u_panels.default_picture(places["Tablet"]))
    found[1:1] = woz4u_panels.named(table, named, sections, places)
    shown = (folder, sections.default_picture)
    return found, pepper_robot.robot(root, figures, shown, colours.default, move)


def _panel(
    root: Cursor, table: Mapping[str, Cursor], title: str, lock: str, section: str
) -> PanelDraft:
    """A panel without buttons; it stands where its section does, or else its lock."""
    cursor = table.get(section) or table.get(lock)
    return PanelDraft(title, lock, cursor.place if cursor is not None else root.place, [])


def _give_keys(found: list[PanelDraft], layout: str) -> None:
    """Give every button its key, or another one with the reason why."""
    wishes = [
        (button, KeyRequest(button.title, button.comb))
        for panel in found
        for button in panel.buttons
        if button.comb is not None
    ]
    grant([wish for _, wish in wishes], layout)
    for button, wish in wishes:
        button.key, button.why = wish.key, wish.why


def _remarks(table: MappingNode, nodes: list[tuple[PanelDraft, MappingNode]]) -> dict[int, str]:
    remarks = {id(table.entries[name]): text for name, text in _SECTIONS.items()}
    for panel, node in nodes:
        actions = node.entries.get("actions")
        for button, action in zip(panel.buttons, getattr(actions, "nodes", ()), strict=True):
            if button.why:
                remarks[id(action)] = button.why
    return remarks
