"""What an action does, in one line: `say hello + wave, then wait 2 s`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from woz_tui.config.experiment import Action, Call, Experiment, TextVariants, Wait
from woz_tui.config.session_verbs import engagement_verbs, session_verbs
from woz_tui.protocol.messages import Json


def action_text(action: Action, main_names: Mapping[str, str]) -> str:
    """An action in one line: calls together joined by `+`, steps by `, then`.

    `main_names` names the main argument of each verb, which needs no name.
    """
    return ", then ".join(
        f"wait {step.seconds:g} s"
        if isinstance(step, Wait)
        else " + ".join(_call_text(call, main_names) for call in step.calls)
        for step in action.steps
    )


def main_arguments(experiment: Experiment) -> dict[str, str]:
    """The main argument of each verb by the verb's name."""
    verbs = [verb for spec in experiment.drivers for verb in spec.offer.verbs]
    verbs += [*session_verbs(), *(engagement_verbs() if experiment.engagement else ())]
    return {verb.name: verb.arguments[0].name for verb in verbs if verb.arguments}


def _call_text(call: Call, main_names: Mapping[str, str]) -> str:
    words = [call.verb]
    values = {name: _value_text(value) for name, value in call.args.items()}
    values |= {name: _variants_text(choice) for name, choice in call.choices.items()}
    for name, value in values.items():
        words += [value] if name == main_names.get(call.verb) else [name, value]
    driver = f" ({call.driver})" if "." in call.driver else ""
    return " ".join(words) + driver


def _variants_text(choice: TextVariants) -> str:
    """Every text with its condition, and variants side by side."""
    groups = (
        (f"{condition}: " if condition else "") + " | ".join(map(_value_text, texts))
        for condition, texts in choice.texts.items()
    )
    return f"{{{'; '.join(groups)}}}"


def _value_text(value: Json) -> str:
    if isinstance(value, str):
        if value.startswith("/") and "/" in value[1:]:
            return Path(value).name
        return f'"{value}"' if " " in value else value
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, dict):
        return " ".join(
            _value_text(entry) if name == "joints" else f"{name} {_value_text(entry)}"
            for name, entry in value.items()
        )
    if isinstance(value, list):
        return "; ".join(map(_value_text, value))
    return f"{value:g}" if isinstance(value, float) else str(value)
