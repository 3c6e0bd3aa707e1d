"""Commands in the wizard's words: what is said, which way a step goes, what was switched on."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.config.performers import composers, performers
from woz_tui.console.state.wizard_overrides import is_override, override_text
from woz_tui.feature import pieces
from woz_tui.protocol import messages as m
from woz_tui.protocol.markup import sentence
from woz_tui.protocol.messages import Json

#: Steps of the arrow keys and their like: verb -> argument -> what moves, the words for more and
#: for less than nothing, and the unit.
_STEPS: Mapping[str, Mapping[str, tuple[str, str, str, str]]] = {
    "nudge": {"yaw": ("head", "left", "right", "°"), "pitch": ("head", "down", "up", "°")},
    "hip": {"pitch": ("hip", "forward", "back", "°"), "roll": ("hip", "left", "right", "°")},
    "drive": {
        "x": ("drive", "forward", "back", " m"),
        "y": ("drive", "left", "right", " m"),
        "turn": ("turn", "left", "right", "°"),
    },
}
#: Verbs that take a name with folders before it, of which the last part says it all.
_NAMED = frozenset({"play", "sound", "read", "screen"})
#: Arguments that need no name beside their verb: `torque on`, `volume 0.6`.
_PLAIN = frozenset({"on", "level", "percent"})


def spoken_text(command: m.Command | m.FilledCall) -> str:
    """What is said, without markup; empty if nothing is. A text that is kept is `HIDDEN_TEXT`."""
    text = command.args.get("text")
    mute = command.driver in performers() and command.driver not in composers()
    return sentence(text) if isinstance(text, str) and not mute else ""


def command_words(command: m.Command | m.FilledCall) -> str:
    """A command in a few words: what is said, or the verb with what it is given."""
    text = command.args.get("text")
    if isinstance(text, str) and text:
        return f"“{sentence(text)}”"
    if is_override(command):
        return override_text(command.verb, command.args)
    for words in pieces("command_words", dict).values():
        if command.driver in words:
            named: str = words[command.driver](command.args)
            return named
    if steps := _steps_text(command.verb, command.args):
        return steps
    given = (_argument(command.verb, name, value) for name, value in command.args.items())
    return " ".join(filter(None, (command.verb, *given)))


def _steps_text(verb: str, args: Mapping[str, Json]) -> str:
    """`head 8° left`; nothing where something else is asked for than steps."""
    known = _STEPS.get(verb, {})
    told: list[str] = []
    for name, value in args.items():
        if name not in known or isinstance(value, bool) or not isinstance(value, int | float):
            return ""
        what, more, less, unit = known[name]
        if value:
            told.append(f"{what} {abs(value):g}{unit} {more if value > 0 else less}")
    return ", ".join(told)


def _argument(verb: str, name: str, value: Json) -> str:
    """A text alone, a number or a switch with its name; what is nested is left out."""
    if isinstance(value, str):
        bare = value.rstrip("/").rpartition("/")[2]
        return bare if verb in _NAMED and "://" not in value else value
    if not isinstance(value, int | float):
        return ""
    shown = ("on" if value else "off") if isinstance(value, bool) else f"{value:g}"
    plain = name in _PLAIN or verb.endswith(f"_{name}")
    return shown if plain else f"{name} {shown}"
