"""A connection carried by the package `qi` (libqi).

libqi works in threads of its own; every answer is brought into the event loop by a callback, and
nothing here waits for a thread. A session is closed in a thread that nobody waits for, because
closing may wait for a robot that is frozen.
"""

from __future__ import annotations

import ast
import asyncio
import contextlib
import re
import threading
from collections.abc import Callable, Coroutine
from dataclasses import replace
from typing import Any, TypeVar

from woz_drivers.pepper.address import Address
from woz_drivers.pepper.link import Gone, Methods, Missing, Said, Unanswered, Unsubscribe
from woz_drivers.pepper.links_lookup import local_host_towards, resolved
from woz_drivers.pepper.links_socket import Sockets, elsewhere
from woz_drivers.pepper.links_trouble import hung_up, unknown, unreachable, words, wrong_password
from woz_drivers.pepper.qi_link_library import Login, library
from woz_drivers.pepper.secrets import Secret

#: The service that every NAOqi has, and its cheapest question.
_DIRECTORY = "ServiceDirectory"
_QUESTION = "machineId"
#: What libqi says when a line is gone, the robot's own or that of one service.
_DEAD = re.compile(r"session closed|socket (is )?(not connected|disconnected)|not connected", re.I)
_ABSENT = re.compile(r"cannot find service|not available|no such service", re.I)
_CONNECT_ERROR = re.compile(r"Connect error: (\d+): (.*)")
_DENIED = re.compile(r"authenti", re.I)
#: libqi ends the calls of a lost line a moment before it tells of the loss, in seconds.
_TELLS_WITHIN_S = 0.1
_T = TypeVar("_T")


async def open_qi_link(address: Address, secret: Secret, variable: str, within: float) -> QiLink:
    """Connect to `address`. Raises `core.driver.Lost`."""
    if ":" in address.host:
        raise unreachable(address, None, "the package qi knows no IPv6: set `client: own`")
    try:
        async with asyncio.timeout(within):
            peer = await resolved(address)
            link = QiLink(address, peer, secret)
            try:
                await link.begin()
            except BaseException:
                await link.close()
                raise
    except TimeoutError:
        raise unreachable(address, None, f"no answer of NAOqi within {within:g} s") from None
    except OSError:
        raise unknown(address) from None
    except Said as said:
        raise _not_opened(address, secret, variable, str(said)) from None
    except Gone as gone:
        raise unreachable(address, None, str(gone)) from None
    return link


def _not_opened(address: Address, secret: Secret, variable: str, text: str) -> Exception:
    text = secret.hidden_in(text)
    if _DENIED.search(text):
        return wrong_password(address, variable, bool(secret))
    if text == "disconnected":
        return hung_up(address, variable)
    found = _CONNECT_ERROR.search(text)
    if found is None:
        return unreachable(address, None, text)
    # Numbers of other kinds than errno come with a text that `unreachable` knows.
    number = None if "not found" in found[2].lower() else int(found[1])
    return unreachable(address, number, found[2])


