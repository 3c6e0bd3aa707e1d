"""The line between a session and the computers of its drivers, over Eclipse Zenoh.

The session's side is a router for each computer of its drivers, behind the port that they see
(`front_port`). A driver's computer is a client of it.

This is the only module that imports zenoh, and only when a line is opened: its threads live in the
process from then on.
"""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import socket
import ssl
import threading
from collections import deque
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from woz_tui.network.certificates import SERVER_NAME, AccessError, AccessFile
from woz_tui.network.driver_line import (
    A_TURN,
    CAPACITY,
    SILENCE_S,
    DriverLine,
    EndSubscription,
    LineError,
    Presence,
    Receive,
)
from woz_tui.network.driver_messages import MOST_BYTES
from woz_tui.network.listen_address import ListenAddress
from woz_tui.system.extras import install_command

if TYPE_CHECKING:
    import zenoh

#: How long a connection may take, in seconds.
CONNECT_S = 3.0
#: So long after the handshake the session may say that it does not want a certificate, in seconds.
REFUSAL_S = 0.3
#: A frame waits so long for room in the line, in microseconds; then it is dropped.
_WAIT_US = 50_000
#: All of zenoh's, each of which has a queue.
_PRIORITIES = (
    *("control", "real_time", "interactive_high", "interactive_low"),
    *("data_high", "data", "data_low", "background"),
)
#: What cannot be done without the extra.
MISSING = "drivers on another computer need the package `eclipse-zenoh`"
MISSING_REMEDY = install_command("remote-drivers")


def _module() -> Any:
    try:
        import zenoh  # noqa: PLC0415 - its threads begin with the first session
    except ImportError:
        raise LineError(MISSING, MISSING_REMEDY) from None
    return zenoh


class FrameInbox:
    """Frames on their way from the line's thread into the event loop: bounded, some at a time.

    Args:
        receive: Called in the loop with each frame.
    """

    def __init__(self, receive: Receive) -> None:
        self._receive = receive
        self._loop = asyncio.get_running_loop()
        self._waiting: deque[bytes] = deque()
        self._bytes = 0
        self._due = False
        self._lock = threading.Lock()

    def put(self, frame: bytes) -> None:
        """Keep it until the loop takes it; one too many or too long is dropped. From any thread."""
        with self._lock:
            full = len(self._waiting) >= CAPACITY or self._bytes + len(frame) > 4 * MOST_BYTES
            if full or len(frame) > MOST_BYTES:
                return
            self._waiting.append(frame)
            self._bytes += len(frame)
            due, self._due = self._due, True
        if not due:
            with contextlib.suppress(RuntimeError):  # closed: the session is over
                self._loop.call_soon_threadsafe(self._deliver)

    def _deliver(self) -> None:
        with self._lock:
            frames = [self._waiting.popleft() for _ in range(min(len(self._waiting), A_TURN))]
            self._bytes -= sum(map(len, frames))
            self._due = bool(self._waiting)
        if self._due:
            self._loop.call_soon(self._deliver)
        for frame in frames:
            self._receive(frame)


class ZenohLine(DriverLine):
    """One open session of zenoh, with threads of its own that send: urgent things first, bulky ones
    beside the others.
    """

    def __init__(self, session: zenoh.Session) -> None:
        self._zenoh = _module()
        self._session = session
        self._waiting: deque[tuple[str, bytes]] = deque()
        self._urgent: deque[tuple[str, bytes]] = deque()
        #: The newest of each key.
        self._bulky: dict[str, bytes] = {}
        self._some = threading.Condition()
        self._open = True
        self._held: list[Any] = []
        self._threads = [
            threading.Thread(target=work, name="driver line", daemon=True)
            for work in (self._send_frames, self._send_bulky)
        ]
        for thread in self._threads:
            thread.start()

    def send(self, key: str, payload: bytes, *, urgent: bool = False) -> bool:
        """Have it sent and return at once; whether there was room, which there always is for what
        is urgent. From any thread.
        """
        with self._some:
            if not self._open or (not urgent and len(self._waiting) >= CAPACITY):
                return False
            (self._urgent if urgent else self._waiting).append((key, payload))
            self._some.notify_all()
        return True

    def send_bulky(self, key: str, payload: bytes) -> None:
        """The same for what may be lost and is long. The next one under its key replaces it."""
        with self._some:
            self._bulky[key] = payload
            self._some.notify_all()

    def receive(self, key: str, receive: Receive) -> EndSubscription:
        """Hand over in the running event loop what comes under this key."""
        inbox = FrameInbox(receive)
        subscriber = self._session.declare_subscriber(
            key, lambda sample: inbox.put(sample.payload.to_bytes())
        )
        self._held.append(subscriber)
        return lambda: self._end(subscriber)

    def show_presence(self, key: str) -> None:
        """Let the others notice when this process goes."""
        self._held.append(self._session.liveliness().declare_token(key))

    def watch_presence(self, key: str, presence: Presence) -> EndSubscription:
        """Hear of everybody who comes and goes."""
        put = self._zenoh.SampleKind.PUT
        subscriber = self._session.liveliness().declare_subscriber(
            key, lambda sample: presence(sample.kind == put), history=True
        )
        self._held.append(subscriber)
        return lambda: self._end(subscriber)

    def _end(self, subscriber: zenoh.Subscriber[None]) -> None:
        self._held.remove(subscriber)
        with contextlib.suppress(self._zenoh.ZError):
            subscriber.undeclare()  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """End it; may wait for a moment, so call it in a thread."""
        with self._some:
            self._open = False
            self._bulky.clear()
            self._some.notify_all()
        for thread in self._threads:
            thread.join(SILENCE_S)  # what was sent last goes out first
        with contextlib.suppress(self._zenoh.ZError):
            self._session.close()  # type: ignore[no-untyped-call]

    def _send_frames(self) -> None:
        priority = self._zenoh.Priority
        while True:
            with self._some:
                while self._open and not self._urgent and not self._waiting:
                    self._some.wait()
                if not self._urgent and not self._waiting:
                    return
                urgent = bool(self._urgent)
                key, payload = (self._urgent if urgent else self._waiting).popleft()
            self._put(key, payload, priority.REAL_TIME if urgent else priority.DATA)

    def _send_bulky(self) -> None:
        while True:
            with self._some:
                while self._open and not self._bulky:
                    self._some.wait()
                if not self._bulky:
                    return
                key, payload = self._bulky.popitem()
            self._put(key, payload, self._zenoh.Priority.BACKGROUND)

    def _put(self, key: str, payload: bytes, priority: zenoh.Priority) -> None:
        drop = self._zenoh.CongestionControl.DROP
        with contextlib.suppress(self._zenoh.ZError):  # closed meanwhile
            self._session.put(
                key, payload, congestion_control=drop, priority=priority, express=True
            )


