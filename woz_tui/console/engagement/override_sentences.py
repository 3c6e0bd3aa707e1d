"""What the wizard told the engagement model, in the words of a line of the list."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from woz_tui.config.session_verbs import ENGAGEMENT
from woz_tui.protocol import messages as m
from woz_tui.protocol.messages import Json

_RUNS = {"run": "runs", "hold": "held", "off": "off", "step": "one step"}
_FLAGS = {"on": "yes", "off": "no", "sensor": "back to its sensor"}
Args = Mapping[str, Json]


def override_text(verb: str, args: Args) -> str:
    """`gaze the other way, by hand`; any arguments do, the log of another version may hold any."""
    tell = _SENTENCES.get(verb)
    if tell is not None:
        return tell(args)
    return " ".join(str(part) for part in (verb, *args.values()) if part not in ("", None))


def toggled_text(message: m.Message) -> str:
    """How a sign is after the wizard has turned it the other way; else nothing."""
    if isinstance(message, m.Done) and message.driver == ENGAGEMENT and "value" in message.sent:
        return _sense(message.sent)
    return ""


def _text(args: Args, name: str) -> str:
    value = args.get(name, "")
    return f"{value:g}" if isinstance(value, float) else "" if value is None else str(value)


def _sense(args: Args) -> str:
    sign, value = _text(args, "sign"), _text(args, "value")
    if sign == "all" and value == "sensor":
        return "all signs back to their sensors"
    said = _FLAGS.get(value, f"{value} m" if sign == "distance" else value)
    return f"{sign} {said}" if value == "sensor" else f"{sign} {said}, by hand"


def _filter(args: Args) -> str:
    told = [_text(args, name) for name in ("kind", "samples", "threshold")]
    return " ".join(["filter of", _text(args, "sign"), *(part for part in told if part)])


def _visitor(args: Args) -> str:
    about = [_text(args, name) for name in ("age_group", "address")]
    return ", ".join([f"visitor {_text(args, 'code')}", *(part for part in about if part)])


_SENTENCES: Mapping[str, Callable[[Args], str]] = {
    "toggle": lambda args: f"{_text(args, 'sign')} the other way, by hand",
    "sense": _sense,
    "force": lambda args: f"force {_text(args, 'to')}",
    "engagement": lambda args: f"engagement {_RUNS.get(_text(args, 'run'), _text(args, 'run'))}",
    "filter": _filter,
    "social_distance": lambda args: f"near: up to {_text(args, 'metres')} m",
    "attend": lambda args: f"attention {_text(args, 'mode')}",
    "handshake": lambda args: f"handshake {_text(args, 'what')} {_text(args, 'code')}".rstrip(),
    "visitor": _visitor,
}


def is_override(command: m.Command | m.FilledCall) -> bool:
    """Whether it is for the model, as far as it says for whom it is."""
    return command.driver == ENGAGEMENT or (not command.driver and command.verb in _SENTENCES)
