"""What the wizard may tell the model: verbs of the performer `engagement`, understood and obeyed.

Live, a verb is understood when it is performed, and obeyed when its `command.done` has gone into
the log; so whoever reads the log obeys the very same orders at the same places.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from woz_tui.config.engagement_words import CONDITION, SIGNS
from woz_tui.config.sign_values import SENSOR, argument_problem, identity_of, sign_value
from woz_tui.config.visitor_names import name_of
from woz_tui.protocol.messages import Json
from woz_tui.protocol.requesters import WIZARD
from woz_tui.protocol.sentence import Sentence
from woz_tui.sensing.engagement_model import EngagementModel, Transition
from woz_tui.sensing.state_machine import Event, State, named_from

ALL = "all"
_STEP = "step"

#: Arguments of the types that the verbs have (`config.session_verbs`); the bus has checked them.
Args = Mapping[str, Any]


# -- understood --------------------------------------------------------------------------------


def resolved_arguments(model: EngagementModel, verb: str, args: Args) -> dict[str, Json]:
    """The arguments in the form in which they are obeyed, as things stand now.

    Raises `ValueError` with a sentence if they make no sense at this moment.
    """
    return _UNDERSTAND[verb](model, args)


def _toggle(model: EngagementModel, args: Args) -> dict[str, Json]:
    sign = args["sign"]
    return {"sign": sign, "value": "off" if model.verdicts.get(sign) == 1 else "on"}


def _sense(model: EngagementModel, args: Args) -> dict[str, Json]:
    sign, value = args["sign"], args["value"].strip()
    verdict = sign_value("presence" if sign == ALL else sign, value)
    if sign == "identity" and isinstance(verdict, str):
        value = identity_of(verdict)
    return {"sign": sign, "value": value}


def _force(model: EngagementModel, args: Args) -> dict[str, Json]:
    to = args["to"]
    leaving = dict.fromkeys(edge.outcome for edge in named_from(model.state))
    if to == model.state:
        raise ValueError(Sentence("hand.already", "it is {state} already", state=to))
    if to in set(State) or to in leaving:
        return {"to": to}
    outcomes = f", or {', '.join(leaving)}" if leaving else ""
    raise ValueError(f"{to!r} does not lead out of {model.state}: name a state{outcomes}")


def _run(model: EngagementModel, args: Args) -> dict[str, Json]:
    run = args["run"]
    if run == _STEP and model.run != "hold":
        raise ValueError(Sentence("hand.only_held", "only a model on hold goes step by step"))
    if run == _STEP and not model.pending:
        raise ValueError(
            Sentence(
                "hand.no_way",
                "no way out of {state} is open now: `force` takes one all the same",
                state=model.state.value,
            )
        )
    return {"run": run}


def _filter(model: EngagementModel, args: Args) -> dict[str, Json]:
    wrong = argument_problem("filter", args)
    if wrong:
        raise ValueError(wrong)
    return dict(args)


def _social_distance(model: EngagementModel, args: Args) -> dict[str, Json]:
    if args["metres"] >= model.settings.farthest:
        raise ValueError(
            f"{args['metres']:g} m is beyond the sensor's reach, {model.settings.farthest:g} m"
        )
    return dict(args)


def _handshake(model: EngagementModel, args: Args) -> dict[str, Json]:
    what = args["what"]
    code = name_of(args["code"]) if args.get("code") else ""
    if what != "begin" and model.state is not State.HANDSHAKE:
        raise ValueError(
            Sentence(
                "hand.no_handshake",
                "there is no handshake to end: the state is {state}",
                state=model.state.value,
            )
        )
    if what == "ok" and not (code or model.has_name or model.visitor):
        raise ValueError(
            Sentence(
                "hand.nobody_named", "nobody has a name yet: give it with `code`, or with `visitor`"
            )
        )
    return {"what": what, "code": code} if code else {"what": what}


def _visitor(model: EngagementModel, args: Args) -> dict[str, Json]:
    arguments = {**args, "code": name_of(args["code"])}
    return {key: value for key, value in arguments.items() if value != ""}


_UNDERSTAND: Mapping[str, Callable[[EngagementModel, Args], dict[str, Json]]] = {
    "toggle": _toggle,
    "sense": _sense,
    "force": _force,
    "engagement": _run,
    "filter": _filter,
    "social_distance": _social_distance,
    "attend": lambda model, args: dict(args),
    "handshake": _handshake,
    "visitor": _visitor,
}


# -- obeyed ------------------------------------------------------------------------------------


def apply_command(
    model: EngagementModel, verb: str, args: Args, by: str = WIZARD
) -> Transition | None:
    """Do what was understood; the transition that it brought, if it brought one. `by`: who said so.

    Raises `ValueError` if it makes no sense any more.
    """
    match verb:
        case "toggle" | "sense":
            _give(model, args["sign"], args["value"], by)
        case "force":
            return model.force(args["to"], by)
        case "engagement":
            if args["run"] == _STEP:
                return model.step_once(by)
            model.run = args["run"]
        case "filter":
            numbers = {name: args.get(name) for name in ("kind", "samples", "threshold")}
            for each in SIGNS if args["sign"] == ALL else (args["sign"],):
                model.configure(each, **numbers)
        case "social_distance":
            model.near_within(args["metres"])
        case "handshake" | "visitor":
            return _introduced(model, verb, args, by)
        case _:
            return None
    return model.step()


def _give(model: EngagementModel, sign: str, value: str, by: str) -> None:
    if sign == ALL:
        for each in SIGNS if value == SENSOR else CONDITION:
            _give(model, each, value, by)
        return
    verdict = sign_value(sign, value)
    model.override(sign, verdict, verdict if isinstance(verdict, str) else "", by)


def _introduced(model: EngagementModel, verb: str, args: Args, by: str) -> Transition | None:
    what = "ok" if verb == "visitor" else args["what"]
    if what == "begin":
        return None if model.state is State.HANDSHAKE else model.force(State.HANDSHAKE, by)
    if what == "ok" and args.get("code"):
        model.take_name(args["code"])
    if model.state is not State.HANDSHAKE:
        return model.step()
    if model.run != "run":  # the wizard says so: nothing is left to decide
        return model.force("eng2know" if what == "ok" else "eng2unknow", by)
    return model.step(Event.HANDSHAKE_OK if what == "ok" else Event.HANDSHAKE_FAIL)