class QiLink:
    """One session of libqi."""

    certificate = ""

    def __init__(self, address: Address, peer: tuple[str, int], secret: Secret) -> None:
        self._loop = asyncio.get_running_loop()
        self._url = replace(address, host=peer[0]).url
        self._sockets = Sockets(peer)
        self.client = f"qi {library().__version__}"
        self.local_host = local_host_towards(*peer)
        self.lost: asyncio.Future[str] = self._loop.create_future()
        self._open: set[asyncio.Future[Any]] = set()
        self._services: dict[str, asyncio.Task[Any]] = {}
        self._session: Any = library().Session()
        self._begun = False
        if address.secure:
            self._session.setClientAuthenticatorFactory(Login(address.user, secret.reveal()))

    async def begin(self) -> None:
        """Connect. Raises `Said` with libqi's words."""
        await self._answer(self._session.connect(self._url, _async=True))
        # Not before: a refused login is told as a loss first, and as what it is afterwards.
        self._session.disconnected.connect(self._from_thread(self._is_lost))
        if not self._session.isConnected():
            self._is_lost("disconnected")
        self._sockets.keep_nothing_unsent()
        self._begun = True

    async def call(self, service: str, method: str, *args: Any, within: float) -> Any:
        """Call a method; see `Link.call`."""
        return await self._in_time(self._call(service, method, args), within, f"{service}.{method}")

    async def ask(self, within: float) -> None:
        """Ask what costs the robot nothing; see `Link.ask`."""
        await self.call(_DIRECTORY, _QUESTION, within=within)

    async def services(self, within: float) -> frozenset[str]:
        """Names of all services; see `Link.services`."""
        infos = await self.call(_DIRECTORY, "services", within=within)
        places = {_member(info, "name", 0): _place(info) for info in infos}
        directory = places.get(_DIRECTORY, (0, ()))[0]
        self._sockets.expect(elsewhere(places.values(), directory))
        return frozenset(places)

    async def listen(self, service: str, signal: str, heard: Callable[..., None]) -> Unsubscribe:
        """Hear a signal; see `Link.listen`. Not answered within 2 s: raises `Unanswered`."""
        within = 2.0
        name = f"{service}.{signal}"
        emitter = await self._in_time(self._signal(service, signal), within, name)
        number = await self._in_time(
            self._answer(emitter.connect(self._from_thread(heard), _async=True)), within, name
        )

        async def unsubscribe() -> None:
            with contextlib.suppress(Said, Gone, Unanswered):
                await self._in_time(
                    self._answer(emitter.disconnect(number, _async=True)), within, name
                )

        return unsubscribe

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        """Offer a service; see `Link.serve`. Not answered within 2 s: raises `Unanswered`."""
        within = 2.0
        members = {one: self._method(one, takes, run) for one, (takes, run) in methods.items()}
        # libqi looks at classes for methods, and keeps the object itself alive.
        made = type(name, (), {"__qi_threading__": "multi", **members})()
        number = await self._in_time(self._register(name, made), within, name)

        async def withdraw() -> None:
            if self._session is None:
                return
            with contextlib.suppress(Said, Gone, Unanswered):
                ending = self._session.unregisterService(number, _async=True)
                await self._in_time(self._answer(ending), within, name)

        return withdraw

    async def close(self) -> None:
        """Let go of the session, in a thread of its own."""
        self._is_lost("closed")
        session, self._session = self._session, None
        services, self._services = self._services, {}
        if session is None:
            return
        await asyncio.gather(*services.values(), return_exceptions=True)
        ended = [task.result() for task in services.values() if _worked(task)]
        if self._begun:
            # Before that nothing was sent but a greeting; and a robot that has not accepted the
            # connection yet, since it is frozen, would never accept any again (libqi 3.1.5).
            self._sockets.throw_away_unsent()
        threading.Thread(target=_end, args=(session, ended), name="qi close", daemon=True).start()

    # -- in the event loop ---------------------------------------------------------------------

    async def _call(self, service: str, method: str, args: tuple[Any, ...]) -> Any:
        proxy = await self._proxy(service)
        try:
            future = proxy.call(method, *args, _async=True)
        except (RuntimeError, TypeError, ValueError) as error:
            raise Said(f"{service}.{method}: {words(str(error))}") from None
        try:
            return _plain(await self._answer(future))
        except Said as said:
            raise await self._judged(service, f"{service}.{method}", str(said)) from None

    async def _register(self, name: str, made: Any) -> Any:
        """Make a service known, after listening where the robot reaches this machine."""
        if self._session is None or self.lost.done():
            raise self._gone()
        if not self._session.endpoints():
            listening = self._session.listen(f"tcp://{self.local_host}:0", _async=True)
            await self._answer(listening)
        return await self._answer(self._session.registerService(name, made, _async=True))

    def _method(self, name: str, takes: str, run: Callable[..., None]) -> Callable[..., None]:
        come = self._from_thread(run)

        def entered(_self: Any, *values: Any) -> None:
            come(*values)

        vars(entered).update(__qi_name__=name, __qi_signature__=takes, __qi_return_signature__="v")
        return entered

    async def _signal(self, service: str, signal: str) -> Any:
        emitter = getattr(await self._proxy(service), signal, None)
        if emitter is None or not hasattr(emitter, "disconnect"):
            raise Said(f"{service} has no signal {signal}")
        return emitter

    async def _proxy(self, service: str) -> Any:
        """The service, looked up once; several may wait for one look-up."""
        if self._session is None or self.lost.done():
            raise self._gone()
        looking = self._services.get(service)
        if looking is None or (looking.done() and not _worked(looking)):
            looking = self._loop.create_task(self._look_up(service))
            looking.add_done_callback(_worked)
            self._services[service] = looking
        return await asyncio.shield(looking)

    async def _look_up(self, service: str) -> Any:
        try:
            proxy = await self._answer(self._session.service(service, _async=True))
        except Said as said:
            raise await self._judged(service, service, str(said)) from None
        self._sockets.keep_nothing_unsent()
        return proxy

    async def _judged(self, service: str, what: str, text: str) -> Exception:
        """What libqi's words mean for a call or a look-up."""
        if _DEAD.search(text):
            await asyncio.wait([self.lost], timeout=_TELLS_WITHIN_S)
        if self.lost.done():
            return self._gone()
        if _ABSENT.search(text):
            return Missing(f"the robot has no service {service} now")
        if _DEAD.search(text):
            # One process of the robot has ended, its other services go on: look it up anew.
            self._services.pop(service, None)
            return Missing(f"{service} has just ended on the robot")
        return Said(f"{what}: {words(text)}")

    async def _in_time(self, doing: Coroutine[Any, Any, _T], within: float, what: str) -> _T:
        try:
            async with asyncio.timeout(within):
                return await doing
        except TimeoutError:
            raise Unanswered(f"no answer to {what} within {within:g} s") from None

    async def _answer(self, future: Any) -> Any:
        """The value of a future of libqi. Raises `Said` with its error, or `Gone`."""
        if self.lost.done():
            raise self._gone()
        mine: asyncio.Future[Any] = self._loop.create_future()
        self._open.add(mine)
        future.addCallback(self._from_thread(lambda done: _settle(mine, done)))
        try:
            return await mine
        except asyncio.CancelledError:
            future.cancel()
            raise
        finally:
            self._open.discard(mine)

    def _is_lost(self, reason: str) -> None:
        if self.lost.done():
            return
        self.lost.set_result(reason)
        for mine in tuple(self._open):
            if not mine.done():
                mine.set_exception(self._gone())

    def _gone(self) -> Gone:
        return Gone(self.lost.result() if self.lost.done() else "closed")

    # -- in threads of libqi -------------------------------------------------------------------

    def _from_thread(self, then: Callable[..., None]) -> Callable[..., None]:
        loop = self._loop

        def come(*values: Any) -> None:
            with contextlib.suppress(RuntimeError):  # the loop has been closed meanwhile
                loop.call_soon_threadsafe(then, *values)

        return come


