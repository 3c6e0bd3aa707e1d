"""`TestService`: the service with which a test or a rehearsal looks behind the robot's face.

No real robot has it. It answers whatever fault there is, but not while the process is frozen.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import Any

from naoqi_simulator.faults import Entry, as_json
from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.visitor import SimulatedPerson
from naoqi_simulator.world import SimulatedWorld

#: Distance (m) and number of somebody who is put there without saying where.
_DEFAULT = SimulatedPerson(number=1, distance=1.0, angle=0.0, looking=True, talking=False)


class TestService(Service):
    """Reads and changes the robot by name.

    Args:
        world: The robot and its room.
        seen: Gives everything that can be looked at, by name.
        changes: Takes a new value, by the name of what can be changed.
        touch: Touches the tablet; None: there is none.
    """

    name = "StandIn"

    def __init__(
        self,
        world: SimulatedWorld,
        seen: Callable[[], Mapping[str, Any]],
        changes: Mapping[str, Callable[[Any], object]],
        touch: Callable[[float, float], None] | None,
    ) -> None:
        super().__init__()
        self._world, self._seen, self._changes, self._touch = world, seen, changes, touch

    @offers("trace()[(sssl)]")
    def trace(self) -> list[Entry]:
        """Every method entered: service, method, arguments as JSON text, CLOCK_MONOTONIC in ns."""
        return list(self._world.desk.entries)

    @offers("clear()v")
    def clear(self) -> None:
        """Forget the trace and end all faults."""
        self._world.desk.entries.clear()
        self._world.faults.clear()

    @offers("fault(sf)v")
    def fault(self, kind: str, seconds: float) -> None:
        """Let something be wrong for so long; 0: until `none` or `clear`."""
        self._world.faults.begin(kind, seconds)

    @offers("set(ss)v")
    def set(self, name: str, value: str) -> None:
        """Change something; the value is JSON text. `memory:KEY` puts a key of ALMemory."""
        decoded = _decoded(value)
        if name.startswith("memory:"):
            self._world.store.raise_event(name.removeprefix("memory:"), decoded)
            return
        if name == "person":
            self.person(value)
            return
        if name not in self._changes:
            names = ", ".join(self._changes)
            raise CallRefusedError(
                f"StandIn::set\n\tnothing to change under {name}; there is {names}"
            )
        try:
            self._changes[name](decoded)
        except (TypeError, ValueError, KeyError) as error:
            raise CallRefusedError(f"StandIn::set\n\t{name} cannot be {value}: {error}") from None

    @offers("get(s)s")
    def get(self, name: str) -> str:
        """Something as JSON text; `state`: everything. `memory:KEY` looks up a key of ALMemory."""
        if name == "state":
            return as_json(self._seen())
        if name.startswith("memory:"):
            try:
                return as_json(self._world.store.get(name.removeprefix("memory:")))
            except KeyError:
                raise CallRefusedError(f"StandIn::get\n\tALMemory has no {name[7:]}") from None
        seen = self._seen()
        if name not in seen:
            raise CallRefusedError(
                f"StandIn::get\n\tnothing under {name}; there is state, and all in it"
            )
        return as_json(seen[name])

    @offers("touch(ff)v")
    def touch(self, x: float, y: float) -> None:
        """Somebody touches the tablet: shares of its width and height from the left top."""
        if not (0 <= x <= 1 and 0 <= y <= 1):
            raise CallRefusedError("StandIn::touch\n\tx and y are shares of the screen, 0 to 1")
        if self._touch is None:
            raise CallRefusedError("StandIn::touch\n\tthis robot has no tablet; set touched")
        self._touch(x, y)

    @offers("person(s)v")
    def person(self, who: str) -> None:
        """Put somebody there, as JSON: `{"distance": 1.2, "talking": true}`, `null` for nobody.

        `"auto"` leaves it to the seed again.
        """
        decoded = _decoded(who)
        if decoded == "auto":
            self._world.placed = None
        elif decoded is None:
            self._world.placed = False
        elif isinstance(decoded, Mapping):
            self._world.placed = _placed(decoded)
        else:
            raise CallRefusedError(
                f'StandIn::person\n\t{who} is nobody; give an object, null or "auto"'
            )


def _placed(description: Mapping[str, Any]) -> SimulatedPerson:
    fields = asdict(_DEFAULT)
    if unknown := set(description) - set(fields):
        raise CallRefusedError(f"StandIn::person\n\tnobody has {', '.join(sorted(unknown))}")
    for name, value in description.items():
        kind = type(fields[name])
        if type(value) is not kind and (kind, type(value)) != (float, int):
            raise CallRefusedError(
                f"StandIn::person\n\t{name} must be {kind.__name__}, not {value!r}"
            )
        fields[name] = kind(value)
    return SimulatedPerson(**fields)


def _decoded(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError as error:
        raise CallRefusedError(f"StandIn\n\t{text!r} is not JSON: {error}") from None
