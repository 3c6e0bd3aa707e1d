"""Commands in the wizard's words: what is said, which way a step goes, what was switched on."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.config.performers import composers, performers
from woz_tui.config.screen_language import say
from woz_tui.console.state.wizard_overrides import is_override, override_text
from woz_tui.feature import pieces
from woz_tui.protocol import messages as m
from woz_tui.protocol.markup import sentence
from woz_tui.protocol.messages import Json

#: Steps of the arrow keys and their like: verb -> its arguments that are steps.
_STEPS: Mapping[str, frozenset[str]] = {
    "nudge": frozenset({"yaw", "pitch"}),
    "hip": frozenset({"pitch", "roll"}),
    "drive": frozenset({"x", "y", "turn"}),
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
    known = _STEPS.get(verb, ())
    told: list[str] = []
    for name, value in args.items():
        if name not in known or isinstance(value, bool) or not isinstance(value, int | float):
            return ""
        if value:
            told.append(_step(verb, name, abs(value), more=value > 0))
    return ", ".join(told)


def _step(verb: str, name: str, by: float, *, more: bool) -> str:
    match verb, name, more:
        case "nudge", "yaw", True:
            return say("runs.head_left", "head {by:g}° left", by=by)
        case "nudge", "yaw", False:
            return say("runs.head_right", "head {by:g}° right", by=by)
        case "nudge", _, True:
            return say("runs.head_down", "head {by:g}° down", by=by)
        case "nudge", _, False:
            return say("runs.head_up", "head {by:g}° up", by=by)
        case "hip", "pitch", True:
            return say("runs.hip_forward", "hip {by:g}° forward", by=by)
        case "hip", "pitch", False:
            return say("runs.hip_back", "hip {by:g}° back", by=by)
        case "hip", _, True:
            return say("runs.hip_left", "hip {by:g}° left", by=by)
        case "hip", _, False:
            return say("runs.hip_right", "hip {by:g}° right", by=by)
        case _, "x", True:
            return say("runs.drive_forward", "drive {by:g} m forward", by=by)
        case _, "x", False:
            return say("runs.drive_back", "drive {by:g} m back", by=by)
        case _, "y", True:
            return say("runs.drive_left", "drive {by:g} m left", by=by)
        case _, "y", False:
            return say("runs.drive_right", "drive {by:g} m right", by=by)
        case _, _, True:
            return say("runs.turn_left", "turn {by:g}° left", by=by)
    return say("runs.turn_right", "turn {by:g}° right", by=by)


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