def _settle(mine: asyncio.Future[Any], done: Any) -> None:
    if mine.done():
        return
    try:
        if done.isCanceled():
            mine.set_exception(Said("cancelled by the robot"))
        elif done.hasError(0):
            mine.set_exception(Said(done.error(0)))
        else:
            mine.set_result(done.value(0))
    except Exception as error:  # noqa: BLE001 - texts of the robot that are none, and whatever else
        mine.set_exception(Said(f"its answer cannot be read: {error}"))


def _worked(task: asyncio.Task[Any]) -> bool:
    """Whether it ended well; fetches its error, so that nobody complains of it."""
    return task.done() and not task.cancelled() and task.exception() is None


def _end(session: Any, services: list[Any]) -> None:
    """Close a session; in its own thread, which may wait for a frozen robot for ever."""
    with contextlib.suppress(RuntimeError):
        session.close(_async=True)
    services.clear()
    del session


def _place(info: Any) -> tuple[int, list[str]]:
    """Process and endpoints of a service."""
    return _member(info, "processId", 3), _member(info, "endpoints", 4)


def _member(info: Any, name: str, place: int) -> Any:
    """Of a struct: its members have names only where the other end tells them."""
    return info[name] if isinstance(info, dict) else info[place]


def _plain(value: Any) -> Any:
    """Bytes as bytes: libqi gives a text that is not UTF-8 as its listing in Python, "b'...'"."""
    match value:
        case bytearray():
            return bytes(value)
        case str() if value.startswith(("b'", 'b"')):
            return _listed(value)
        case list():
            return [_plain(one) for one in value]
        case tuple():
            return tuple(_plain(one) for one in value)
        case dict():
            return {_plain(key): _plain(one) for key, one in value.items()}
        case _:
            return value


def _listed(text: str) -> str | bytes:
    with contextlib.suppress(ValueError, SyntaxError, MemoryError, RecursionError):
        found = ast.literal_eval(text)
        if isinstance(found, bytes):
            with contextlib.suppress(UnicodeDecodeError):
                found.decode()
                return text  # somebody did write b'...': it is valid as text
            return found
    return text
