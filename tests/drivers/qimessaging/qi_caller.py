"""A process of its own in which the `qi` package is a client.

Reads one JSON line for each thing to do, `["call", service, method, [arguments]]`, and answers
each with one: `["value", ..]` or `["error", text]`.
"""

from __future__ import annotations

import json
import sys
import threading
from typing import Any

import qi

PATIENCE_MS = 20_000


class Login:
    """Passes on name and password as libqi's clients do."""

    def __init__(self, user: str, token: str) -> None:
        self._data = {"user": user, "token": token}

    def initialAuthData(self) -> dict[str, str]:  # noqa: N802 - libqi's name
        return self._data

    def newAuthenticator(self) -> Login:  # noqa: N802 - libqi's name
        return self


class Doubler:
    """A service that is registered at our server."""

    def twice(self, value: Any) -> Any:
        return value * 2


class Caller:
    """Does what a line says."""

    def __init__(self) -> None:
        self._session = qi.Session()
        self._heard: dict[str, list[Any]] = {}
        self._news = threading.Condition()

    def connect(self, url: str, user: str = "", token: str = "") -> None:
        if user:
            self._session.setClientAuthenticatorFactory(Login(user, token))
        self._session.connect(url, _async=True).value(PATIENCE_MS)

    def services(self) -> list[str]:
        return [each["name"] for each in self._session.services()]

    def call(self, service: str, method: str, args: list[Any]) -> Any:
        found = self._session.service(service, _async=True).value(PATIENCE_MS)
        value = found.call(method, *args, _async=True).value(PATIENCE_MS)
        return list(value) if isinstance(value, bytes | bytearray) else value

    def send_bytes(self, service: str, method: str, numbers: list[int]) -> Any:
        return self.call(service, method, [bytearray(numbers)])

    def call_child(self, service: str, method: str, inner: str, args: list[Any]) -> Any:
        child = self._session.service(service).call(method)
        return child.call(inner, *args)

    def listen(self, service: str, signal: str) -> None:
        def heard(*values: Any) -> None:
            with self._news:
                self._heard.setdefault(signal, []).append(values)
                self._news.notify_all()

        getattr(self._session.service(service), signal).connect(heard)

    def heard(self, signal: str, count: int) -> list[Any]:
        with self._news:
            self._news.wait_for(lambda: len(self._heard.get(signal, [])) >= count, timeout=20)
            return self._heard.get(signal, [])

    def property(self, service: str, name: str) -> Any:
        return getattr(self._session.service(service), name).value()

    def set_property(self, service: str, name: str, value: Any) -> None:
        getattr(self._session.service(service), name).setValue(value)

    def cancel(self, service: str, method: str, args: list[Any], ready: list[str]) -> str:
        found = self._session.service(service)
        future = found.call(method, *args, _async=True)
        while not found.call(*ready):
            pass
        future.cancel()
        future.wait(PATIENCE_MS)
        return "cancelled" if future.isCanceled() else "done"

    def register(self, name: str) -> None:
        self._doubler = Doubler()
        self._session.registerService(name, self._doubler)


caller = Caller()
for line in sys.stdin:
    verb, *rest = json.loads(line)
    try:
        answer = ["value", getattr(caller, verb)(*rest)]
    except Exception as error:  # noqa: BLE001 - told to the test
        answer = ["error", str(error)]
    print(json.dumps(answer), flush=True)  # noqa: T201 - read by the test
