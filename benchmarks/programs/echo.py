"""Sends back what comes over a Unix socket, over WebSocket with TLS and over Zenoh with TLS: the
least that a program at the other end could do.

    python benchmarks/programs/echo.py SOCKET ZENOH_PORT

Says where its WebSocket is as soon as all of them can be used.
"""

from __future__ import annotations

import asyncio
import json
import sys
from pathlib import Path

import zenoh
from aiohttp import WSMsgType, web

from woz_tui.network.certificates import Authority

ASKED, ECHOED = "echo/to", "echo/from"


def bare_zenoh(port: int, access: str = "") -> zenoh.Session:
    """A line of Zenoh with TLS and nothing of ours; with an access file it connects, without one
    it listens.
    """
    folder = Authority().place
    verb, mode = ("connect", "client") if access else ("listen", "router")
    own = access or str(folder / "server.pem")
    config = zenoh.Config()
    for name, value in {
        "mode": mode,
        f"{verb}/endpoints": [f"tls/127.0.0.1:{port}"],
        "scouting/multicast/enabled": False,
        "transport/link/tls": {
            "root_ca_certificate": str(folder / "authority.crt"),
            f"{verb}_private_key": own,
            f"{verb}_certificate": own,
            "enable_mtls": True,
            "verify_name_on_connect": False,
        },
    }.items():
        config.insert_json5(name, json.dumps(value))
    return zenoh.open(config)


def put(session: zenoh.Session, key: str, data: bytes) -> None:
    """At once, as a line of drivers does it."""
    session.put(key, data, express=True, congestion_control=zenoh.CongestionControl.DROP)


async def _answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    while line := await reader.readline():
        writer.write(line)
    writer.close()


async def _echo(request: web.Request) -> web.WebSocketResponse:
    socket = web.WebSocketResponse(compress=False)
    await socket.prepare(request)
    async for message in socket:
        if message.type is WSMsgType.TEXT:
            await socket.send_str(message.data)
    return socket


async def _serve(path: Path, port: int) -> None:
    server = await asyncio.start_unix_server(_answer, path)
    application = web.Application()
    application.add_routes([web.get("/", _echo)])
    runner = web.AppRunner(application)
    await runner.setup()
    await web.TCPSite(runner, "127.0.0.1", 0, ssl_context=Authority().context()).start()
    session = bare_zenoh(port)
    session.declare_subscriber(
        ASKED, lambda sample: put(session, ECHOED, sample.payload.to_bytes())
    )
    host, at = runner.addresses[0][:2]
    print(f"{host}:{at}", flush=True)
    await server.serve_forever()


if __name__ == "__main__":
    asyncio.run(_serve(Path(sys.argv[1]), int(sys.argv[2])))
