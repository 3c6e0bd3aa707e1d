"""Panels: the sections of the file, in the order of WoZ4U's page, and what their locks cover."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from woz_tui.config.file_position import FilePosition
from woz_tui.config.woz4u import made_nodes, woz4u_values
from woz_tui.config.woz4u.buttons import ButtonDraft
from woz_tui.config.woz4u.pepper_robot import ENGAGEMENT_MODES, STATES
from woz_tui.config.woz4u.sections import SectionReader, has_sentences
from woz_tui.config.woz4u.woz4u_texts import one_line
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node, ScalarNode

_COVERS = {
    "lock_anim_speech_section": ("say", "read"),
    "lock_gesture_section": ("play",),
    "lock_tablet_section": ("screen", "tablet"),
    "lock_audio_section": ("sound",),
    "lock_color_section": ("eyes", "eyes_brightness"),
    "lock_eye_anim_section": ("eyes_animation",),
    "lock_movement_control_section": (
        *("gaze", "nudge", "hip", "drive", "posture", "pose", "home", "torque"),
    ),
    "lock_autonomous_life_section": ("autonomy", "collision"),
    "lock_volume_section": ("volume", "speech_speed", "speech_pitch"),
}
_NUMBERED_LOCK = re.compile(r"lock_anim_speech_section_([1-9][0-9]?)")


@dataclass(slots=True)
class PanelDraft:
    """One section: `lock` is its key in the file, `place` where the section stands there.

    A section that the study named has no lock among WoZ4U's, and so covers no verbs.
    """

    title: str
    lock: str
    place: FilePosition
    buttons: list[ButtonDraft]
    locked: bool = False

    @property
    def needed(self) -> bool:
        """A section without a button makes no panel, unless something is locked there."""
        return bool(self.buttons) or (self.locked and bool(self.lock))

    def node(self) -> MappingNode:
        """The panel as our own format has it."""
        where = self.place
        entries = [made_nodes.entry("title", self.title, where)]
        if self.locked:
            entries.append(made_nodes.entry("locked", True, where))
        covered = [made_nodes.node(verb, where) for verb in _COVERS.get(self.lock, ())]
        if covered:
            entries.append(("covers", where, ListNode(where, covered)))
        if self.buttons:
            actions: list[Node] = [button.node() for button in self.buttons]
            entries.append(("actions", where, ListNode(where, actions)))
        return made_nodes.table(entries, where)


def locks(table: Mapping[str, Cursor], panels: Iterable[PanelDraft]) -> None:
    """Lock the panels whose sections the file locks."""
    for panel in panels:
        panel.locked = woz4u_values.locked(table.get(panel.lock))


def locks_of(table: Mapping[str, Cursor], named: Mapping[str, Cursor]) -> dict[str, str]:
    """The section that each lock of sections with names of the study's own belongs to.

    Studies that split the sentences gave the locks of the parts numbers: `lock_..._section_2`.
    """
    found = {}
    spoken = [name for name, cursor in named.items() if has_sentences(cursor.node)]
    for name in table:
        section = name.removeprefix("lock_")
        numbered = _NUMBERED_LOCK.fullmatch(name)
        if section == name:
            continue
        if section in named:
            found[name] = section
        elif (short := section.removesuffix("_section")) in named:
            found[name] = short
        elif numbered and 0 < int(numbered[1]) <= len(spoken):
            found[name] = spoken[int(numbered[1]) - 1]
    return found


def named(
    table: Mapping[str, Cursor],
    sections: Mapping[str, Cursor],
    reader: SectionReader,
    taken: Collection[str],
) -> list[PanelDraft]:
    """Panels of the study's own sections, by their names; a lock there is of the panel alone.

    `taken`: titles that panels of WoZ4U's own sections have.
    """
    locking = locks_of(table, sections)
    panels = []
    for name, cursor in sections.items():
        title = one_line(name)
        panel = PanelDraft(
            f"{title} (own)" if title in taken or not title else title,
            "",
            cursor.place,
            reader.study_list(cursor),
        )
        panel.locked = any(
            woz4u_values.locked(table[lock]) for lock, of in locking.items() if of == name
        )
        panels.append(panel)
    return panels


def name_apart(panels: Sequence[PanelDraft]) -> None:
    """Titles that occur twice: the later action gets a name of its own, with its panel's title."""
    titles = {button.title for panel in panels for button in panel.buttons}
    names: set[str] = set()
    counts: dict[tuple[str, str], int] = {}
    for panel in panels:
        for button in panel.buttons:
            name, kind = button.title, (button.title, panel.title)
            while name in names or (kind in counts and name in titles):
                number = counts[kind] = counts.get(kind, 0) + 1
                tail = f" {number}" if number > 1 else ""
                name = f"{button.title} ({panel.title}{tail})"
            names.add(name)
            button.name = name if name != button.title else ""


def movement(place: FilePosition) -> list[ButtonDraft]:
    """What the page's movement section does beside the arrow keys, and more of its kind."""
    ahead = [made_nodes.entry(name, 0.0, place) for name in ("yaw", "pitch")]
    return [
        _plain("Wake up", place, "the motors on", torque=True),
        _plain("Rest", place, "the resting position, the motors off", torque=False),
        _plain("Stand", place, "the neutral stand", posture="Stand"),
        _plain("StandInit", place, "ready to go", posture="StandInit"),
        _plain("Home", place, "every joint back to the stand", home=1.0),
        _plain("Look ahead", place, "", gaze=made_nodes.table(ahead, place)),
    ]


def autonomy(place: FilePosition) -> list[ButtonDraft]:
    """The robot's states and engagement modes; all its settings are on the console's own page."""
    buttons = [
        _plain(word.capitalize(), place, "autonomous life", autonomy=word) for word in STATES
    ]
    for mode in ENGAGEMENT_MODES:
        engagement = made_nodes.table([made_nodes.entry("engagement", mode, place)], place)
        buttons.append(_plain(mode, place, "engagement", autonomy=engagement))
    return buttons


def speaking(figures: Mapping[str, ScalarNode]) -> list[ButtonDraft]:
    """Back to what the file says about the voice, as far as it does."""
    verbs = {"volume": "volume", "speed": "speech_speed", "pitch": "speech_pitch"}
    return [
        _plain(
            f"{name.capitalize()} {node.text}",
            node.place,
            "as the file has it",
            **{verbs[name]: node},
        )
        for name, node in figures.items()
    ]


def default_picture(place: FilePosition) -> ButtonDraft:
    """The page's button that clears the tablet."""
    return _plain("Default picture", place, "or Pepper's own", tablet="default")


def _plain(title: str, place: FilePosition, hint: str, **does: made_nodes.Value) -> ButtonDraft:
    """A button of ours, without a key."""
    entries = [made_nodes.entry(verb, value, place) for verb, value in does.items()]
    return ButtonDraft(title, place, entries, place, help=hint)
