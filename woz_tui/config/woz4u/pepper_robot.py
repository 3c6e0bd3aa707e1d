"""The robot of a WoZ4U file: a Pepper with the settings of the driver `pepper`."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.config.file_position import FilePosition
from woz_tui.config.problems import ProblemReport, quoted, with_remedy
from woz_tui.config.woz4u import made_nodes, woz4u_values
from woz_tui.config.woz4u.buttons import PathRewriter, warn_unknown
from woz_tui.config.woz4u.woz4u_keys import AUTONOMY
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import ListNode, MappingNode, Node, ScalarNode
from woz_tui.drivers.fields import Range
from woz_tui.protocol.sentence import Sentence

#: The driver's word for a robot that it starts itself.
SIMULATED = "simulated"

STATES = ("solitary", "interactive", "safeguard", "disabled")
ENGAGEMENT_MODES = ("Unengaged", "FullyEngaged", "SemiEngaged")
_AS_IT_IS = Sentence("woz4u.value_stays", "the robot's value stays")

#: The driver's name of each setting.
_WORDS = {
    "autonomous_state": ("state", STATES),
    "engagement_mode": ("engagement", ENGAGEMENT_MODES),
}
_DISTANCES = {"tangential_collision": "tangential", "orthogonal_collision": "orthogonal"}
_FLAGS = {
    "basic_awareness": "awareness",
    **{
        name: name
        for name in (
            *("blinking", "listening_movement", "speaking_movement", "head_breathing"),
            *("arms_breathing", "body_breathing", "legs_breathing"),
        )
    },
}
_METRES = Range(0.0, 5.0, "m")
#: `voice_pitch` is 0 (its own voice) or 1 to 4.
_VOICE = {
    "volume": ("volume", Range(0.0, 1.0)),
    "voice_speed": ("speed", Range(50.0, 400.0, "%")),
    "voice_pitch": ("pitch", Range(0.0, 4.0)),
}
_STEPS = {
    "default_head_turn_deg": ("head", Range(0.1, 90.0, "degrees"), 1.0),
    "default_turn_deg": ("turn", Range(1.0, 360.0, "degrees"), 1.0),
    "default_drive_dist": ("drive", Range(1.0, 500.0, "cm"), 0.01),
}
#: Degrees that the hip bends by with one key press: 0.2 rad in WoZ4U's program.
_HIP_DEGREES = 11.46

Figures = Mapping[str, ScalarNode]


def robot(
    root: Cursor,
    speech: Figures,
    shown: tuple[str, Node | None],
    eyes: Node | None,
    move: PathRewriter,
) -> MappingNode:
    """`{name: pepper, drivers: {pepper: {type: pepper, ...}}}`.

    `speech`: what `voice` has read. `shown`: folder and default of the tablet. `eyes`: their
    colour on connect.
    """
    table, start = dict(root.entries()), root.place
    settings: list[made_nodes.Entry] = [
        made_nodes.entry("type", "pepper", start),
        ("robots", *_robots(table.get("pepper_ips"), root.place, root.report)),
    ]
    autonomy = _autonomy(table.get("autonomous_life_config"))
    if autonomy is not None:
        settings.append(("autonomy", autonomy.place, autonomy))
    if speech:
        entries: list[made_nodes.Entry] = [
            (name, node.place, node) for name, node in speech.items()
        ]
        settings.append(("voice", entries[0][1], made_nodes.table(entries, entries[0][1])))
    if eyes is not None:
        settings.append(("eyes", eyes.place, eyes))
    settings += _tablet(table, *shown)
    settings += _folder(table.get("camera_save_dir"), "pictures", move)
    settings += _folder(table.get("audio_save_dir"), "recordings", str)
    pepper = made_nodes.table(settings, start)
    drivers = made_nodes.table([("pepper", start, pepper)], start)
    return made_nodes.table(
        [made_nodes.entry("name", "pepper", start), ("drivers", start, drivers)], start
    )


def _robots(
    cursor: Cursor | None, start: FilePosition, report: ProblemReport
) -> tuple[FilePosition, ListNode]:
    """`pepper_ips`, each once. None at all: a simulated robot, so that the file can be tried."""
    found: dict[str, Node] = {}
    if cursor is not None and not woz4u_values.empty(cursor):
        entries = [*cursor.items()] if isinstance(cursor.node, ListNode) else [cursor]
        if isinstance(cursor.node, ScalarNode):
            cursor.warning(
                Sentence(
                    "woz4u.one_address",
                    "expected a list of addresses; this one is read as a list of one",
                )
            )
        for entry in entries:
            address = _address(entry)
            if address in found:
                entry.warning(
                    Sentence("check.twice", "{found} appears twice", found=quoted(address))
                )
            elif address:
                found[address] = made_nodes.node(address, entry.place)
    place = start if cursor is None else cursor.place
    if not found:
        where = f"pepper_ips: [{SIMULATED}]"
        if not (
            cursor is not None and isinstance(cursor.node, MappingNode)
        ):  # that is an error already
            message = Sentence(
                "woz4u.no_robot",
                "no robot is named; a simulated one is used ({where})",
                where=where,
            )
            report.warning(place, "pepper_ips", message)
        found[SIMULATED] = made_nodes.node(SIMULATED, place)
    return place, ListNode(place, [*found.values()])


def _address(entry: Cursor) -> str:
    if woz4u_values.empty(entry):
        return ""
    if not isinstance(entry.node, ScalarNode):
        entry.wrong(Sentence("woz4u.an_address", "a robot's address, such as 192.168.1.20"))
        return ""
    return (woz4u_values.text(entry) or "").strip()


def _autonomy(cursor: Cursor | None) -> MappingNode | None:
    """`autonomous_life_config`; None if it leaves everything as it is."""
    if cursor is None:
        return None
    fields = woz4u_values.mapping(cursor, "{autonomous_state: solitary}")
    warn_unknown(fields, AUTONOMY)
    entries: list[made_nodes.Entry] = []
    for name, entry in fields.items():
        value: str | float | bool | None
        if name in _WORDS:
            ours, choices = _WORDS[name]
            value = woz4u_values.word(entry, choices, _AS_IT_IS)
        elif name in _DISTANCES:
            ours, value = _DISTANCES[name], woz4u_values.number(entry, _METRES, _AS_IT_IS)
        elif name in _FLAGS:
            ours, value = _FLAGS[name], woz4u_values.flag(entry, _AS_IT_IS)
        else:
            continue
        if value is not None:
            entries.append(made_nodes.entry(ours, value, entry.place))
    return made_nodes.table(entries, cursor.place) if entries else None


def voice(table: Mapping[str, Cursor]) -> dict[str, ScalarNode]:
    """`volume`, `voice_speed` and `voice_pitch` by the driver's names."""
    found = {}
    for name, (ours, allowed) in _VOICE.items():
        cursor = table.get(name)
        value = woz4u_values.number(cursor, allowed, _AS_IT_IS)
        if cursor is None or value is None:
            continue
        if ours == "pitch" and 0.0 < value < 1.0:
            cursor.warning(
                with_remedy(
                    Sentence(
                        "woz4u.no_pitch",
                        "{value:g} is not a pitch: allowed are 0 and 1 to 4",
                        value=value,
                    ),
                    _AS_IT_IS,
                )
            )
            continue
        found[ours] = ScalarNode(cursor.place, f"{value:.6g}", plain=True)
    return found


