"""ALMemory: keys, values, events."""

from __future__ import annotations

from typing import Any, ClassVar

from naoqi_simulator.service_table import CallRefusedError, Service, offers
from naoqi_simulator.world import SimulatedWorld, flat


class Subscriber(Service):
    """What ALMemory.subscriber gives: an object of its own whose signal is the event."""

    name = "subscriber"
    signals: ClassVar = {"signal": "(m)"}

    def __init__(self, world: SimulatedWorld, key: str) -> None:
        super().__init__()
        world.store.listen(key, lambda value: self.emit("signal", value))


class MemoryService(Service):
    """The robot's blackboard."""

    name = "ALMemory"

    def __init__(self, world: SimulatedWorld) -> None:
        super().__init__()
        self._world, self._store = world, world.store

    @offers("subscriber(s)o")
    def subscriber(self, event: str) -> Subscriber:
        """An object with a signal; this version of NAOqi cannot give it to Python 3."""
        if self._world.options.invalid_signature:
            raise CallRefusedError("Invalid signature")
        self._check()
        return Subscriber(self._world, event)

    @offers("getData(s)m")
    def get_data(self, key: str) -> Any:
        """The value of a key."""
        self._check()
        try:
            return self._store.get(key)
        except KeyError:
            raise self._no_key("getData", key) from None

    @offers("getData(si)m")
    def get_data_as_before(self, key: str, _unused: int) -> Any:
        """As getData(s)."""
        return self.get_data(key)

    @offers("getListData(m)m")
    def get_list_data(self, keys: Any) -> list[Any]:
        """The values of several keys; None for those that are not there."""
        self._check()
        return [self._or_none(str(key)) for key in flat(keys)]

    @offers("insertData(sm)v")
    def insert_data(self, key: str, value: Any) -> None:
        """Keep a value, raise no event."""
        self._store.put(key, value)

    @offers("raiseEvent(sm)v")
    def raise_event(self, key: str, value: Any) -> None:
        """Keep a value and tell everybody who listens."""
        self._store.raise_event(key, value)

    @offers("raiseMicroEvent(sm)v")
    def raise_micro_event(self, key: str, value: Any) -> None:
        """As raiseEvent here."""
        self._store.raise_event(key, value)

    @offers("removeData(s)v")
    def remove_data(self, key: str) -> None:
        try:
            self._store.drop(key)
        except KeyError:
            raise self._no_key("removeData", key) from None

    @offers("getDataListName()[s]")
    def get_data_list_name(self) -> list[str]:
        return list(self._store.keys())

    @offers("getDataList(s)[s]")
    def get_data_list(self, part: str) -> list[str]:
        """All keys with this in them."""
        return [key for key in self._store.keys() if part in key]  # noqa: SIM118 - no dict

    def _check(self) -> None:
        if self._world.faults.active("invalid-signature"):
            raise CallRefusedError("Invalid signature")

    def _or_none(self, key: str) -> Any:
        try:
            return self._store.get(key)
        except KeyError:
            return None

    @staticmethod
    def _no_key(method: str, key: str) -> CallRefusedError:
        return CallRefusedError(f"ALMemory::{method}\n\tno data is found for the key {key}")
