"""Foretells how an action would go, from what drivers know of their commands. Nothing moves."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Mapping
from typing import Any, Protocol

from woz_tui.config.experiment import Call
from woz_tui.drivers.argument_check import ArgumentError, checked
from woz_tui.drivers.contract import DriverError, Forecast, Verb
from woz_tui.drivers.driver_call import DriverCall, guarded
from woz_tui.protocol.description import PredictedCommand, PredictedMark, Prediction
from woz_tui.protocol.refusal import RequestError
from woz_tui.session.action_texts import Steps

#: Whether what a call does may not be told to whoever asks.
Kept = Callable[[Call], bool]
#: A driver that does not know by then does not know, in seconds.
PATIENCE_S = 10.0


class Forecaster(Protocol):
    """A driver, or who else can foretell commands (see `Driver.predict`)."""

    async def predict(self, verb: str, args: Mapping[str, Any]) -> Forecast:
        """How a command would go."""


log = logging.getLogger(__name__)


async def predicted(
    steps: Steps,
    verb_of: Callable[[str, str], Verb | None],
    drivers: Mapping[str, Forecaster],
    kept: Kept,
) -> Prediction:
    """How these steps would go, one after the other, if they began now on an idle robot.

    Raises `RequestError` if one of them would be refused.
    """
    commands: list[PredictedCommand] = []
    begins: float | None = 0.0
    over: float | None = 0.0
    for step in steps:
        if isinstance(step, float | int):
            begins = None if begins is None else begins + step
            continue
        ends: list[float | None] = []
        for call in step:
            verb = verb_of(call.driver, call.verb)
            foretold = Forecast() if kept(call) else await forecast(call, verb, drivers)
            commands.append(_predicted_command(call, begins, foretold))
            over = _later(over, _sum(begins, foretold.seconds))
            goes_on = verb is not None and verb.stream and not call.until
            ends.append(begins if goes_on else _sum(begins, foretold.seconds))
        begins = None if None in ends else max(end for end in (*ends, begins) if end is not None)
    return Prediction(duration_us=_us(_later(over, begins)), commands=commands)


async def forecast(call: Call, verb: Verb | None, drivers: Mapping[str, Forecaster]) -> Forecast:
    """How one call would go. Raises `RequestError` if it would be refused."""
    driver = drivers.get(call.driver)
    if driver is None or verb is None:  # the session or its model: done at once
        return Forecast(0.0, ())
    try:
        args = verb.spoken(checked(verb, call.args))
        async with asyncio.timeout(PATIENCE_S):
            made = DriverCall(call.driver, f"predict {call.verb}")
            return await guarded(lambda: driver.predict(call.verb, args), made)
    except ArgumentError as error:
        raise RequestError(str(error)) from error
    except DriverError as error:
        raise RequestError(error.what, error.remedy) from error
    except TimeoutError:
        return Forecast()
    except Exception:  # a stranger's driver: then nobody knows
        log.exception("%s cannot predict %s", call.driver, call.verb)
        return Forecast()


def _predicted_command(call: Call, begins: float | None, forecast: Forecast) -> PredictedCommand:
    marks = forecast.marks
    return PredictedCommand(
        verb=call.verb,
        driver=call.driver,
        begins_us=_us(begins),
        duration_us=_us(forecast.seconds),
        marks=None
        if marks is None
        else [
            PredictedMark(at_us=round(at * 1e6), sort=sort, text=text) for at, sort, text in marks
        ],
    )


def _sum(begins: float | None, seconds: float | None) -> float | None:
    return None if begins is None or seconds is None else begins + seconds


def _later(one: float | None, other: float | None) -> float | None:
    return None if one is None or other is None else max(one, other)


def _us(seconds: float | None) -> int | None:
    return None if seconds is None else round(seconds * 1_000_000)
