"""What a program that calls tools by name is offered of a session: a tool for each verb.

Each tool has a JSON Schema of its arguments, made from what the session describes. There is none
that releases a stop: that is for people.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from woz_tui.client import WozClient, WozRefusedError
from woz_tui.protocol import messages as m
from woz_tui.protocol.description import ArgumentDescription, VerbDescription
from woz_tui.protocol.panels import ActionView, PanelView

#: The tools beside the verbs.
PLAY, STOP, LOOK, DRIVER = "play_action", "stop_everything", "look_at_session", "driver"

#: Drivers of the session itself: locks, filters and the study are the wizard's.
OWN_DRIVERS = ("session", "engagement")

Json = m.Json


@dataclass(frozen=True, slots=True)
class Tool:
    """One tool: what it is called, what it does, the JSON Schema of its arguments."""

    name: str
    summary: str
    schema: Mapping[str, Any]
    #: Whether the robot stays as it is.
    only_looks: bool = False


def tools_of(verbs: Iterable[VerbDescription], panels: Iterable[PanelView]) -> list[Tool]:
    """All tools of a session; a verb that several drivers have is one, with its `driver`."""
    drivers: dict[str, list[VerbDescription]] = {}
    for verb in verbs:
        if verb.driver in OWN_DRIVERS:
            continue
        drivers.setdefault(verb.name, []).append(verb)
    actions = [action for panel in panels for action in panel.actions]
    labels = "; ".join(map(_label, actions))
    slots = {name: {"type": "string"} for action in actions for name in action.slots}
    given: Mapping[str, Any] = {"slots": _schema(slots)} if slots else {}
    return [
        *(_verb_tool(views) for views in drivers.values()),
        Tool(
            PLAY,
            f"Play an action of the experiment to its end. {labels}",
            _schema({"action": {"enum": [action.name for action in actions]}, **given}, ["action"]),
        ),
        Tool(STOP, "Stop everything the robot does, at once. Only a person can go on.", _schema()),
        Tool(LOOK, "What holds now: the stop, engagement, the last readings.", _schema(), True),
    ]


def _label(action: ActionView) -> str:
    """What an action is called, and what has to be given with it."""
    slots = f" (slots: {', '.join(action.slots)})" if action.slots else ""
    return f"{action.name}: {action.label}{slots}"


def _verb_tool(views: list[VerbDescription]) -> Tool:
    first = views[0]
    properties = {argument.name: _argument_schema(argument) for argument in first.arguments}
    required = [argument.name for argument in first.arguments if argument.required]
    if len(views) > 1:
        properties[DRIVER] = {"enum": [view.driver for view in views]}
        required.append(DRIVER)
    watched = " A wizard has to watch." if first.drives else ""
    summary = f"{first.summary or first.name}.{watched}"
    return Tool(first.name, summary, _schema(properties, required))


def _argument_schema(argument: ArgumentDescription) -> dict[str, Any]:
    unit = f" ({argument.unit})" if argument.unit else ""
    schema: dict[str, Any] = {"type": argument.type, "description": f"{argument.summary}{unit}"}
    if argument.choices:
        schema["enum"] = argument.choices
    for name, limit in (("minimum", argument.low), ("maximum", argument.high)):
        if limit is not None:
            schema[name] = limit
    if argument.default is not None:
        schema["default"] = argument.default
    return schema


def _schema(
    properties: Mapping[str, Any] | None = None, required: list[str] | None = None
) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": properties or {},
        "required": required or [],
        "additionalProperties": False,
    }


class ToolCaller:
    """Carries out what is called by name.

    Args:
        client: The session.
    """

    def __init__(self, client: WozClient) -> None:
        self._client = client
        self._readings: dict[str, Json] = {}
        self._state: dict[str, Json] = {"stopped": False, "engagement": None}

    def tools(self) -> list[Tool]:
        """What is offered now."""
        return tools_of(self._client.description.verbs, self._client.panels)

    async def follow(self) -> None:
        """Keep what holds, until the session ends. Raises `WozConnectionError`."""
        async for message in self._client.messages(held=True):
            match message:
                case m.Reading():
                    self._readings[message.sensor] = message.text or message.value
                case m.EngagementChanged():
                    self._state["engagement"] = message.now
                case m.StopPressed(scope="all"):
                    self._state["stopped"] = True
                case m.StopReleased():
                    self._state["stopped"] = False

    async def call(self, name: str, args: Mapping[str, Json]) -> dict[str, Json]:
        """Carry it out to its end; returns what came of it. Raises `WozError`."""
        if name == STOP:
            stop = await self._client.stop()
            return {"confirmed": [*stop.confirmed], "missing": [*stop.missing]}
        if name == LOOK:
            return {**self._state, "readings": {**self._readings}}
        if name == PLAY:
            slots = args.get("slots", {})
            if "action" not in args or args.keys() - {"action", "slots"}:
                raise WozRefusedError(f"{PLAY} takes one argument: action, its name")
            if not isinstance(slots, dict):
                raise WozRefusedError(f"slots of {PLAY} are texts by name")
            given = {name: str(text) for name, text in slots.items()}
            await self._client.press(str(args["action"]), slots=given)
            return {"done": True}
        driver = str(args.get(DRIVER, ""))
        verbs = [verb for verb in self._client.description.verbs if verb.name == name]
        offered = [verb.driver for verb in verbs if verb.driver not in OWN_DRIVERS]
        if not offered or driver not in ("", *offered):
            raise WozRefusedError(f"there is no tool {name[:100]!r}{driver and f' of {driver!r}'}")
        if len(offered) == 1:  # and none of the session's own of that name
            driver = offered[0]
        rest = {key: value for key, value in args.items() if key != DRIVER}
        done = await self._client.perform(name, rest, driver=driver)
        return {"done": True, "sent": {**done.sent}}
