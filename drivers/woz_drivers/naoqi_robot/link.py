"""One connection to one NAOqi, by `qimessaging`, with its errors in words for the wizard."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import hashlib
import ipaddress
import os
import re
import socket
import ssl
import struct
import sys
from collections.abc import Awaitable, Callable, Mapping
from typing import Any, TypeVar

from qimessaging import errors
from qimessaging.client import NaoqiClient
from qimessaging.hosted_objects import HostedMethod, HostedObject

from woz_drivers.naoqi_robot.address import Address
from woz_drivers.naoqi_robot.settings import NaoqiSettings
from woz_tui.drivers.background import apart
from woz_tui.drivers.contract import DeviceLostError

_HIDDEN = "***"


class Secret:
    """A password that no log and no error text shows by mistake."""

    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def reveal(self) -> str:
        """The password itself, for the wire alone."""
        return self._text

    def hidden_in(self, text: str) -> str:
        """`text` without the password, for what a robot or a library says."""
        return text.replace(self._text, _HIDDEN) if self._text else text

    def __bool__(self) -> bool:
        return bool(self._text)

    def __repr__(self) -> str:
        return "Secret(***)" if self._text else "Secret()"

    __str__ = __repr__


def password(variable: str) -> Secret:
    """What the environment variable holds; empty if it is not set."""
    return Secret(os.environ.get(variable, "") if variable else "")


#: An attempt is given up after so long, in seconds: short enough to meet a robot that has just come
#: back, long enough for a slow one and a line that has to be secured.
OPENS_WITHIN_S = 3.0
#: Bytes that the robot's side has not confirmed for so long are given up, in milliseconds: less
#: than what it takes the wizard to be told, and more than a bad wireless link needs.
UNCONFIRMED_MS = 1500
_DIRECTORY = "ServiceDirectory"
_QUESTION = "machineId"
_ABSENT = re.compile(r"cannot find service|no such service", re.I)
#: A signal is subscribed within this time, in seconds.
_LISTENS_WITHIN_S = 2.0
#: The library's own limits lie beyond ours: when ours is reached, the call is cancelled.
_BEYOND_S = 1.0
_TELLS_WITHIN_S = 0.1
#: Reasons that mean: nobody is there.
_NOBODY = frozenset({errno.EHOSTUNREACH, errno.ENETUNREACH, errno.EHOSTDOWN, errno.ETIMEDOUT})
#: Nobody reads more of what a robot says, in characters.
_READABLE = 300
#: SO_LINGER: on, for 0 s.
_AT_ONCE = struct.pack("ii", 1, 0)
_T = TypeVar("_T")


class LinkError(Exception):
    """A call did not work; the text says why, as the robot or the line says it."""


class RobotRefusedError(LinkError):
    """The robot said no: the method raised, does not exist, or does not take these arguments."""


class ServiceMissingError(RobotRefusedError):
    """The robot has no such service now; after a start they come up one after the other."""


class UnansweredError(LinkError):
    """No answer came in time. The robot may still carry the call out."""


class LinkClosedError(LinkError):
    """The connection is lost; nothing else will come through this link."""


#: Takes back what was subscribed.
Unsubscribe = Callable[[], Awaitable[None]]
#: A service of ours: by the method's name the signature of its parameters, `(iimr)`, and what the
#: robot calls.
Methods = Mapping[str, tuple[str, Callable[..., None]]]


class ConnectionRefusedByRobotError(DeviceLostError):
    """The robot is there, but will not have us, or is not the one we trust: trying again is of no
    use until somebody changes something.
    """


async def open_link(
    address: Address, settings: NaoqiSettings, within: float = OPENS_WITHIN_S
) -> NaoqiLink:
    """Connect. Raises `DeviceLostError`, or `ConnectionRefusedByRobotError` where trying again is
    of no use.

    Args:
        address: A real one; for the simulated robot where that listens.
        settings: Whose password, which certificate.
        within: Seconds for the whole attempt.
    """
    secret = password(settings.password)
    watch = CertificateWatch(settings.trusted)
    try:
        async with asyncio.timeout(within):
            client = await NaoqiClient.open(
                *await resolved(address),
                tls=watch.context if address.secure else None,
                user=address.user,
                token=secret.reveal() if address.secure else "",
                timeout=within + _BEYOND_S,
                prepare=_keep_nothing_unsent,
            )
    except TimeoutError:
        raise unreachable(address, None, f"no answer of NAOqi within {within:g} s") from None
    except socket.gaierror:
        raise unknown_host(address) from None
    except errors.LoginError:
        raise wrong_password(address, settings.password, bool(secret)) from None
    except errors.QiError as error:
        if watch.refused:
            raise wrong_certificate(address, watch.fingerprint) from None
        cause = error.__cause__
        number = cause.errno if isinstance(cause, OSError) else None
        raise unreachable(address, number, secret.hidden_in(str(error))) from None
    return NaoqiLink(client, watch.fingerprint)


def _keep_nothing_unsent(connected: socket.socket) -> None:
    """Give up what is not confirmed after a while, and everything on closing.

    The system goes on sending what it has for minutes after a connection was given up: a robot
    whose cable is plugged in again would carry out what its wizard was told had failed. (Not before
    the robot has answered: one that is reset before it accepted us, libqi 3.1.5, accepts nobody any
    more.)
    """
    with contextlib.suppress(OSError):  # the robot has just hung up
        connected.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, _AT_ONCE)
        if sys.platform == "linux":
            connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNCONFIRMED_MS)


class CertificateWatch:
    """Looks at the robot's certificate before anything, such as a password, is sent.

    Robots sign their certificates themselves, so there is no authority to ask.
    """

    def __init__(self, trusted: str) -> None:
        self._trusted = trusted.replace(":", "").strip().lower()
        self.fingerprint = ""
        self.refused = False
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        self.context.check_hostname = False
        self.context.verify_mode = ssl.CERT_NONE
        self.context.sslobject_class = self._watching()

    def _watching(self) -> type[ssl.SSLObject]:
        check = self._check_certificate

        class Watched(ssl.SSLObject):
            def do_handshake(self) -> None:
                super().do_handshake()
                check(self.getpeercert(binary_form=True) or b"")

        return Watched

    def _check_certificate(self, certificate: bytes) -> None:
        self.fingerprint = hashlib.sha256(certificate).hexdigest()
        self.refused = bool(self._trusted) and self.fingerprint != self._trusted
        if self.refused:
            refusal = ssl.SSLError("another certificate than the trusted one")
            refusal.reason = str(refusal)
            raise refusal


class NaoqiLink:
    """One connection. All of it belongs to the event loop in which it was opened.

    Attributes:
        lost: Done when the connection is lost or closed, with the reason in words.
        certificate: SHA-256 of the robot's certificate in hexadecimal; empty where the line is not
            secured.
        local_host: The address of this machine on the line to the robot: what the robot can reach.
    """

    def __init__(self, client: NaoqiClient, certificate: str) -> None:
        self._client = client
        self.certificate = certificate
        self.local_host = client.local_host
        self.lost = client.lost

    async def call(self, service: str, method: str, *args: Any, within: float) -> Any:
        """Call `service.method(*args)` and return its value.

        Arguments and values are bool, int, float, str, bytes, list, tuple, dict and None (for a
        picture or a sound use `binary(value)`); the overload is chosen by name, number and types of
        the arguments. Services are looked up once a link. Raises `RobotRefusedError`
        (`ServiceMissingError` where there is no such service), `UnansweredError` after `within`
        seconds, or `LinkClosedError`. A cancelled call is cancelled on the robot, too, where it
        lets itself be.
        """
        beyond = within + _BEYOND_S
        calling = self._client.call(service, method, *args, within=beyond)
        return await self._in_time(calling, within, service, f"{service}.{method}")

    async def ask(self, within: float) -> None:
        """Return when the robot has answered a cheap question over the line. Raises as `call`."""
        await self.call(_DIRECTORY, _QUESTION, within=within)

    async def services(self, within: float) -> frozenset[str]:
        """Names of the services that the robot has now. Raises as `call`."""
        infos = await self._in_time(self._client.services(), within, _DIRECTORY, "services")
        return frozenset(info.name for info in infos)

    async def listen(self, service: str, signal: str, heard: Callable[..., None]) -> Unsubscribe:
        """Call `heard(*values)` in the loop whenever the signal is emitted. Raises as `call`."""
        what = f"{service}.{signal}"
        within = _LISTENS_WITHIN_S
        subscribing = self._client.listen(service, signal, heard, within + _BEYOND_S)
        taking_back = await self._in_time(subscribing, within, service, what)

        async def unsubscribe() -> None:
            try:
                await self._in_time(taking_back(), within, service, what)
            except LinkError:
                return  # nothing is heard any more, whatever the robot thinks

        return unsubscribe

    async def serve(self, name: str, methods: Methods) -> Unsubscribe:
        """Offer the robot a service of ours under `name` until the result is called, or the line
        is lost: its functions are called in the loop, and what they return is not sent.

        Raises as `call`; `RobotRefusedError` if the name is taken, or the robot takes no service
        from here.
        """
        hosted = HostedObject(
            HostedMethod(method_name, takes, "v", run)
            for method_name, (takes, run) in methods.items()
        )
        registering = self._client.register(name, hosted)
        served = await self._in_time(registering, _LISTENS_WITHIN_S, _DIRECTORY, name)
        return served.withdraw

    async def close(self) -> None:
        """Let go. Never raises, never waits for the robot.

        Calls under way end with `LinkClosedError`. What the system has not yet brought to the robot
        is thrown away, so that it does not arrive when a cut cable is plugged in again.
        """
        await self._client.close()

    async def _in_time(self, doing: Awaitable[_T], within: float, service: str, what: str) -> _T:
        """The result, with the library's errors as those of a link."""
        try:
            async with asyncio.timeout(within):
                return await doing
        except (TimeoutError, errors.CallTimeoutError):
            raise UnansweredError(f"no answer to {what} within {within:g} s") from None
        except errors.ConnectionLostError as error:
            raise LinkClosedError(str(error)) from None
        except errors.ServiceLostError:
            # With the whole line gone, the library may tell of the service a moment earlier.
            await asyncio.wait([self.lost], timeout=_TELLS_WITHIN_S)
            if self.lost.done():
                raise LinkClosedError(self.lost.result()) from None
            raise ServiceMissingError(f"{service} has just ended on the robot") from None
        except errors.ProtocolError as error:
            raise RobotRefusedError(
                f"{what}: its answer cannot be read: {readable(str(error))}"
            ) from None
        except errors.QiError as error:
            if _ABSENT.search(str(error)):
                raise ServiceMissingError(f"the robot has no service {service} now") from None
            raise RobotRefusedError(f"{what}: {readable(str(error))}") from None


