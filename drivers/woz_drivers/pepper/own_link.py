"""A connection carried by our own client, `qimessaging`: wherever Python runs."""

from __future__ import annotations

import asyncio
import hashlib
import re
import socket
import ssl
from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

from qimessaging import errors
from qimessaging.client import Client
from qimessaging.hosting import Hosted, Method

from woz_drivers.pepper.address import Address
from woz_drivers.pepper.link import Gone, LinkError, Methods, Missing, Said, Unanswered, Unsubscribe
from woz_drivers.pepper.links_lookup import resolved
from woz_drivers.pepper.links_socket import Sockets, elsewhere
from woz_drivers.pepper.links_trouble import (
    unknown,
    unreachable,
    words,
    wrong_certificate,
    wrong_password,
)
from woz_drivers.pepper.secrets import Secret
from woz_tui.core.driver import Lost

_DIRECTORY = "ServiceDirectory"
_QUESTION = "machineId"
_ABSENT = re.compile(r"cannot find service|no such service", re.I)
#: A signal is subscribed within this time, in seconds.
_LISTENS_WITHIN_S = 2.0
#: The library's own limits lie beyond ours: when ours is reached, the call is cancelled.
_BEYOND_S = 1.0
_TELLS_WITHIN_S = 0.1
_T = TypeVar("_T")


async def open_own_link(
    address: Address, secret: Secret, variable: str, trusted: str, *, within: float
) -> OwnLink:
    """Connect to `address`. Raises `core.driver.Lost`.

    Args:
        address: A real one.
        secret: The password, used on a secured line alone.
        variable: Where it is from, for errors.
        trusted: SHA-256 of the certificate to accept, in hexadecimal; empty: any.
        within: Seconds for the whole attempt.
    """
    watch = CertificateWatch(trusted)
    try:
        async with asyncio.timeout(within):
            peer = await resolved(address)
            sockets = Sockets(peer)
            client = await Client.open(
                *peer,
                tls=watch.context if address.secure else None,
                user=address.user,
                token=secret.reveal() if address.secure else "",
                timeout=within + _BEYOND_S,
            )
    except TimeoutError:
        raise unreachable(address, None, f"no answer of NAOqi within {within:g} s") from None
    except socket.gaierror:
        raise unknown(address) from None
    except errors.LoginError:
        raise wrong_password(address, variable, bool(secret)) from None
    except errors.QiError as error:
        if watch.refused:
            raise wrong_certificate(address, watch.found) from None
        raise _not_opened(address, error, secret) from None
    return OwnLink(client, sockets, watch.found)


def _not_opened(address: Address, error: errors.QiError, secret: Secret) -> Lost:
    cause = error.__cause__
    number = cause.errno if isinstance(cause, OSError) else None
    return unreachable(address, number, secret.hidden_in(str(error)))


class CertificateWatch:
    """Looks at the robot's certificate before anything, such as a password, is sent.

    Robots sign their certificates themselves, so there is no authority to ask.
    """

    def __init__(self, trusted: str) -> None:
        self._trusted = trusted.replace(":", "").strip().lower()
        self.found = ""
        self.refused = False
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        self.context.check_hostname = False
        self.context.verify_mode = ssl.CERT_NONE
        self.context.sslobject_class = self._watching()

    def _watching(self) -> type[ssl.SSLObject]:
        look = self._look

        class Watched(ssl.SSLObject):
            def do_handshake(self) -> None:
                super().do_handshake()
                look(self.getpeercert(binary_form=True) or b"")

        return Watched

    def _look(self, certificate: bytes) -> None:
        self.found = hashlib.sha256(certificate).hexdigest()
        self.refused = bool(self._trusted) and self.found != self._trusted
        if self.refused:
            refusal = ssl.SSLError("another certificate than the trusted one")
            refusal.reason = str(refusal)
            raise refusal


class OwnLink:
    """One client of our own."""

    client = "own"

    def __init__(self, client: Client, sockets: Sockets, certificate: str) -> None:
        self._client = client
        self._sockets = sockets
        self.certificate = certificate
        self.local_host = client.local_host
        self.lost = client.lost
        sockets.keep_nothing_unsent()

    async def call(self, service: str, method: str, *args: Any, within: float) -> Any:
        """Call a method; see `Link.call`."""
        beyond = within + _BEYOND_S
        calling = self._client.call(service, method, *args, within=beyond)
        return await self._in_time(calling, within, service, f"{service}.{method}")

    async def ask(self, within: float) -> None:
        """Ask what costs the robot nothing; see `Link.ask`."""
        await self.call(_DIRECTORY, _QUESTION, within=within)

    async def services(self, within: float) -> frozenset[str]:
        """Names of all services; see `Link.services`."""
        infos = await self._in_time(self._client.services(), within, _DIRECTORY, "services")
        places = {info.name: (info.process, info.endpoints) for info in infos}
        directory = places.get(_DIRECTORY, (0, ()))[0]
        self._sockets.expect(elsewhere(places.values(), directory))
        return frozenset(places)

    async def listen(self, service: str, signal: str, heard: Callable[..., None]) -> Unsubscribe:
        """Hear a signal; see `Link.listen`. Not answered within 2 s: raises `Unanswered`."""
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
        """Offer a service; see `Link.serve`. Not answered within 2 s: raises `Unanswered`."""
        hosted = Hosted(Method(one, takes, "v", run) for one, (takes, run) in methods.items())
        registering = self._client.register(name, hosted)
        served = await self._in_time(registering, _LISTENS_WITHIN_S, _DIRECTORY, name)
        return served.withdraw

    async def close(self) -> None:
        """Let go; see `Link.close`."""
        self._sockets.throw_away_unsent()
        await self._client.close()

    async def _in_time(self, doing: Awaitable[_T], within: float, service: str, what: str) -> _T:
        """The result, with the library's errors as those of a link."""
        try:
            async with asyncio.timeout(within):
                return await doing
        except (TimeoutError, errors.TimedOut):
            raise Unanswered(f"no answer to {what} within {within:g} s") from None
        except errors.ConnectionLost as error:
            raise Gone(str(error)) from None
        except errors.ServiceLost:
            # With the whole line gone, the library may tell of the service a moment earlier.
            await asyncio.wait([self.lost], timeout=_TELLS_WITHIN_S)
            if self.lost.done():
                raise Gone(self.lost.result()) from None
            raise Missing(f"{service} has just ended on the robot") from None
        except errors.ProtocolError as error:
            raise Said(f"{what}: its answer cannot be read: {words(str(error))}") from None
        except errors.QiError as error:
            if _ABSENT.search(str(error)):
                raise Missing(f"the robot has no service {service} now") from None
            raise Said(f"{what}: {words(str(error))}") from None
