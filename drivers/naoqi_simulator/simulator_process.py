"""The stand-in as a process: `python -m naoqi_simulator`."""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
import signal
import sys
import threading
from collections.abc import Awaitable, Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

from qimessaging import QiError
from qimessaging import hosted_objects as wire
from qimessaging.server import QiServer

from naoqi_simulator.faults import CallRecord
from naoqi_simulator.life import STATES
from naoqi_simulator.robot import NaoqiSimulator
from naoqi_simulator.robot_time import PacedTime
from naoqi_simulator.service_table import CallRefusedError, Service, ServiceMethod, methods_of
from naoqi_simulator.test_service import TestService
from naoqi_simulator.world import ROBOTS, ConnectedClients, SimulatedWorld, SimulatorOptions


class ServiceHost(ConnectedClients):
    """A server in the running loop."""

    def __init__(self, desk: CallRecord) -> None:
        self._desk = desk
        self._server = QiServer()
        #: Calls that go on although their client is gone or has cancelled them.
        self._going: set[asyncio.Task[Any]] = set()

    async def listen(self, host: str, port: int) -> str:
        """Listen and return the address. Raises OSError when that port cannot be had."""
        return str(await self._server.listen(host, port))

    def offer(self, services: Mapping[str, Service]) -> None:
        """Offer all services; before listening, so that nobody finds one missing."""
        for name, service in services.items():
            methods, signals = self._methods(service), _signals(service)
            hosted = self._server.add(name, methods=methods, signals=signals)
            service.sinks.append(hosted.emit)

    async def call(self, service: str, method: str, *args: Any) -> Any:
        """Call a service that a client has registered. Raises LookupError when it cannot."""
        try:
            return await self._server.call(service, method, *args)
        except QiError as error:
            raise LookupError(str(error)) from None

    async def close(self) -> None:
        """Hang up on everybody."""
        for task in self._going:
            task.cancel()
        await self._server.close()

    def _methods(self, service: Service) -> list[wire.HostedMethod]:
        return [
            wire.HostedMethod(one.name, one.takes, one.gives, self._bound(service, one))
            for one in methods_of(service)
        ]

    def _bound(self, service: Service, method: ServiceMethod) -> Callable[..., Awaitable[Any]]:
        async def entered(*args: Any) -> Any:
            task = asyncio.ensure_future(self._carry_out(service, method, args))
            self._going.add(task)
            task.add_done_callback(self._going.discard)
            return await (task if method.cancellable else asyncio.shield(task))

        return entered

    async def _carry_out(self, service: Service, method: ServiceMethod, args: Sequence[Any]) -> Any:
        value = await self._desk.enter(service, method, args)
        if not isinstance(value, Service):
            return value
        hosted = wire.HostedObject([*self._methods(value), *_signals(value)])
        value.sinks.append(hosted.emit)
        return hosted


def _signals(service: Service) -> list[wire.HostedSignal]:
    return [wire.HostedSignal(name, signature) for name, signature in service.signals.items()]


#: Makes what carries the services.
Hosting = Callable[[CallRecord], "ServiceCarrier"]

EPILOG = """\
The first line on standard output says where it listens: {"address": "tcp://127.0.0.1:PORT"}.

To rehearse: start it with `--port 9559`, write `robots: [127.0.0.1]` in the robot file, and play.
Or write `robots: [simulated]`, and the driver starts one by itself.

--control takes one JSON object a line on standard input and answers one a line:
  {"do": "get", "name": "state"}                        everything that can be seen
  {"do": "set", "name": "front", "value": 0.3}          something stands 0.3 m ahead
  {"do": "set", "name": "drift", "value": true}         it changes its autonomy by itself now
  {"do": "person", "who": {"distance": 1.2, "talking": true, "name": "Ada"}}
  {"do": "person", "who": null}                         nobody; "auto": by the seed again
  {"do": "touch", "x": 0.5, "y": 0.5}                   somebody touches the tablet
  {"do": "fault", "kind": "slow:300", "seconds": 5}     every answer 300 ms late
  {"do": "trace"}, {"do": "clear"}
  {"do": "set", "name": "touched", "value": ["Head/Touch/Front"]}       of a NAO; [] again
  {"do": "set", "name": "temperatures", "value": {"LKneePitch": 78}}    of a NAO, in Celsius
Faults: killed, frozen, fall and fall:back (NAO), deaf, slow:MS, refuse:SERVICE.METHOD,...=TEXT,
refuse-again (all but the first call), says-no (moves), moody, invalid-signature (ALMemory), none.
The service StandIn on the wire does the same.
"""


class ServiceCarrier(ConnectedClients, Protocol):
    """What carries the services: `ServiceHost`, or a test's."""

    def offer(self, services: Mapping[str, Service]) -> None:
        """Offer all services as soon as it listens."""
        ...

    async def listen(self, host: str, port: int) -> str:
        """Listen and return the address. Raises OSError when that port cannot be had."""
        ...

    async def close(self) -> None:
        """Hang up on everybody."""
        ...


