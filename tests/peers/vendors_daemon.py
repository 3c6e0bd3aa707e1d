"""The vendor's daemon of a Reachy Mini, which `make peers` installs, as a process."""

from __future__ import annotations

import asyncio
import contextlib
import os
import signal
from pathlib import Path

import aiohttp
import psutil

from tests.fakes.ports import free_port
from tests.peers.places import place

BACKENDS = {"mockup": "--mockup-sim", "mujoco": "--sim"}
#: So long a daemon may take to start on a busy machine, in seconds.
STARTS_S = 60.0


class VendorsDaemon:
    """A daemon on a port of its own; `start` again after its end takes the same port."""

    def __init__(
        self, backend: str, folder: Path, options: tuple[str, ...] = ("--no-media",)
    ) -> None:
        self._options = (BACKENDS[backend], "--headless", *options)
        self._folder = folder
        self._port = free_port()
        self._process: asyncio.subprocess.Process | None = None

    @property
    def address(self) -> str:
        """Where it listens."""
        return f"127.0.0.1:{self._port}"

    async def start(self) -> None:
        """Return when it moves its robot."""
        daemon = place("reachy-mini") / "bin" / "reachy-mini-daemon"
        options = (*self._options, "--dataset-update-interval", "0")
        with (self._folder / "daemon.log").open("ab") as log:
            self._process = await asyncio.create_subprocess_exec(
                *(str(daemon), *options, "--fastapi-port", str(self._port)),
                env={
                    **os.environ,
                    "HF_HUB_OFFLINE": "1",
                    "HF_HOME": str(self._folder / ".cache/huggingface"),
                    "HOME": str(self._folder),
                },
                stdout=log,
                stderr=log,
            )
        async with aiohttp.ClientSession() as session, asyncio.timeout(STARTS_S):
            while True:
                with contextlib.suppress(aiohttp.ClientError):
                    url = f"http://{self.address}/api/daemon/status"
                    async with session.get(url) as answer:
                        if (await answer.json())["state"] == "running":
                            return
                await asyncio.sleep(0.1)

    def send(self, number: signal.Signals) -> None:
        """A signal for it and what it has started."""
        assert self._process is not None
        for child in psutil.Process(self._process.pid).children(recursive=True):
            child.send_signal(number)
        self._process.send_signal(number)

    async def end(self) -> None:
        """Kill it."""
        if self._process is not None and self._process.returncode is None:
            self.send(signal.SIGKILL)
            await self._process.wait()
