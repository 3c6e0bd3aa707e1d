"""Colours of the eyes and their three animations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from woz_tui.config.woz4u import made_nodes, woz4u_values
from woz_tui.config.woz4u.buttons import ButtonDraft, ListEntry, entries, warn_unknown
from woz_tui.config.woz4u.woz4u_keys import ANIMATION_FIELDS
from woz_tui.config.yaml_cursor import Cursor
from woz_tui.config.yaml_nodes import Node
from woz_tui.drivers.fields import Range
from woz_tui.protocol.sentence import Sentence

#: Seconds that a colour takes to come, as WoZ4U's program has it.
_FADE_S = 0.5
_CHANNELS = ("red", "green", "blue")
_ANY = Range()
_DURATION = Range(0.1, 3600, "s")


@dataclass(frozen=True, slots=True)
class Colour:
    """One item of `colors`: its button and `#rrggbb`."""

    button: ButtonDraft
    code: str


@dataclass(frozen=True, slots=True)
class Colours:
    """All of them, and the one that the eyes have on connect."""

    each: Sequence[Colour]
    default: Node | None = None

    @property
    def buttons(self) -> list[ButtonDraft]:
        return [colour.button for colour in self.each]


def colours(table: Mapping[str, Cursor]) -> Colours:
    """`colors`: each fades the eyes to it. Of several defaults the last one stays, as there."""
    each: list[Colour] = []
    default: Node | None = None
    for item in entries(table, "colors", "{title: Red, red: 1.0, green: 0, blue: 0}"):
        code = _code(item)
        place = next(
            (item.fields[name].place for name in _CHANNELS if name in item.fields),
            item.cursor.place,
        )
        does = (
            made_nodes.entry("eyes", code, place),
            made_nodes.entry("seconds", _FADE_S, place),
        )
        each.append(Colour(item.button(code, *does), code))
        mark = item.fields.get("is_default")
        if woz4u_values.flag(mark) and mark is not None:
            if default is not None:
                mark.warning(
                    Sentence(
                        "woz4u.second_default_colour",
                        "a colour above is the default, too; the eyes come to this one",
                    )
                )
            default = made_nodes.node(code, mark.place)
    return Colours(each, default or _early_default(table))


def _early_default(table: Mapping[str, Cursor]) -> Node | None:
    """The eyes' colour on connect as early versions of the program had it."""
    cursor = table.get("led_settings")
    fields = woz4u_values.mapping(cursor, "{color: {red: 0, green: 1.0, blue: 0}}")
    warn_unknown(fields, ("color",))
    color = fields.get("color")
    channels = woz4u_values.mapping(color, "{red: 0, green: 1.0, blue: 0}")
    if color is None or not channels:
        return None
    return made_nodes.node(_code(ListEntry(color, channels)), color.place)


def _code(item: ListEntry) -> str:
    """`#rrggbb`; a channel that cannot be read is dark."""
    channels = [_channel(item, name) for name in _CHANNELS]
    top = 1.0
    if max(channels) > 1.0:
        first = next(
            item.fields[n] for n, value in zip(_CHANNELS, channels, strict=True) if value > 1
        )
        top = 255.0
        first.warning(
            Sentence(
                "woz4u.of_255", "red, green and blue go from 0 to 1; these are read as 0 to 255"
            )
        )
    return "#" + "".join(f"{round(255 * min(value, top) / top):02x}" for value in channels)


def _channel(item: ListEntry, name: str) -> float:
    cursor = item.fields.get(name)
    if cursor is None or woz4u_values.empty(cursor):
        item.cursor.warning(
            Sentence(
                "woz4u.colour_missing", "without {colour!r} there is no {colour} in it", colour=name
            )
        )
        return 0.0
    value = (
        woz4u_values.number(
            cursor, _ANY, Sentence("woz4u.no_colour", "there is no {colour} in it", colour=name)
        )
        or 0.0
    )
    if value < 0.0:
        cursor.warning(
            Sentence("woz4u.below_zero", "below 0; there is no {colour} in it", colour=name)
        )
    return max(0.0, value)


def animations(table: Mapping[str, Cursor], colours: Colours) -> list[ButtonDraft]:
    """`rasta_anim`, `random_anim`, `rotate_anim`. The last one turns in the first colour, which
    the program proposes, by its key, and in every other one without a key.
    """
    buttons = [
        *_animation(table, "rasta_anim", "Rasta", "rasta", None),
        *_animation(table, "random_anim", "Random", "random", None),
    ]
    rotating = [(f"Rotate {one.button.title}", one.code) for one in colours.each]
    for number, (title, code) in enumerate(rotating or [("Rotate", "#ffffff")]):
        found = _animation(table, "rotate_anim", title, "rotate", code)
        for button in found:
            button.comb = button.comb if number == 0 else None
        buttons += found
    return buttons


def _animation(
    table: Mapping[str, Cursor], section: str, title: str, kind: str, colour: str | None
) -> list[ButtonDraft]:
    cursor = table.get(section)
    if cursor is None or woz4u_values.empty(cursor):
        return []
    fields = woz4u_values.mapping(cursor, "{duration: 3, key_comb: [e, r]}")
    warn_unknown(fields, ANIMATION_FIELDS)
    duration = woz4u_values.number(
        fields.get("duration"),
        _DURATION,
        Sentence("woz4u.own_time", "it takes the robot's own time"),
    )
    does = [made_nodes.entry("eyes_animation", kind, cursor.place)]
    if duration is not None:
        does.append(made_nodes.entry("seconds", duration, fields["duration"].place))
    if colour is not None:
        does.append(made_nodes.entry("color", colour, cursor.place))
    return [
        ButtonDraft(
            title=title,
            place=cursor.place,
            does=does,
            title_place=cursor.place,
            comb=fields.get("key_comb"),
        )
    ]
