"""Describes what can be asked of a session: the verbs as the bus checks them, the sensors."""

from __future__ import annotations

from collections.abc import Mapping

from woz_tui.config.experiment import Experiment
from woz_tui.config.sensor_names import published_names
from woz_tui.drivers.contract import Argument, Verb
from woz_tui.drivers.sensor_units import sensor_unit
from woz_tui.protocol.description import (
    ArgumentDescription,
    Description,
    SensorDescription,
    VerbDescription,
)

#: Kind of an argument -> type of its JSON; all others are strings.
_TYPES = {
    "number": "number",
    "seconds": "number",
    "whole": "integer",
    "flag": "boolean",
    "joints": "object",
    "poses": "array",
}


def describe(
    experiment: Experiment, verbs: Mapping[str, Mapping[str, Verb]], units: Mapping[str, str]
) -> Description:
    """Verbs by driver as they are offered now; `units`: those that sensors told themselves."""
    names = published_names(experiment.drivers)
    return Description(
        verbs=[_verb(driver, verb) for driver in verbs for verb in verbs[driver].values()],
        sensors=[
            SensorDescription(name=name, driver=driver, unit=units.get(name) or sensor_unit(own))
            for driver, sensors in names.items()
            for own, name in sensors.items()
        ],
    )


def _verb(driver: str, verb: Verb) -> VerbDescription:
    return VerbDescription(
        name=verb.name,
        driver=driver,
        lane=verb.lane,
        limit_s=verb.limit_s,
        summary=verb.summary,
        arguments=[*map(_argument, verb.arguments)],
        stream=verb.stream,
        drives=verb.drives,
        brief=verb.brief,
        arrives=verb.arrives,
        evidence=verb.evidence,
    )


def _argument(argument: Argument) -> ArgumentDescription:
    bounds = argument.range
    unit = {"seconds": "s", "joints": "degrees"}.get(argument.kind, "")
    return ArgumentDescription(
        name=argument.name,
        kind=argument.kind,
        type=_TYPES.get(argument.kind, "string"),
        summary=argument.summary,
        required=argument.required,
        default=argument.default,
        unit=(bounds.unit if bounds is not None else "") or unit,
        low=bounds.low if bounds is not None else None,
        high=bounds.high if bounds is not None else None,
        choices=[*argument.choices],
    )
