"""What an experiment says about engagement: in a few lines, and for programs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from woz_tui.config.action_text import action_text, main_arguments
from woz_tui.config.engagement import EngagementSettings
from woz_tui.config.engagement_section import ENTERED, signs_given
from woz_tui.config.engagement_words import SIGNS, VISITOR
from woz_tui.config.experiment import Engagement, Experiment
from woz_tui.config.experiment_json import verb_json
from woz_tui.config.sensor_names import published_names
from woz_tui.config.session_verbs import engagement_verbs
from woz_tui.drivers.contract import SPEECH
from woz_tui.protocol.messages import Json, SignShown
from woz_tui.sensing.engagement_model import EngagementModel as Model


def engagement_lines(experiment: Experiment, engagement: Engagement) -> Iterator[tuple[str, str]]:
    """What it is about, and the sentence."""
    settings = engagement.settings
    yield "engaged", _condition(settings)
    shown = Model(settings).shown().signs
    for sign in SIGNS:
        rate = settings.sign(sign).rate
        limit = "" if rate is None else f", at most {rate:g} samples a second"
        sources = _sign_sources(experiment, settings, sign)
        yield sign, f"{_filter(shown[sign])}{limit}, {sources}"
    yield "speech", _speech(experiment, settings)
    yield (
        "turns",
        "end when whoever spoke has gone or was replaced"
        if settings.turns == VISITOR
        else "last until they are over, as in the paper",
    )
    limits = [f"{name} {seconds:g} s" for name, seconds in _active_timeouts(settings).items()]
    yield "timeouts", ", ".join(limits) or "none"
    yield "handshake", _handshake(settings)
    yield "starts", {"run": "running", "hold": "on hold", "off": "switched off"}[settings.start]
    for state, lines in _effects(engagement, main_arguments(experiment)):
        yield f"on {state}", ", beside it ".join(lines)


def engagement_json(experiment: Experiment, engagement: Engagement) -> Json:
    settings = engagement.settings
    shown = Model(settings).shown().signs
    signs: dict[str, Json] = {
        sign: {
            "used": sign in settings.signs,
            "filter": shown[sign].filter,
            "needed": shown[sign].needed,
            "places": shown[sign].places,
            "rate": settings.sign(sign).rate,
            "sensors": [*_sensors(experiment, settings.sign(sign).sensor or sign)],
            "actions": [*_actions(experiment, sign)],
        }
        for sign in SIGNS
    }
    return {
        "start": settings.start,
        "social_distance": settings.social_distance,
        "signs": signs,
        "turns": settings.turns,
        "timeouts": {**_active_timeouts(settings)},
        "handshake": settings.handshake.by,
        "on_enter": dict(_effects(engagement, main_arguments(experiment))),
        "verbs": [*map(verb_json, engagement_verbs())],
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


def _sign_sources(experiment: Experiment, settings: EngagementSettings, sign: str) -> str:
    """Where a sign comes from: sensors and the wizard's actions."""
    sensors = _sensors(experiment, settings.sign(sign).sensor or sign)
    actions = [repr(name) for name in _actions(experiment, sign)]
    parts = ["from " + " and ".join(sensors)] if sensors else []
    parts += ["by " + ", ".join(actions)] if actions else []
    return " and ".join(parts) or "no driver gives it"


def _sensors(experiment: Experiment, reading: str) -> list[str]:
    """The readings of this name, each with its driver."""
    return [
        f"{reading} ({driver})"
        for driver, names in published_names(experiment.drivers).items()
        if reading in names.values()
    ]


def _actions(experiment: Experiment, sign: str) -> list[str]:
    """Names of the actions that give this sign."""
    actions = (action for panel in experiment.panels for action in panel.actions)
    return [action.name for action in actions if sign in signs_given(action)]


def _speech(experiment: Experiment, settings: EngagementSettings) -> str:
    speech_drivers = [spec.name for spec in experiment.drivers if SPEECH in spec.offer.sensors]
    if speech_drivers:
        return f"cut by {' and '.join(speech_drivers)}"
    publishers = _sensors(experiment, settings.sound.sensor)
    if not publishers:
        return "no driver detects it"
    threshold = settings.sound.threshold
    loud = f"louder than {threshold:g}" if threshold is not None else "above the learnt threshold"
    return f"{' and '.join(publishers)}, {loud}, {settings.sound.hang_over:g} s of silence end it"


def _active_timeouts(settings: EngagementSettings) -> dict[str, float]:
    return {name: seconds for name, seconds in settings.limits.items() if seconds}


def _handshake(settings: EngagementSettings) -> str:
    handshake = settings.handshake
    if handshake.by == "nobody":
        return "none: visitors without a name stay without one"
    if handshake.by == "wizard":
        return f"led by the wizard, {handshake.seconds:g} s at most"
    return f"led by the robot, asks {handshake.attempts} times within {handshake.seconds:g} s"


def _effects(
    engagement: Engagement, main_names: Mapping[str, str]
) -> Iterator[tuple[str, list[str]]]:
    for state in ENTERED:
        own = engagement.effects.get(state)
        lines = [action_text(own, main_names)] if own is not None else []
        lines += [f"plays {name!r}" for name in engagement.plays.get(state, ())]
        if lines:
            yield state, lines