async def resolved(address: Address) -> tuple[str, int]:
    """IP address and port of the robot, IPv4 before IPv6. Raises `OSError` (`socket.gaierror`).

    Names are looked up in a thread of its own, which keeps nobody from ending: a look-up without a
    network takes half a minute.
    """
    with contextlib.suppress(ValueError):
        return str(ipaddress.ip_address(address.host)), address.port
    try:
        infos = await apart(
            lambda: socket.getaddrinfo(address.host, address.port, type=socket.SOCK_STREAM)
        )
    except UnicodeError:  # a part of it is longer than a name may be
        raise socket.gaierror(socket.EAI_NONAME, "not known") from None
    first = min(infos, key=lambda info: info[0] != socket.AF_INET)
    return str(first[4][0]), int(first[4][1])


def binary(value: Any) -> bytes:
    """A picture or a sound as bytes. A robot may send it as text.

    Raises `RobotRefusedError` if it is neither bytes nor text.
    """
    if isinstance(value, (bytes, bytearray)):
        return bytes(value)
    if isinstance(value, str):
        return value.encode()
    raise RobotRefusedError(f"bytes were expected, but the robot gave {type(value).__name__}")


def readable(text: str) -> str:
    """What a robot says of an error, in one line, without the listing of its program."""
    line = " ".join(text.partition("\n\nAt:")[0][: 4 * _READABLE].split())
    shown = "".join(sign if sign.isprintable() else "�" for sign in line)
    return shown if len(shown) <= _READABLE else f"{shown[:_READABLE]}…"


