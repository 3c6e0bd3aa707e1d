"""What the wizard may tell the model: verbs of the performer `engagement`, understood and obeyed.

Live, a verb is understood when it is performed, and obeyed when its `command.done` has gone into
the log; so whoever reads the log obeys the very same orders at the same places.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

from woz_tui.core.messages import Json
from woz_tui.experiment.engagement import CONDITION, FILTERS, MODES, RUNS, SIGNS
from woz_tui.experiment.sensed import SENSOR, identity_of, nonsense, sensed
from woz_tui.experiment.visitor_names import name_of
from woz_tui.sensing.machine import OUTCOMES, Event, State, edges_from
from woz_tui.sensing.model import Change, Engagement

ALL = "all"
_STEP = "step"

Args = Mapping[str, Json]


# -- understood --------------------------------------------------------------------------------


def understood(model: Engagement, verb: str, args: Args) -> dict[str, Json]:
    """The arguments in the form in which they are obeyed, as things stand now.

    Raises `ValueError` with a sentence if they make no sense at this moment.
    """
    understand = _UNDERSTAND.get(verb)
    if understand is None:
        raise ValueError(f"the engagement model knows no {verb!r}")
    return understand(model, {name: value for name, value in args.items() if value is not None})


def _toggle(model: Engagement, args: Args) -> dict[str, Json]:
    sign = _word(args, "sign", CONDITION)
    return {"sign": sign, "value": "off" if model.verdicts.get(sign) == 1 else "on"}


def _sense(model: Engagement, args: Args) -> dict[str, Json]:
    sign, value = _word(args, "sign", (*SIGNS, ALL)), args.get("value")
    if not isinstance(value, str):
        raise ValueError(f"{sign} needs a value: on, off, or {SENSOR}")
    value = value.strip()
    meant = sensed("presence" if sign == ALL else sign, value)
    if sign == "identity" and isinstance(meant, str):
        value = identity_of(meant)
    return {"sign": sign, "value": value}


def _force(model: Engagement, args: Args) -> dict[str, Json]:
    to = str(args.get("to", "")).strip()
    leaving = dict.fromkeys(edge.outcome for edge in edges_from(model.state))
    if to == model.state:
        raise ValueError(f"it is {to} already")
    if to in set(State) or to in leaving:
        return {"to": to}
    what = "does not lead" if to in OUTCOMES else "is neither a state nor leads"
    outcomes = f", or {', '.join(leaving)}" if leaving else ""
    raise ValueError(f"{to!r} {what} out of {model.state}: name a state{outcomes}")


def _run(model: Engagement, args: Args) -> dict[str, Json]:
    run = _word(args, "run", (*RUNS, _STEP))
    if run == _STEP and model.run != "hold":
        raise ValueError("only a model on hold goes step by step")
    if run == _STEP and not model.pending:
        raise ValueError(f"no way out of {model.state} is open now: `force` takes one all the same")
    return {"run": run}


def _filter(model: Engagement, args: Args) -> dict[str, Json]:
    said: dict[str, Json] = {"sign": _word(args, "sign", (*SIGNS, ALL))}
    if "kind" in args:
        said["kind"] = _word(args, "kind", FILTERS)
    if "samples" in args:
        said["samples"] = int(_number(args, "samples", 1, 1000))
    if "threshold" in args:
        said["threshold"] = _number(args, "threshold", 0, 1)
    wrong = nonsense("filter", said)
    if wrong:
        raise ValueError(wrong)
    return said


def _social_distance(model: Engagement, args: Args) -> dict[str, Json]:
    metres = _number(args, "metres", 0.1, 10)
    if metres >= model.settings.farthest:
        raise ValueError(
            f"{metres:g} m is beyond the sensor's reach, {model.settings.farthest:g} m"
        )
    return {"metres": metres}


def _attend(model: Engagement, args: Args) -> dict[str, Json]:
    return {"mode": _word(args, "mode", MODES)}


def _handshake(model: Engagement, args: Args) -> dict[str, Json]:
    what = _word(args, "what", ("begin", "ok", "fail"))
    code = name_of(str(args["code"])) if args.get("code") else ""
    if what != "begin" and model.state is not State.HANDSHAKE:
        raise ValueError(f"there is no handshake to end: the state is {model.state}")
    if what == "ok" and not code and not _known(model):
        raise ValueError("nobody has a name yet: give it with `code`, or with `visitor`")
    return {"what": what, "code": code} if code else {"what": what}


def _visitor(model: Engagement, args: Args) -> dict[str, Json]:
    code = name_of(str(args.get("code", "")))
    return {key: value for key, value in {**args, "code": code}.items() if value != ""}


_UNDERSTAND: Mapping[str, Callable[[Engagement, Args], dict[str, Json]]] = {
    "toggle": _toggle,
    "sense": _sense,
    "force": _force,
    "engagement": _run,
    "filter": _filter,
    "social_distance": _social_distance,
    "attend": _attend,
    "handshake": _handshake,
    "visitor": _visitor,
}


# -- obeyed ------------------------------------------------------------------------------------


def obeyed(model: Engagement, verb: str, args: Args) -> Change | None:
    """Do what was understood; the transition that it brought, if it brought one.

    Raises `ValueError` if it makes no sense any more.
    """
    match verb:
        case "toggle" | "sense":
            _give(model, str(args["sign"]), str(args["value"]))
        case "force":
            return model.force(str(args["to"]))
        case "engagement":
            if args["run"] == _STEP:
                return model.step_once()
            model.run = str(args["run"])
        case "filter":
            _configure(model, args)
        case "social_distance":
            model.near_within(_number(args, "metres", 0.1, 10))
        case "handshake" | "visitor":
            return _introduced(model, verb, args)
        case _:
            return None
    return model.step()


def _give(model: Engagement, sign: str, value: str) -> None:
    if sign == ALL:
        for each in SIGNS if value == SENSOR else CONDITION:
            _give(model, each, value)
        return
    meant = sensed(sign, value)
    model.override(sign, meant, meant if isinstance(meant, str) else "")


def _configure(model: Engagement, args: Args) -> None:
    sign, kind = str(args["sign"]), args.get("kind")
    samples, threshold = args.get("samples"), args.get("threshold")
    for each in SIGNS if sign == ALL else (sign,):
        model.configure(
            each,
            kind=kind if isinstance(kind, str) else None,
            samples=samples if isinstance(samples, int) else None,
            threshold=float(threshold) if isinstance(threshold, int | float) else None,
        )


def _introduced(model: Engagement, verb: str, args: Args) -> Change | None:
    what = "ok" if verb == "visitor" else args["what"]
    if what == "begin":
        return None if model.state is State.HANDSHAKE else model.force(State.HANDSHAKE)
    code = args.get("code")
    if what == "ok" and isinstance(code, str) and code:
        model.known_as(code)
    if model.state is not State.HANDSHAKE:
        return model.step()
    if model.run != "run":  # the wizard says so: nothing is left to decide
        return model.force("eng2know" if what == "ok" else "eng2unknow")
    return model.step(Event.HANDSHAKE_OK if what == "ok" else Event.HANDSHAKE_FAIL)


def _known(model: Engagement) -> bool:
    return model.known or bool(model.visitor)


# -- arguments ---------------------------------------------------------------------------------


def _word(args: Args, name: str, choices: tuple[str, ...]) -> str:
    value = args.get(name)
    if isinstance(value, str) and value in choices:
        return value
    raise ValueError(f"{name} is one of {', '.join(choices)}, not {value!r}")


def _number(args: Args, name: str, low: float, high: float) -> float:
    value = args.get(name)
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ValueError(f"{name} is a number from {low:g} to {high:g}, not {value!r}")
    return float(value)