def steps(table: Mapping[str, Cursor], start: FilePosition) -> MappingNode:
    """How far a press of an arrow key goes; centimetres become metres."""
    entries: list[made_nodes.Entry] = []
    for name, (ours, allowed, factor) in _STEPS.items():
        cursor = table.get(name)
        value = woz4u_values.number(
            cursor, allowed, Sentence("woz4u.usual_step", "the usual step is taken")
        )
        if cursor is not None and value is not None:
            entries.append(made_nodes.entry(ours, value * factor, cursor.place))
    return made_nodes.table([*entries, made_nodes.entry("hip", _HIP_DEGREES, start)], start)


def _tablet(table: Mapping[str, Cursor], root: str, default: Node | None) -> list[made_nodes.Entry]:
    cursor = table.get("tablet_root_location")
    entries: list[made_nodes.Entry] = []
    if cursor is not None and root:
        entries.append(made_nodes.entry("root", root, cursor.place))
    if default is not None:
        entries.append(("default", default.place, default))
    if not entries:
        return []
    where = entries[0][1]
    return [("tablet", where, made_nodes.table(entries, where))]


def _folder(cursor: Cursor | None, ours: str, move: PathRewriter) -> list[made_nodes.Entry]:
    typed = woz4u_values.text(cursor)
    if cursor is None or typed is None:
        return []
    return [made_nodes.entry(ours, move(typed.strip()), cursor.place)]