def unreachable(address: Address, number: int | None, text: str) -> DeviceLostError:
    """The system said no: `number` is its errno where known, `text` its words."""
    where = address.shown
    if number == errno.ECONNREFUSED:
        return DeviceLostError(
            f"{where} is there, but nothing listens on port {address.port}",
            "wait until NAOqi has started; NAOqi 2.9 and newer is tcps://nao@HOST:9503",
        )
    if number in _NOBODY:
        remedy = "is the robot on, and is this machine in its network?"
        return DeviceLostError(f"{where} does not answer", remedy)
    reason = readable(text) or (os.strerror(number) if number else "no reason given")
    return DeviceLostError(
        f"{where} cannot be reached: {reason}", "check its power and the network"
    )


def unknown_host(address: Address) -> DeviceLostError:
    """No host has this name."""
    return DeviceLostError(
        f"no host is called {address.shown}",
        "press the robot's chest button: it says its IP address; give that",
    )


def wrong_password(
    address: Address, variable: str, has_password: bool
) -> ConnectionRefusedByRobotError:
    """The robot does not take user and password."""
    if not has_password:
        return ConnectionRefusedByRobotError(
            f"{address.shown} wants a password for the user {address.user or 'nao'}",
            f"set the environment variable {variable} before `woz` is started, and write the"
            " address as tcps://USER@HOST",
        )
    return ConnectionRefusedByRobotError(
        f"{address.shown} refused the password of the user {address.user}",
        f"correct {variable} and start again, or give another user: tcps://USER@HOST",
    )


def wrong_certificate(address: Address, fingerprint: str) -> ConnectionRefusedByRobotError:
    """Another certificate than the trusted one."""
    return ConnectionRefusedByRobotError(
        f"{address.shown} shows another certificate than `trusted` says",
        f"is it the right robot? if so, set `trusted: {fingerprint}`",
    )
