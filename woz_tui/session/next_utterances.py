"""What each driver will probably be asked to say, with the variables as they are now."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from woz_tui.config.experiment import Call, Experiment
from woz_tui.config.utterance_template import VISITOR
from woz_tui.protocol.messages import Json
from woz_tui.session.participant_identity import RequestError
from woz_tui.session.variables import MissingValueError, fill_variables

#: The verb and its argument that hold an utterance.
SAY, TEXT = "say", "text"


def utterances(experiment: Experiment, values: Mapping[str, str]) -> dict[str, list[str]]:
    """Utterances by driver, each once, in the file's order.

    Those with a variable that has no value yet are left out.
    """
    found: dict[str, dict[str, None]] = {}
    actions = [action for panel in experiment.panels for action in panel.actions]
    for action in (*actions, *experiment.repairs):
        for call in action.calls:
            for written in _written(call, values) if call.verb == SAY else ():
                if text := _text(written, values):
                    found.setdefault(call.driver, {})[text] = None
    return {driver: list(texts) for driver, texts in found.items()}


def _written(call: Call, values: Mapping[str, str]) -> Iterable[Json]:
    """What it may be asked to say in this condition, with the variables still in place."""
    choice = call.choices.get(TEXT)
    return choice.of(values.get("condition", "")) if choice else (call.args.get(TEXT),)


def _text(value: Json, values: Mapping[str, str]) -> str:
    try:
        text = fill_variables(value, values)
    except MissingValueError:
        return ""
    return text if isinstance(text, str) else ""


def no_value(refused: str) -> RequestError:
    """The refusal of a line whose variable has no value, with where the value comes from."""
    if refused.startswith(f"{{{VISITOR}}}"):
        return RequestError(
            refused,
            "the visitor is not identified: enter who it is, or wait for face recognition or"
            " a handshake",
            command="engagement",
        )
    return RequestError(refused, "choose participant and condition", command="start")
