"""The one simulated robot and the room it stands in: what all services share."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from naoqi_simulator.body import SimulatedBody, SimulatedFalls
from naoqi_simulator.faults import CallRecord, SimulatedFaults
from naoqi_simulator.joints import PEPPER, BodyPlan
from naoqi_simulator.memory_store import MemoryStore
from naoqi_simulator.nao_body import NAO
from naoqi_simulator.robot_time import Activities, SimulatorTime
from naoqi_simulator.visitor import SimulatedPerson, SimulatedVisitors


class ConnectedClients(Protocol):
    """Services that clients of the robot have registered: where sound is sent to."""

    async def call(self, service: str, method: str, *args: Any) -> Any:
        """Call a client's service. Raises LookupError when there is none of that name."""
        ...


#: By what `--robot` says.
ROBOTS: Mapping[str, BodyPlan] = {"pepper": PEPPER, "nao": NAO}
#: What ALSystem says it runs unless told otherwise.
VERSIONS = {"pepper": "2.5.10.7", "nao": "2.8.6.23"}


@dataclass(frozen=True, slots=True)
class SimulatorOptions:
    """How this robot is: `python -m naoqi_simulator --help` says what each means."""

    robot: str = "pepper"
    seed: int = 7
    visitors: bool = True
    life: str = "solitary"
    moody: bool = False
    invalid_signature: bool = True
    version: str = ""
    files: Path | None = None
    echo: float = 0.3


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
    falls: SimulatedFalls = field(init=False)
    random: random.Random = field(init=False)
    #: What went wrong without anybody being told on the wire: an animation in speech that is not
    #: installed, an address that the tablet could not load.
    notes: list[str] = field(init=False)
    #: A person put there by hand; False: nobody.
    placed: SimulatedPerson | bool | None = field(init=False)
    #: When the loudspeaker spoke of late, in seconds: begin, and end or None while it speaks.
    spoke: list[tuple[float, float | None]] = field(default_factory=list)
    #: Whether the person there answers the robot just now.
    talks: bool = field(init=False)
    _visitors: SimulatedVisitors = field(init=False)

    def __post_init__(self) -> None:
        self.faults = SimulatedFaults(self.time)
        self.desk = CallRecord(self.faults)
        self.going = Activities(self.time)
        self.body = SimulatedBody(self.time, ROBOTS[self.options.robot])
        self.store = MemoryStore()
        self.falls = SimulatedFalls(self.body, self.going, self.store)
        if self.body.plan.walks:
            self.faults.happens["fall"] = self.falls.fall
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