# -- opening ---------------------------------------------------------------------------------------


def _open(settings: Mapping[str, Any], silence_s: float) -> ZenohLine:
    """Raises `zenoh.ZError`, `LineError`."""
    zenoh = _module()
    config = zenoh.Config()
    common: dict[str, Any] = {
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "scouting/delay": 0,
        "transport/link/tx/lease": round(silence_s * 1000),
        "transport/link/rx/max_message_size": 2 * MOST_BYTES,
        "transport/link/tx/keep_alive": 4,
        # By itself zenoh drops the third frame of a burst that waits for a millisecond, which a
        # busy machine makes it do. The thread that waits is ours.
        "transport/link/tx/queue/size": dict.fromkeys(_PRIORITIES, 16),
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": _WAIT_US,
    }
    for name, value in {**common, **settings}.items():
        config.insert_json5(name, json.dumps(value))
    return ZenohLine(zenoh.open(config))


def listening(socket: Path, silence_s: float = SILENCE_S) -> ZenohLine:
    """The session's side, at this socket. Blocks for a moment. Raises `LineError`."""
    zenoh = _module()
    settings = {"mode": "router", "listen/endpoints": [f"unixsock-stream/{socket}"]}
    try:
        return _open(settings, silence_s)
    except zenoh.ZError as error:
        raise LineError(f"cannot listen at {socket}: {error}") from None


def connect(address: str, access: AccessFile | None, silence_s: float = SILENCE_S) -> ZenohLine:
    """From a driver's computer to the session at `address`. Blocks for seconds.

    Raises `LineError`, with why it cannot be reached.
    """
    zenoh = _module()
    at = ListenAddress.read(address)
    scheme = "tcp" if at.plain else "tls"
    host = at.host or "0.0.0.0"
    host = f"[{host}]" if ":" in host else host
    settings: dict[str, Any] = {
        "mode": "client",
        "connect/endpoints": [f"{scheme}/{host}:{at.port}"],
        "connect/timeout_ms": round(CONNECT_S * 1000),
    }
    if not at.plain:
        if access is None:
            raise LineError("an access file is needed", "on the robot: woz access new NAME")
        settings["transport/link/tls"] = {
            "root_ca_certificate_base64": base64.b64encode(access.authority.encode()).decode(),
            "connect_private_key": str(access.path.absolute()),
            "connect_certificate": str(access.path.absolute()),
            "enable_mtls": True,
            # Robots are reached by any address; only the robot's own certificate is one of a
            # server.
            "verify_name_on_connect": False,
        }
    why = _examined(at, access)
    if why is not None:
        raise why
    try:
        return _open(settings, silence_s)
    except zenoh.ZError as error:
        raise LineError(f"no session answers at {address}: {error}") from None


def _examined(at: ListenAddress, access: AccessFile | None) -> LineError | None:
    """Why a connection will not come about, in words that zenoh does not have."""
    try:
        with socket.create_connection((at.host, at.port), CONNECT_S) as plain:
            if at.plain or access is None:
                return None
            with access.context().wrap_socket(plain, server_hostname=SERVER_NAME) as there:
                # A certificate that is not wanted is refused after the handshake; with one that is,
                # nobody says anything before we do.
                there.settimeout(REFUSAL_S)
                if there.recv(1):
                    return None
                return LineError(
                    f"the session at {at.host}:{at.port} has no driver at {access.name}",
                    f"write `at: {access.name}` beside a driver in its robot file; if it is there,"
                    " start the session anew",
                )
    except TimeoutError:
        return None
    except ssl.SSLCertVerificationError as error:
        return LineError(
            f"{at.host}:{at.port} is not the robot that this access file is for"
            f" ({error.verify_message})",
            "take the access file that `woz access new` wrote on this robot",
        )
    except ssl.SSLError as error:
        return LineError(
            f"{at.host}:{at.port} does not let this access file in ({error.reason or error})",
            "make a new one on the robot: woz access new NAME",
        )
    except (AccessError, OSError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        return LineError(
            f"no session can be reached at {at.host}:{at.port}: {reason}",
            "start one there whose robot file says `at:`, or correct the address",
        )
