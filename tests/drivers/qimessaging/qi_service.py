"""A process of its own in which a `qi.Session` listens: the other end as NAOqi has it."""

# mypy: disallow-untyped-decorators=False

from __future__ import annotations

import sys
import time
from typing import Any

import qi


class Thing:
    """A service with a method for each thing that is to be seen on the wire."""

    def __init__(self) -> None:
        self.fired = qi.Signal("(sf)")
        self.level = qi.Property("i")

    @qi.bind(qi.String, [qi.String], "say")
    def say_one(self, text: str) -> str:
        return f"one {text}"

    @qi.bind(qi.String, [qi.String, qi.String], "say")
    def say_two(self, text: str, language: str) -> str:
        return f"two {text} {language}"

    @qi.bind(qi.String, [qi.Int32], "kind")
    def kind_of_number(self, _: int) -> str:
        return "number"

    @qi.bind(qi.String, [qi.String], "kind")
    def kind_of_text(self, _: str) -> str:
        return "text"

    @qi.bind(qi.String, [qi.List(qi.Float)], "kind")
    def kind_of_list(self, _: list[float]) -> str:
        return "list"

    @qi.bind(qi.List(qi.Float), [qi.List(qi.Float), qi.Float])
    def scaled(self, values: list[float], by: float) -> list[float]:
        return [each * by for each in values]

    @qi.bind(qi.Map(qi.String, qi.Int32), [qi.Map(qi.String, qi.Int32)])
    def counted(self, counts: dict[str, int]) -> dict[str, int]:
        return {name: count + 1 for name, count in counts.items()}

    @qi.bind(qi.Bool, [qi.Bool])
    def negated(self, value: bool) -> bool:
        return not value

    def echo(self, value: Any) -> Any:
        return value

    def fail(self) -> None:
        raise ValueError("the joint ZörgYaw does not exist")

    def slow(self, seconds: float) -> str:
        time.sleep(seconds)
        return "at last"

    def fire(self, text: str, number: float) -> None:
        self.fired(text, number)

    def child(self) -> Thing:
        return Thing()

    @qi.bind(qi.Dynamic, [qi.String, qi.Dynamic])
    def ask_back(self, service: str, value: Any) -> Any:
        return session.service(service).twice(value)


session = qi.Session()
session.listenStandalone("tcp://127.0.0.1:0")
thing = Thing()
session.registerService("Thing", thing)
print(session.endpoints()[0].rpartition(":")[2], flush=True)  # noqa: T201 - read by the test
sys.stdin.read()
