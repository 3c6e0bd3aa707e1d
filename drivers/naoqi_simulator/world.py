"""The one simulated robot and the room it stands in: what all services share."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from naoqi_simulator.body import SimulatedBody
from naoqi_simulator.faults import CallRecord, SimulatedFaults
from naoqi_simulator.robot_time import Activities, SimulatorTime
from naoqi_simulator.visitor import SimulatedPerson, SimulatedVisitors

#: Answers for keys of one kind: the value, or None when there is none for that key now.
Provider = Callable[[str], Any]


class MemoryStore:
    """Keys and values; events reach their listeners in the order they were raised."""

    def __init__(self) -> None:
        self._data: dict[str, Any] = {}
        self._exact: dict[str, Callable[[], Any]] = {}
        self._prefixes: dict[str, Provider] = {}
        self._listeners: dict[str, list[Callable[[Any], None]]] = {}

    def provide(self, key: str, value: Callable[[], Any]) -> None:
        """Look this key up whenever it is asked for."""
        self._exact[key] = value

    def provide_all(self, prefix: str, provider: Provider) -> None:
        """Look up every key that begins so; a provider's None means that there is no such key."""
        self._prefixes[prefix] = provider

    def put(self, key: str, value: Any) -> None:
        """Keep a value; it hides what is provided under that key."""
        self._data[key] = value

    def drop(self, key: str) -> None:
        """Forget a value that was put. Raises KeyError."""
        del self._data[key]

    def get(self, key: str) -> Any:
        """The value now. Raises KeyError."""
        if key in self._data:
            return self._data[key]
        if key in self._exact:
            return self._exact[key]()
        for prefix, provider in self._prefixes.items():
            if key.startswith(prefix):
                value = provider(key)
                if value is not None:
                    return value
        raise KeyError(key)

    def raise_event(self, key: str, value: Any) -> None:
        """Keep the value and tell everybody who listens."""
        self._data[key] = value
        self.notify(key, value)

    def notify(self, key: str, value: Any) -> None:
        """Tell everybody who listens, of a value that is provided."""
        for listener in list(self._listeners.get(key, ())):
            listener(value)

    def listen(self, key: str, listener: Callable[[Any], None]) -> None:
        """Hear this event from now on."""
        self._listeners.setdefault(key, []).append(listener)

    def keys(self) -> Iterable[str]:
        """All keys by name, but those provided by prefix."""
        return sorted({*self._data, *self._exact})


class ConnectedClients(Protocol):
    """Services that clients of the robot have registered: where sound is sent to."""

    async def call(self, service: str, method: str, *args: Any) -> Any:
        """Call a client's service. Raises LookupError when there is none of that name."""
        ...


@dataclass(frozen=True, slots=True)
class SimulatorOptions:
    """How this robot is: `python -m naoqi_simulator --help` says what each means."""

    seed: int = 7
    visitors: bool = True
    life: str = "solitary"
    moody: bool = False
    invalid_signature: bool = True
    version: str = "2.5.10.7"
    files: Path | None = None


@dataclass(slots=True)
class SimulatedWorld:
    """Everything that is so at this moment."""

    time: SimulatorTime
    options: SimulatorOptions = field(default_factory=SimulatorOptions)
    clients: ConnectedClients | None = None
    faults: SimulatedFaults = field(init=False)
    desk: CallRecord = field(init=False)
    going: Activities = field(init=False)
    body: SimulatedBody = field(init=False)
    store: MemoryStore = field(init=False)
    random: random.Random = field(init=False)
    #: What went wrong without anybody being told on the wire: an animation in speech that is not
    #: installed, an address that the tablet could not load.
    notes: list[str] = field(init=False)
    #: A person put there by hand; False: nobody.
    placed: SimulatedPerson | bool | None = field(init=False)
    #: Whether the person there answers the robot just now.
    talks: bool = field(init=False)
    _visitors: SimulatedVisitors = field(init=False)

    def __post_init__(self) -> None:
        self.faults = SimulatedFaults(self.time)
        self.desk = CallRecord(self.faults)
        self.going = Activities(self.time)
        self.body = SimulatedBody(self.time)
        self.store = MemoryStore()
        self.random = random.Random(self.options.seed)
        self.notes = []
        self.talks = False
        self.placed = None if self.options.visitors else False
        self._visitors = SimulatedVisitors(self.options.seed)

    def person(self) -> SimulatedPerson | None:
        """Who stands before the robot now."""
        if isinstance(self.placed, SimulatedPerson):
            person: SimulatedPerson | None = self.placed
        else:
            person = None if self.placed is False else self._visitors.at(self.time.now())
        return replace(person, talking=True, looking=True) if person and self.talks else person

    def nearest(self) -> float | None:
        """Metres to what is in front of the robot, or None for nothing within the sonar's range."""
        person = self.person()
        there = [self.body.front] + ([person.distance] if person else [])
        return min((one for one in there if one is not None), default=None)

    def note(self, text: str) -> None:
        """Keep for whoever looks at the robot's log."""
        self.notes.append(text)


def flat(value: Any) -> list[Any]:
    """One value or a list of them, as a list: how NAOqi takes names and angles."""
    return list(value) if isinstance(value, Sequence) and not isinstance(value, str) else [value]
