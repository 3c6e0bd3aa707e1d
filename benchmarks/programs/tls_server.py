"""Lets one session's clients in over the network, and sends back what comes to another port.

    python tls_server.py SOCKET

Prints both addresses.
"""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path

from aiohttp import WSMsgType, web

from woz_tui.network.certificates import Authority
from woz_tui.network.listen_address import ListenAddress
from woz_tui.remote.access_server import AccessServer


async def _echo(request: web.Request) -> web.WebSocketResponse:
    socket = web.WebSocketResponse(compress=False)
    await socket.prepare(request)
    async for message in socket:
        if message.type is WSMsgType.TEXT:
            await socket.send_str(message.data)
    return socket


async def _serve() -> None:
    server = AccessServer(Path(sys.argv[1]), Authority())
    server.adopt({"bench": "program"})
    address = await server.listen(ListenAddress("127.0.0.1", 0))
    application = web.Application()
    application.add_routes([web.get("/", _echo)])
    runner = web.AppRunner(application)
    await runner.setup()
    await web.TCPSite(runner, "127.0.0.1", 0, ssl_context=Authority().context()).start()
    host, port = runner.addresses[0][:2]
    print(address, f"{host}:{port}", flush=True)
    await asyncio.Event().wait()


asyncio.run(_serve())
