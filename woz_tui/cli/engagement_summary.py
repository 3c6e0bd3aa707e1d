"""What `woz check` says about the section `engagement`: in a few lines, and for programs."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields

from woz_tui.core.driver import SPEECH
from woz_tui.core.engaged import SignShown
from woz_tui.core.messages import Json
from woz_tui.experiment.effects import ENTERED
from woz_tui.experiment.engagement import SIGNS, EngagementSettings, Timeouts
from woz_tui.experiment.engagement_check import signs_given
from woz_tui.experiment.sensors import published_names
from woz_tui.experiment.shape import Action, Engagement, Experiment
from woz_tui.sensing.model import Engagement as Model

Described = Callable[[Action], str]


def lines(
    experiment: Experiment, engagement: Engagement, described: Described
) -> Iterator[tuple[str, str]]:
    """What it is about, and the sentence; `described` puts an action into words."""
    settings = engagement.settings
    yield "engaged", _condition(settings)
    shown = Model(settings).shown().signs
    for sign in SIGNS:
        counted = _filter(shown[sign]) + _rate(settings.sign(sign).rate)
        yield sign, f"{counted}, {_given(experiment, settings, sign)}"
    yield "speech", _speech(experiment, settings)
    limits = [f"{name} {seconds:g} s" for name, seconds in _limits(settings.timeouts)]
    yield "timeouts", ", ".join(limits) or "none"
    yield "handshake", _handshake(settings)
    yield "starts", {"run": "running", "hold": "on hold", "off": "switched off"}[settings.start]
    for state, doing in _effects(engagement, described):
        yield f"on {state}", ", beside it ".join(doing)


def as_json(
    experiment: Experiment, engagement: Engagement, described: Described
) -> dict[str, Json]:
    """The same for programs."""
    settings = engagement.settings
    shown = Model(settings).shown().signs
    signs: dict[str, Json] = {
        sign: {
            "used": sign in settings.signs,
            "filter": shown[sign].filter,
            "needed": shown[sign].needed,
            "places": shown[sign].places,
            "rate": settings.sign(sign).rate,
            "sensors": [*_sensors(experiment, settings, sign)],
            "actions": [*_actions(experiment, sign)],
        }
        for sign in SIGNS
    }
    return {
        "start": settings.start,
        "social_distance": settings.social_distance,
        "signs": signs,
        "timeouts": dict(_limits(settings.timeouts)),
        "handshake": settings.handshake.by,
        "on_enter": {state: [*doing] for state, doing in _effects(engagement, described)},
    }


def _condition(settings: EngagementSettings) -> str:
    words = {
        "presence": "is there",
        "gaze": "looks",
        "distance": f"is within {settings.social_distance:g} m",
    }
    return "who " + " and ".join(words[sign] for sign in words if sign in settings.signs)


def _filter(shown: SignShown) -> str:
    match shown.filter:
        case "joint":
            return f"joint, from {shown.needed} % on"
        case "median":
            return f"median of {shown.places}"
        case kind:
            return f"{kind} {shown.needed} of {shown.places}"


def _rate(rate: float | None) -> str:
    return "" if rate is None else f", at most {rate:g} samples a second"


def _given(experiment: Experiment, settings: EngagementSettings, sign: str) -> str:
    """Where a sign comes from: sensors and the wizard's actions."""
    sensors = [*_sensors(experiment, settings, sign)]
    actions = [f"{name!r}" for name in _actions(experiment, sign)]
    parts = ["from " + " and ".join(sensors)] if sensors else []
    parts += ["by " + ", ".join(actions)] if actions else []
    return " and ".join(parts) or "nobody gives it"


def _sensors(experiment: Experiment, settings: EngagementSettings, sign: str) -> Iterator[str]:
    wanted = settings.sign(sign).sensor or sign
    yield from _publishing(experiment, wanted)


def _publishing(experiment: Experiment, wanted: str) -> Sequence[str]:
    """Each reading of this name with its driver."""
    return [
        f"{wanted} ({driver})"
        for driver, names in published_names(experiment.drivers).items()
        if wanted in names.values()
    ]


def _actions(experiment: Experiment, sign: str) -> Iterator[str]:
    for panel in experiment.panels:
        for action in panel.actions:
            if sign in signs_given(action):
                yield action.name


def _speech(experiment: Experiment, settings: EngagementSettings) -> str:
    cutting = [spec.name for spec in experiment.drivers if SPEECH in spec.sensors]
    if cutting:
        return f"cut by {' and '.join(cutting)}"
    heard = _publishing(experiment, settings.sound.sensor)
    if not heard:
        return "nobody hears it"
    threshold = settings.sound.threshold
    loud = f"louder than {threshold:g}" if threshold is not None else "as loud as it has learnt"
    return f"{' and '.join(heard)}, {loud}, {settings.sound.hang_over:g} s of silence end it"


def _limits(timeouts: Timeouts) -> Iterator[tuple[str, float]]:
    """Those that are on."""
    for item in fields(timeouts):
        seconds: float | None = getattr(timeouts, item.name)
        if seconds:
            yield item.name, seconds


def _handshake(settings: EngagementSettings) -> str:
    handshake = settings.handshake
    if handshake.by == "nobody":
        return "none: who has no name stays without one"
    if handshake.by == "wizard":
        return f"led by the wizard, {handshake.seconds:g} s at most"
    return f"led by the robot, asks {handshake.attempts} times within {handshake.seconds:g} s"


def _effects(engagement: Engagement, described: Described) -> Iterator[tuple[str, list[str]]]:
    for state in ENTERED:
        own = engagement.effects.get(state)
        doing = [described(own)] if own is not None else []
        doing += [f"plays {name!r}" for name in engagement.plays.get(state, ())]
        if doing:
            yield state, doing
