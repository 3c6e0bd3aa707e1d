"""A stand-in for a driver whose way to its hardware is a class: a maker's library, a client."""

from __future__ import annotations

import asyncio
import inspect
from collections.abc import Iterable
from types import TracebackType
from typing import Any


class MockTransport:
    """In the place of `driver.transport`, in a `with` block: it needs no wire.

    The driver names the class (`transport = ArmLibrary`) and makes an instance of it with
    `self.transport(...)`. What it calls is kept in `calls`; a method that the class does not have,
    or arguments that it does not take, are errors here, too. It moves from a call of one of `moves`
    (a coroutine lasts as long) until one of `halts`.

    Args:
        driver: The driver's class.
        moves: Methods that move something.
        halts: Methods that stop it.
        lost: What every call raises while the cable is out.

    Attributes:
        calls: Name and arguments by name of each call, the oldest first.
        answers: What methods return, by name; else None.
    """

    def __init__(
        self,
        driver: Any,
        *,
        moves: Iterable[str] = (),
        halts: Iterable[str] = (),
        lost: Exception | None = None,
    ) -> None:
        self._driver, self._of = driver, driver.transport
        self._moves, self._halts = frozenset(moves), frozenset(halts)
        self._lost = lost or ConnectionError("the cable is out")
        self._error: Exception | None = None
        self._out = False
        self._stands = asyncio.Event()
        self._stands.set()
        self.calls: list[tuple[str, dict[str, Any]]] = []
        self.answers: dict[str, object] = {}

    def __enter__(self) -> MockTransport:
        self._driver.transport = self
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._driver.transport = self._of

    # -- what a `Device` takes -------------------------------------------------------------------

    def unplug(self) -> None:
        """Pull the cable: whatever moves ends with `lost`."""
        self._out = True
        self._stands.set()

    def plug(self) -> None:
        """Put it back."""
        self._out = False

    def still(self) -> bool:
        """Whether nothing moves."""
        return self._stands.is_set()

    def fail(self, error: Exception | None = None) -> None:
        """Have the next call of a method that moves something raise an error."""
        self._error = error or RuntimeError("too hot")

    def received(self) -> dict[str, Any]:
        """The arguments of the last call of a method that moves something."""
        return next((args for name, args in reversed(self.calls) if name in self._moves), {})

    # -- what the driver calls -------------------------------------------------------------------

    def __call__(self, *args: Any, **more: Any) -> MockTransport:
        """An instance. Raises `lost` while the cable is out."""
        inspect.signature(self._of).bind(*args, **more)
        self._connected()
        return self

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._of, name)

        def called(*args: Any, **more: Any) -> object:
            bound = inspect.signature(method).bind(self, *args, **more)
            self._connected()
            self.calls.append((name, {key: bound.arguments[key] for key in [*bound.arguments][1:]}))
            if name in self._moves:
                if (error := self._error) is not None:
                    self._error = None
                    raise error
                self._stands.clear()
            if name in self._halts:
                self._stands.set()
            return self.answers.get(name)

        async def awaited(*args: Any, **more: Any) -> object:
            answer = called(*args, **more)
            if name in self._moves:
                await self._stands.wait()
                self._connected()
            return answer

        return awaited if inspect.iscoroutinefunction(method) else called

    def _connected(self) -> None:
        if self._out:
            raise self._lost