def parser() -> argparse.ArgumentParser:
    """What the command line takes."""
    made = argparse.ArgumentParser(
        prog="python -m naoqi_simulator",
        description="A simulated Pepper or NAO that speaks NAOqi's protocol.",
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = made.add_argument
    add("--robot", choices=tuple(ROBOTS), default="pepper", help="what kind of robot it is")
    add("--host", default="127.0.0.1", help="address to listen on (default: this machine only)")
    add("--port", type=int, default=0, help="0: any that is free")
    add("--server", help=argparse.SUPPRESS)  # there were two; older calls name one
    add("--pace", type=float, default=1.0, help="how fast its time passes; 10: ten times as fast")
    add("--seed", type=int, default=7, help="of the visitors and of moods")
    add("--visitors", choices=("seeded", "none"), default="seeded", help="people who come and go")
    add("--life", choices=STATES, default="solitary", help="autonomous life at the start")
    add("--moody", action="store_true", help="it changes its autonomy by itself now and then")
    add("--naoqi", default="", metavar="VERSION", help="what ALSystem says it is")
    add("--subscriber", action="store_true", help="ALMemory.subscriber works, as it does on a NAO")
    add(
        "--echo",
        type=float,
        default=0.3,
        help="how loud it hears itself, 0 to 1",
    )
    add("--files", type=Path, help="folder that is the root of its file system")
    add("--control", action="store_true", help="orders on standard input, see below")
    return made


def main(arguments: list[str] | None = None, hosting: Hosting = ServiceHost) -> int:
    """Run until SIGTERM, SIGINT, or the end of the orders."""
    parsed = parser().parse_args(arguments)
    if parsed.server == "qi":
        sys.stderr.write("--server qi: the package qi is not used; it serves by itself\n")
    out = _own_output()
    try:
        asyncio.run(_serve(parsed, out, hosting))
    except (OSError, ValueError) as error:
        sys.stderr.write(f"{error}\n")
        return 2
    finally:
        os.close(out)
    # The thread that reads orders may still be busy; nothing of ours is left to save.
    sys.stderr.flush()
    os._exit(0)


def _own_output() -> int:
    """Our own standard output: whatever a library prints goes to standard error from here on."""
    out = os.dup(1)
    os.dup2(2, 1)
    return out


async def _serve(parsed: argparse.Namespace, out: int, hosting: Hosting) -> None:
    loop = asyncio.get_running_loop()
    options = SimulatorOptions(
        robot=parsed.robot,
        seed=parsed.seed,
        visitors=parsed.visitors == "seeded",
        life=parsed.life,
        moody=parsed.moody,
        invalid_signature=not parsed.subscriber and parsed.robot == "pepper",
        version=parsed.naoqi,
        files=parsed.files,
        echo=parsed.echo,
    )
    robot = NaoqiSimulator(SimulatedWorld(PacedTime(parsed.pace), options))
    host, address = await start(robot, parsed.host, parsed.port, hosting)
    ended = asyncio.Event()
    for one in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(one, ended.set)
    os.write(out, json.dumps({"address": address}).encode() + b"\n")
    tasks = {asyncio.ensure_future(robot.live()), asyncio.ensure_future(ended.wait())}
    if parsed.control:
        tasks.add(asyncio.ensure_future(StdinControl(robot, out).run()))
    done, going = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    for task in going:
        task.cancel()
    await host.close()
    for task in done:
        task.result()


async def start(
    robot: NaoqiSimulator, host: str = "127.0.0.1", port: int = 0, hosting: Hosting = ServiceHost
) -> tuple[ServiceCarrier, str]:
    """Let a robot be reached; how to hang up, and the address. Raises OSError."""
    hosted = hosting(robot.world.desk)
    hosted.offer(robot.services)
    address = await hosted.listen(host, port)
    robot.world.clients = hosted
    return hosted, address


# -- orders: the service StandIn by JSON lines on standard input and output ------------------------


class StdinControl:
    """Reads orders, answers each with `{"ok": ...}` or `{"error": ...}`, in order."""

    def __init__(self, robot: NaoqiSimulator, out: int) -> None:
        self._standin, self._out = robot.standin, out

    async def run(self) -> None:
        """Until nobody can give orders any more; then the robot ends, too."""
        lines: asyncio.Queue[bytes] = asyncio.Queue()
        loop = asyncio.get_running_loop()
        # A thread, because standard input may be a file; a daemon, because nothing ends its read.
        threading.Thread(target=_read_lines, args=(loop, lines), daemon=True).start()
        while line := await lines.get():
            self._answer(line)

    def _answer(self, line: bytes) -> None:
        try:
            answer: dict[str, Any] = {"ok": carry_out(self._standin, json.loads(line))}
        except CallRefusedError as refused:
            answer = {"error": str(refused)}
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            answer = {"error": f"not understood: {line!r}: {error!r}"}
        data = json.dumps(answer).encode() + b"\n"
        while data:
            data = data[os.write(self._out, data) :]


def _read_lines(loop: asyncio.AbstractEventLoop, lines: asyncio.Queue[bytes]) -> None:
    """Hand on every line of standard input, and nothing at its end."""
    rest = b""
    # The loop may be gone before the last line.
    with contextlib.suppress(RuntimeError):
        while data := os.read(0, 1 << 16):
            *complete, rest = (rest + data).split(b"\n")
            for line in complete:
                if line.strip():
                    loop.call_soon_threadsafe(lines.put_nowait, line)
        loop.call_soon_threadsafe(lines.put_nowait, b"")


ORDERS = ("trace", "clear", "get", "set", "touch", "person", "fault")


def carry_out(standin: TestService, order: Mapping[str, Any]) -> Any:
    """Carry out one order: `{"do": "get", "name": "state"}`. Raises Refused."""
    match order["do"]:
        case "trace":
            return standin.trace()
        case "clear":
            return standin.clear()
        case "get":
            return json.loads(standin.get(order["name"]))
        case "set":
            return standin.set(order["name"], json.dumps(order["value"]))
        case "touch":
            return standin.touch(order["x"], order["y"])
        case "person":
            return standin.person(json.dumps(order["who"]))
        case "fault":
            return standin.fault(order["kind"], order.get("seconds", 0.0))
    raise CallRefusedError(f"no order {order['do']!r}; there is {', '.join(ORDERS)}")
