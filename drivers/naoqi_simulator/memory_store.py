"""What ALMemory holds: values that are put there or looked up, and who hears of events."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

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
